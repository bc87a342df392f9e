//! Figures as SVG: panels above one another with axes, grid and a legend.
//!
//! Colours have one meaning each, distinct for colour-blind readers too: Okabe and Ito's hues, which
//! the recording has as well, in a shade for light ground and one for dark ground. The style sheet
//! numbers them, and gives each the shade that the reader's ground asks for.

use std::collections::HashSet;
use std::fmt::Write as _;

use maud::{PreEscaped, html};

use super::document::Figure;
use crate::figure::{Axis, Mark, Panel, Place, Revision, Role, Shape, within};
use crate::wording::{capitalized, legible, listed, rounded};

/// Height of letters in pixels.
const LETTERS: u32 = 12;

/// Room for the numbers and the name of the vertical axis.
const LEFT: u32 = 68;

/// Room beyond the right end of the horizontal axis.
const RIGHT: u32 = 14;

/// Room for a legend.
const LEGEND: u32 = 22;

/// Width of what stands before a name in a legend.
const SWATCH: f64 = 18.0;

/// Pixels that so many letters take, about.
fn text_width(letters: usize) -> u32 {
    /// Width of a letter, on average, in hundredths of a pixel.
    const LETTER: u32 = 672;
    (u32::try_from(letters).unwrap_or(1000) * LETTER).div_ceil(100)
}

/// Draws the panels of `figure` above one another, as a part of a page.
pub(super) fn draw(figure: &Figure) -> String {
    let Figure { name, width, panels, .. } = figure;
    let height: u32 = panels.iter().map(Panel::whole_height).sum();
    let left = panels.iter().map(|panel| panel.y.width()).max().unwrap_or(LEFT);
    let (mut drawn, mut top) = (Svg(String::new()), 0);
    for panel in panels {
        Frame::new(panel, (left, *width - RIGHT), top).draw(&mut drawn);
        top += panel.whole_height();
    }
    let view = format!("0 0 {width} {height}");
    let svg = html! {
        svg xmlns="http://www.w3.org/2000/svg" width=(width) height=(height) viewBox=(view)
            role="img" font-family="sans-serif" font-size=(LETTERS)
        {
            title { (name) }
            desc { (in_words(panels)) }
            (PreEscaped(drawn.0))
        }
    };
    legible(&svg.into_string())
}

/// The panels in sentences, for those who do not see them.
fn in_words(panels: &[Panel]) -> String {
    let of = panels.len();
    let one = |(place, panel): (usize, &Panel)| {
        let which = if of > 1 { format!("Plot {} of {of}: ", place + 1) } else { String::new() };
        format!("{which}{}", panel.in_words())
    };
    panels.iter().enumerate().map(one).collect::<Vec<_>>().join(" ")
}

impl Axis {
    /// Room for its texts, in pixels.
    fn width(&self) -> u32 {
        let longest = self.ticks.iter().map(|(_, text)| text.chars().count()).max().unwrap_or(0);
        // The name stands upright beside the numbers.
        let name = if self.has_names { 14 } else { 32 };
        LEFT.max(text_width(longest) + name)
    }
}

impl Panel {
    /// Sentences on the axes with their ranges, and on what is drawn.
    fn in_words(&self) -> String {
        let range = |axis: &Axis| {
            let [low, high] = [axis.span.low, axis.span.high].map(|end| rounded(axis.number(end)));
            let scale = if axis.is_logarithmic { ", on a logarithmic scale" } else { "" };
            format!("from {low} to {high}{scale}")
        };
        let names = |axis: &Axis| {
            let names: Vec<_> = axis.ticks.iter().map(|(_, name)| name.clone()).collect();
            format!("There is a row for each of {}", listed(&names, "and"))
        };
        let upward = if self.y.has_names {
            names(&self.y)
        } else {
            capitalized(&format!("{} runs {}", self.y.name, range(&self.y)))
        };
        let across = if self.x.is_bare() {
            "over the same horizontal axis as the plot below".to_owned()
        } else {
            format!("over {}, which runs {}", self.x.name, range(&self.x))
        };
        let marks = self.marks.iter().filter_map(|mark| mark.name.clone());
        let marks: Vec<String> = marks.collect();
        let shown = match marks.as_slice() {
            [] => String::new(),
            marks => format!(" It shows: {}.", listed(marks, "and")),
        };
        format!("{upward}, {across}.{shown}")
    }

    fn top(&self) -> u32 {
        if self.marks.iter().any(|mark| mark.name.is_some()) { LEGEND } else { 8 }
    }

    fn bottom(&self) -> u32 {
        match (self.x.is_bare(), self.x.name.is_empty()) {
            (true, _) => 6,
            (false, true) => 20,
            (false, false) => 40,
        }
    }

    fn whole_height(&self) -> u32 {
        self.top() + self.height + self.bottom()
    }
}

/// A panel, and where its axes are in the drawing, in pixels.
struct Frame<'p> {
    panel: &'p Panel,
    left: f64,
    right: f64,
    top: f64,
    bottom: f64,
}

impl<'p> Frame<'p> {
    fn new(panel: &'p Panel, (left, right): (u32, u32), above: u32) -> Self {
        let top = above + panel.top();
        let [left, right, top, bottom] = [left, right, top, top + panel.height].map(f64::from);
        Self { panel, left, right, top, bottom }
    }

    fn x(&self, value: f64) -> f64 {
        self.left + self.panel.x.span.part(value) * (self.right - self.left)
    }

    fn y(&self, value: f64) -> f64 {
        self.bottom - self.panel.y.span.part(value) * (self.bottom - self.top)
    }

    fn at(&self, (x, y): Place) -> Place {
        (self.x(x), self.y(y))
    }

    fn draw(&self, svg: &mut Svg) {
        let (behind, before): (Vec<&Mark>, Vec<&Mark>) =
            self.panel.marks.iter().partition(|mark| mark.is_ground());
        for mark in behind {
            self.mark(mark, svg);
        }
        self.axes(svg);
        for mark in before {
            self.mark(mark, svg);
        }
        self.legend(svg);
    }

    fn axes(&self, svg: &mut Svg) {
        let Self { panel: Panel { x, y, .. }, left, right, top, bottom } = *self;
        for (tick, text) in &x.ticks {
            let at = self.x(*tick);
            svg.line([(at, top), (at, bottom)], Role::Grid, 1.0);
            svg.line([(at, bottom), (at, bottom + 3.0)], Role::Faint, 1.0);
            svg.text((at, bottom + 15.0), ("middle", Role::Faint), text);
        }
        for (tick, text) in &y.ticks {
            let at = self.y(*tick);
            if !y.has_names {
                svg.line([(left, at), (right, at)], Role::Grid, 1.0);
            }
            svg.line([(left - 3.0, at), (left, at)], Role::Faint, 1.0);
            svg.text((left - 6.0, at + 4.0), ("end", Role::Faint), text);
        }
        svg.line([(left, top), (left, bottom), (right, bottom)], Role::Faint, 1.0);
        let below = (f64::midpoint(left, right), bottom + 33.0);
        svg.text(below, ("middle", Role::Ink), &x.name);
        svg.upright((12.0, f64::midpoint(top, bottom)), &y.name);
    }

    /// A swatch and a name for each mark that has one, in a line above the axes.
    fn legend(&self, svg: &mut Svg) {
        let names: Vec<(&Mark, String)> = self.panel.legend().collect();
        let width = |name: &str| SWATCH + 16.0 + f64::from(text_width(name.chars().count()));
        let all: f64 = names.iter().map(|(_, name)| width(name)).sum();
        let mut x = if self.left + all <= self.right + f64::from(RIGHT) { self.left } else { 4.0 };
        let y = self.top - f64::from(LEGEND) / 2.0 - 1.0;
        for (mark, name) in names {
            svg.swatch(mark, (x, y));
            svg.text((x + SWATCH + 6.0, y + 4.0), ("start", Role::Ink), &name);
            x += width(&name);
        }
    }

    fn mark(&self, mark: &Mark, svg: &mut Svg) {
        let (panel, role) = (self.panel, mark.role);
        match &mark.shape {
            Shape::Lines(lines, width) => {
                for line in lines.iter().flat_map(|line| within((panel.x.span, panel.y.span), line))
                {
                    svg.line(line.into_iter().map(|place| self.at(place)), role, *width);
                }
            }
            Shape::Dots(places, radius) => {
                self.apart(places).for_each(|at| svg.dot(at, *radius, role));
            }
            Shape::Crosses(places) => self.apart(places).for_each(|at| svg.cross(at, role)),
            Shape::Spreads(spreads, above) => {
                let y = self.top - above;
                for (from, to) in spreads.iter().map(|(from, to)| (self.x(*from), self.x(*to))) {
                    svg.line([(from, y), (to, y)], role, 1.4);
                    for end in [from, to] {
                        svg.line([(end, y - 3.0), (end, y + 3.0)], role, 1.4);
                    }
                }
            }
            Shape::Verticals(places, width) => {
                for x in places.iter().map(|x| self.x(*x)) {
                    svg.line([(x, self.top), (x, self.bottom)], role, *width);
                }
            }
            Shape::Band(low, high) => {
                svg.block([(self.left, self.y(*low)), (self.right, self.y(*high))], role, 0.18);
            }
            Shape::Spans(places, density) => {
                for (from, to) in places {
                    let corners = [(self.x(*from), self.top), (self.x(*to), self.bottom)];
                    svg.block(corners, role, *density);
                }
            }
            Shape::Bars(bars) => {
                for (a, b) in bars {
                    svg.block([self.at(*a), self.at(*b)], role, 1.0);
                }
            }
            Shape::Words(words) => {
                for ((x, y), text) in words.iter().map(|(place, text)| (self.at(*place), text)) {
                    svg.text((x + 5.0, y + 4.0), ("start", role), text);
                }
            }
            // Only recordings have them.
            Shape::Named(_) | Shape::Flags(_) => {}
        }
    }

    /// Where places are, without those that the sign at one before them hides.
    fn apart(&self, places: &[Place]) -> impl Iterator<Item = Place> {
        /// Side of a square in which one sign hides the others, in pixels.
        const SQUARE: f64 = 4.0;
        let mut taken = HashSet::new();
        let square = |(x, y): &Place| [x, y].map(|at| (at / SQUARE).floor().to_bits());
        places.iter().map(|place| self.at(*place)).filter(move |at| taken.insert(square(at)))
    }
}

/// The elements of a drawing; places are in pixels.
struct Svg(String);

impl Svg {
    fn line(&mut self, places: impl IntoIterator<Item = Place>, role: Role, width: f64) {
        let points = places.into_iter().map(|(x, y)| format!("{x:.1},{y:.1}"));
        let (points, color) = (points.collect::<Vec<_>>().join(" "), color(role));
        self.push(format_args!(
            "<polyline points=\"{points}\" fill=\"none\" stroke=\"{color}\" stroke-width=\"{width}\"/>"
        ));
    }

    fn dot(&mut self, (x, y): Place, radius: f64, role: Role) {
        let color = color(role);
        self.push(format_args!(
            "<circle cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"{radius}\" fill=\"{color}\"/>"
        ));
    }

    fn cross(&mut self, (x, y): Place, role: Role) {
        self.line([(x - 4.0, y - 4.0), (x + 4.0, y + 4.0)], role, 1.8);
        self.line([(x - 4.0, y + 4.0), (x + 4.0, y - 4.0)], role, 1.8);
    }

    /// Filled between two corners.
    fn block(&mut self, [a, b]: [Place; 2], role: Role, opacity: f64) {
        let (x, y, color) = (a.0.min(b.0), a.1.min(b.1), color(role));
        let (width, height) = ((a.0 - b.0).abs(), (a.1 - b.1).abs());
        self.push(format_args!(
            "<rect x=\"{x:.1}\" y=\"{y:.1}\" width=\"{width:.1}\" height=\"{height:.1}\" \
             fill=\"{color}\" opacity=\"{opacity}\"/>"
        ));
    }

    /// A text that starts, ends or has its middle at a place.
    fn text(&mut self, (x, y): Place, (anchor, role): (&str, Role), text: &str) {
        let (x, y) = (format!("{x:.1}"), format!("{y:.1}"));
        let text = html! { text x=(x) y=(y) text-anchor=(anchor) fill=(color(role)) { (text) } };
        self.push(format_args!("{}", text.into_string()));
    }

    /// A text that runs upward, its middle at a place.
    fn upright(&mut self, (x, y): Place, text: &str) {
        let place = format!("translate({x:.1} {y:.1}) rotate(-90)");
        let text = html! { text transform=(place) text-anchor="middle" fill=(color(Role::Ink)) { (text) } };
        self.push(format_args!("{}", text.into_string()));
    }

    fn swatch(&mut self, mark: &Mark, (x, y): Place) {
        let (middle, end) = (x + SWATCH / 2.0, x + SWATCH);
        let block = [(x, y - 4.0), (end, y + 4.0)];
        match &mark.shape {
            Shape::Lines(_, width) => self.line([(x, y), (end, y)], mark.role, *width),
            Shape::Spreads(..) => self.line([(x, y), (end, y)], mark.role, 1.4),
            Shape::Verticals(_, width) => {
                self.line([(middle, y - 6.0), (middle, y + 6.0)], mark.role, *width);
            }
            Shape::Dots(..) => self.dot((middle, y), 3.0, mark.role),
            Shape::Crosses(_) => self.cross((middle, y), mark.role),
            Shape::Band(..) | Shape::Spans(..) => self.block(block, mark.role, 0.3),
            Shape::Bars(_) => self.block(block, mark.role, 1.0),
            Shape::Words(_) | Shape::Named(_) | Shape::Flags(_) => {}
        }
    }

    fn push(&mut self, element: std::fmt::Arguments<'_>) {
        writeln!(self.0, "{element}").unwrap_or_default();
    }
}

/// A role's colour, whose shade is in the style sheet.
fn color(role: Role) -> String {
    format!("var(--c{})", Role::all().position(|other| other == role).unwrap_or(0))
}

/// Shades of the revisions after the first one, on light and on dark ground: the hues that the
/// recording has.
const REVISIONS: [(u32, u32); Revision::COUNT as usize] = [
    (0x00_7F5C, 0x00_9E73),
    (0xB0_4A8A, 0xCC_79A7),
    (0xB8_4A00, 0xD5_5E00),
    (0x1F_6FB5, 0x78_BEFF),
    (0x7A_6B00, 0xF0_E442),
    (0x6A_4FC0, 0xA0_78F0),
    (0x3F_7F2A, 0x96_DC78),
    (0xB0_4040, 0xFF_9696),
    (0x00_7C85, 0x00_C8D2),
];

impl Role {
    /// Its shades on light and on dark ground, as `0xRRGGBB`.
    const fn shades(self) -> (u32, u32) {
        match self {
            Self::Ink => (0x1C_1F23, 0xE8_EAED),
            Self::Faint => (0x5A_6067, 0xA7_AEB6),
            Self::Grid => (0xDD_E0E3, 0x39_3E44),
            Self::Input => (0x8C_7A00, 0xF0_E442),
            Self::Measured => (0x80_8487, 0x96_9A9E),
            Self::Smoothed => (0x00_72B2, 0x56_B4E9),
            Self::Accepted => (0x00_8F68, 0x00_BE8C),
            Self::Rejected => (0xD5_5E00, 0xF2_8A4B),
            Self::Error => (0xA8_4F87, 0xD9_8CB8),
            Self::Model => (0xC4_7A00, 0xE6_9F00),
            Self::Noise => (0x2F_8FCB, 0x57_B5EA),
            Self::Attention => (0xCC_79A7, 0xCC_79A8),
            Self::Revision(one) => REVISIONS[one.place()],
            Self::Own(red, green, blue) => {
                let shade = u32::from_be_bytes([0, red, green, blue]);
                (shade, shade)
            }
        }
    }
}

/// The shades of all roles on either ground.
pub(super) fn figure_style() -> String {
    let (mut light, mut dark) = (String::new(), String::new());
    for (number, role) in Role::all().enumerate() {
        let (on_light, on_dark) = role.shades();
        write!(light, "--c{number}:#{on_light:06X};").unwrap_or_default();
        write!(dark, "--c{number}:#{on_dark:06X};").unwrap_or_default();
    }
    format!(
        ":root{{{light}}}@media (prefers-color-scheme:dark){{:root{{{dark}}}}}\
         @media print{{:root{{{light}}}}}"
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::figure::Span;

    fn svg(panel: Panel, name: &str) -> String {
        let (name, panels) = (name.to_owned(), vec![panel]);
        draw(&Figure { name, width: 300, panels, caption: String::new() })
    }

    fn panel(marks: Vec<Mark>) -> Panel {
        let axis = |name: &str| Axis::new(Span::new(0.0, 10.0), name, 5.0);
        Panel { x: axis("time [s]"), y: axis("<angle> & more"), height: 100, marks }
    }

    #[test]
    fn a_drawing_is_well_formed_and_has_its_name() {
        let lines = Shape::Lines(vec![vec![(0.0, 0.0), (10.0, 10.0)]], 1.0);
        let drawn = panel(vec![Mark::new(Role::Model, lines).named("a < b")]);
        let svg = svg(drawn, "1 < 2");
        let parsed = roxmltree::Document::parse(&svg).unwrap();
        let root = parsed.root_element();
        assert_eq!(root.attribute("width"), Some("300"));
        let texts: Vec<_> =
            parsed.descendants().filter_map(|node| node.text()).map(str::trim).collect();
        for expected in ["1 < 2", "a < b", "time [s]", "<angle> & more", "10"] {
            assert!(texts.contains(&expected), "no {expected} in {texts:?}");
        }
    }

    #[test]
    fn a_drawing_is_described_in_sentences() {
        let lines = || Shape::Lines(vec![vec![(0.0, 0.0), (10.0, 10.0)]], 1.0);
        let mark = |name: &str| Mark::new(Role::Model, lines()).named(name);
        let first = panel(vec![mark("measured"), mark("simulated")]);
        let first = Panel { x: first.x.bare(), ..first };
        let y = Axis::logarithmic(Span::new(-2.0, 1.0), "SSE", 3.0);
        let second = Panel { y, ..panel(Vec::new()) };
        let expected = "Plot 1 of 2: <angle> & more runs from 0 to 10, over the same horizontal \
                        axis as the plot below. It shows: measured and simulated. Plot 2 of 2: SSE \
                        runs from 0.01 to 10, on a logarithmic scale, over time [s], which runs from \
                        0 to 10.";
        assert_eq!(in_words(&[first, second]), expected);
        let names = ["boom", "arm"].map(str::to_owned);
        let rows = Panel { y: Axis::of_names(&names, ""), ..panel(Vec::new()) };
        let expected =
            "There is a row for each of boom and arm, over time [s], which runs from 0 to 10.";
        assert_eq!(in_words(&[rows]), expected);
    }

    #[test]
    fn a_line_runs_from_corner_to_corner_of_the_axes() {
        let lines = Shape::Lines(vec![vec![(0.0, 0.0), (10.0, 10.0)]], 1.0);
        let svg = svg(panel(vec![Mark::new(Role::Model, lines)]), "");
        let parsed = roxmltree::Document::parse(&svg).unwrap();
        let shade = color(Role::Model);
        let line = parsed.descendants().find(|node| node.attribute("stroke") == Some(&shade));
        let points = line.unwrap().attribute("points").unwrap();
        let numbers: Vec<f64> =
            points.split([',', ' ']).filter_map(|number| number.parse().ok()).collect();
        let [from_x, from_y, to_x, to_y] = numbers[..] else { panic!("{points}") };
        assert!((to_x - from_x - f64::from(300 - LEFT - RIGHT)).abs() <= 1.0, "{points}");
        assert!((from_y - to_y - 100.0).abs() <= 1.0, "{points}");
    }

    #[test]
    fn of_places_that_hide_one_another_one_is_drawn() {
        let places: Vec<Place> = (0..1000).map(|k| (f64::from(k) / 100.0, 5.0)).collect();
        let at = |pixels: f64| {
            let shape = Shape::Dots(places.iter().map(|(x, y)| (x * pixels, *y)).collect(), 3.0);
            svg(panel(vec![Mark::new(Role::Accepted, shape)]), "").matches("<circle").count()
        };
        assert!((40..70).contains(&at(1.0)), "{}", at(1.0));
        assert_eq!(at(0.0), 1);
    }
}

#[cfg(test)]
mod palette_tests {
    use super::*;

    /// Relative luminance (WCAG 2.2).
    fn luminance(shade: u32) -> f64 {
        let [_, red, green, blue] = shade.to_be_bytes();
        let linear = |part: u8| {
            let part = f64::from(part) / 255.0;
            if part <= 0.04045 { part / 12.92 } else { ((part + 0.055) / 1.055).powf(2.4) }
        };
        0.2126 * linear(red) + 0.7152 * linear(green) + 0.0722 * linear(blue)
    }

    #[test]
    fn lines_stand_out_from_both_grounds() {
        let contrast = |a: f64, b: f64| (a.max(b) + 0.05) / (a.min(b) + 0.05);
        for role in Role::all() {
            let least = match role {
                Role::Grid | Role::Attention => 1.2,
                Role::Ink | Role::Faint => 5.0,
                _ => 3.0,
            };
            let (light, dark) = role.shades();
            assert!(contrast(luminance(light), 1.0) > least, "{role:?} on white");
            assert!(contrast(luminance(dark), luminance(0x16_181B)) > least, "{role:?} on black");
        }
    }
}
