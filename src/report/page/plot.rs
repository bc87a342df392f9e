//! Figures as SVG: panels above one another with axes, grid and a legend.
//!
//! Coordinates of the drawing library are whole numbers, so that a figure is drawn
//! [`FINE`] times as large as it is shown.
//!
//! Colours have one meaning each, distinct for colour-blind readers too: Okabe and Ito's hues, which
//! the recording has as well, in a shade for light ground and one for dark ground. A figure is drawn
//! in the shades for light ground, which are right wherever no style sheet is read; the style sheet
//! finds each by its number and gives it the shade that the reader's ground asks for. So each shade
//! for light ground stands for one meaning only.

use std::collections::HashSet;
use std::fmt::Write as _;
use std::ops::Range;

use plotters::coord::Shift;
use plotters::coord::ranged1d::{DefaultFormatting, KeyPointHint, Ranged};
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};

use super::document::Figure;
use crate::figure::{Axis, Mark, Panel, Place, Revision, Role, Shape, within};
use crate::wording::{capitalized, legible, listed, rounded};

/// Parts of a pixel that a coordinate resolves.
const FINE: u32 = 4;

/// Height of letters in pixels.
const LETTERS: u32 = 12;

/// Room for the numbers and the name of the vertical axis.
const LEFT: u32 = 66;

/// Room beyond the right end of the horizontal axis.
const RIGHT: u32 = 14;

/// Room for a legend.
const LEGEND: u32 = 22;

/// Width of what stands before a name in a legend.
const SWATCH: u32 = 18;

/// Width of a letter, on average, in parts of its height.
const LETTER_WIDTH: f64 = 0.56;

/// Why a figure is not there.
#[derive(Debug, thiserror::Error)]
#[error("a figure cannot be drawn: {0}")]
pub(crate) struct PlotError(String);

type DrawingError = DrawingAreaErrorKind<std::io::Error>;
type Svg<'a> = DrawingArea<SVGBackend<'a>, Shift>;
type Axes = Cartesian2d<Axis, Axis>;
type Chart<'a, 'b> = ChartContext<'a, SVGBackend<'b>, Axes>;

impl Axis {
    /// The text at a tick.
    fn text(&self, at: f64) -> String {
        let near = |tick: f64| (tick - at).abs() <= 1e-9 * (self.span.high - self.span.low);
        let found = self.ticks.iter().find(|(tick, _)| near(*tick));
        found.map_or_else(String::new, |(_, text)| text.clone())
    }

    /// Room for its texts, in pixels.
    fn width(&self) -> u32 {
        let longest = self.ticks.iter().map(|(_, text)| text.chars().count()).max().unwrap_or(0);
        // The name stands upright beside the numbers.
        let name = if self.has_names { 12 } else { 30 };
        LEFT.max(text_width(longest) + name)
    }
}

impl Ranged for Axis {
    type FormatOption = DefaultFormatting;
    type ValueType = f64;

    fn map(&self, value: &f64, (from, to): (i32, i32)) -> i32 {
        /// How far beyond the axis something is still drawn, in its lengths.
        const BEYOND: f64 = 0.1;
        let part = self.span.part(*value).clamp(-BEYOND, 1.0 + BEYOND);
        #[expect(clippy::cast_possible_truncation, reason = "a place in the drawing")]
        let offset = (part * f64::from(to - from)).round() as i32;
        from + offset
    }

    fn key_points<Hint: KeyPointHint>(&self, hint: Hint) -> Vec<f64> {
        if hint.weight().allow_light_points() {
            return Vec::new();
        }
        self.ticks.iter().map(|(tick, _)| *tick).collect()
    }

    fn range(&self) -> Range<f64> {
        self.span.low..self.span.high
    }
}

/// Pixels that so many letters take, about.
fn text_width(letters: usize) -> u32 {
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a few letters")]
    let width = (letters as f64 * LETTER_WIDTH * f64::from(LETTERS)).ceil() as u32;
    width
}

/// Room for an entry of a legend.
fn entry_width(name: &str) -> u32 {
    SWATCH + 6 + text_width(name.chars().count()) + 10
}

fn fine(pixels: u32) -> i32 {
    i32::try_from(pixels * FINE).unwrap_or(i32::MAX)
}

fn color(role: Role, opacity: f64) -> RGBAColor {
    let (red, green, blue) = role.rgb();
    RGBAColor(red, green, blue, opacity)
}

fn stroke(role: Role, width: f64) -> ShapeStyle {
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a few pixels")]
    let stroke_width = (width * f64::from(FINE)).round() as u32;
    ShapeStyle { color: color(role, 1.0), filled: false, stroke_width }
}

fn filled(role: Role, opacity: f64) -> ShapeStyle {
    ShapeStyle { color: color(role, opacity), filled: true, stroke_width: 0 }
}

/// The letters of texts; the library asks for 1.24 times their height.
fn letters(role: Role) -> TextStyle<'static> {
    let size = f64::from(LETTERS * FINE) * 1.24;
    ("sans-serif", size).into_font().color(&color(role, 1.0))
}

/// Draws the panels of `figure` above one another; the SVG without what stands around it, so that it
/// may go into a page.
pub(super) fn draw(figure: &Figure) -> Result<String, PlotError> {
    let Figure { name, width, panels, .. } = figure;
    let height: u32 = panels.iter().map(Panel::whole_height).sum();
    let mut text = String::new();
    let failed = |error: DrawingError| PlotError(error.to_string());
    {
        let backend = SVGBackend::with_string(&mut text, (*width * FINE, height * FINE));
        let mut rest = backend.into_drawing_area();
        let left = panels.iter().map(|panel| panel.y.width()).max().unwrap_or(LEFT);
        for panel in panels {
            let (own, below) = rest.split_vertically(fine(panel.whole_height()));
            panel.draw(&own, left).map_err(failed)?;
            rest = below;
        }
        rest.present().map_err(failed)?;
    }
    Ok(framed(&text, (*width, height), (name, &in_words(panels))))
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

/// The drawing in a frame of its own size, with its name and what it shows for those who do not see
/// it.
fn framed(text: &str, (width, height): (u32, u32), (name, described): (&str, &str)) -> String {
    let inside = text.split_once(">\n").map_or("", |(_, inside)| inside);
    let inside = inside.replace(" opacity=\"1\"", "");
    let (wide, high) = (width * FINE, height * FINE);
    let [name, described] = [name, described].map(|text| maud::html! { (text) }.into_string());
    let svg = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width}\" height=\"{height}\" \
         viewBox=\"0 0 {wide} {high}\" role=\"img\"><title>{name}</title>\n\
         <desc>{described}</desc>\n{inside}"
    );
    legible(&svg)
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

    fn has_legend(&self) -> bool {
        self.marks.iter().any(|mark| mark.name.is_some())
    }

    fn top(&self) -> u32 {
        if self.has_legend() { LEGEND } else { 8 }
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

    fn draw(&self, area: &Svg<'_>, left: u32) -> Result<(), DrawingError> {
        let mut chart = ChartBuilder::on(area)
            .margin_top(fine(self.top()))
            .margin_left(fine(2))
            .margin_right(fine(RIGHT))
            .x_label_area_size(fine(self.bottom()))
            .y_label_area_size(fine(left))
            .build_cartesian_2d(self.x.clone(), self.y.clone())?;
        let (behind, before): (Vec<&Mark>, Vec<&Mark>) =
            self.marks.iter().partition(|mark| mark.is_ground());
        for mark in behind {
            mark.draw(&mut chart, self)?;
        }
        self.mesh(&mut chart)?;
        for mark in before {
            mark.draw(&mut chart, self)?;
        }
        self.draw_legend(area, left)
    }

    fn mesh(&self, chart: &mut Chart<'_, '_>) -> Result<(), DrawingError> {
        let (x_text, y_text) = (|x: &f64| self.x.text(*x), |y: &f64| self.y.text(*y));
        let mut mesh = chart.configure_mesh();
        mesh.x_label_formatter(&x_text)
            .y_label_formatter(&y_text)
            .label_style(letters(Role::Faint))
            .axis_desc_style(letters(Role::Ink))
            .axis_style(stroke(Role::Faint, 1.0))
            .bold_line_style(stroke(Role::Grid, 1.0))
            .light_line_style(ShapeStyle::from(&TRANSPARENT))
            .set_all_tick_mark_size(fine(3));
        if self.y.has_names {
            mesh.disable_y_mesh();
        }
        if !self.x.name.is_empty() {
            mesh.x_desc(&self.x.name);
        }
        if !self.y.name.is_empty() {
            mesh.y_desc(&self.y.name);
        }
        mesh.draw()
    }

    /// A swatch and a name for each mark that has one, in a line above the axes.
    fn draw_legend(&self, area: &Svg<'_>, left: u32) -> Result<(), DrawingError> {
        let middle = fine(LEGEND) / 2 - fine(1);
        let names = || self.legend();
        let width: u32 = names().map(|(_, name)| entry_width(&name)).sum();
        let (whole, _) = area.dim_in_pixel();
        let mut x = if left + width <= whole / FINE { left } else { 4 };
        for (mark, name) in names() {
            mark.swatch(area, (fine(x), middle))?;
            let style = letters(Role::Ink).pos(Pos::new(HPos::Left, VPos::Center));
            let width = entry_width(&name);
            area.draw(&Text::new(name, (fine(x + SWATCH + 6), middle), style))?;
            x += width;
        }
        Ok(())
    }
}

impl Mark {
    fn swatch(&self, area: &Svg<'_>, (x, y): (i32, i32)) -> Result<(), DrawingError> {
        let (middle, end) = (x + fine(SWATCH / 2), x + fine(SWATCH));
        let block = [(x, y - fine(4)), (end, y + fine(4))];
        match &self.shape {
            Shape::Lines(_, width) => {
                area.draw(&PathElement::new([(x, y), (end, y)], stroke(self.role, *width)))
            }
            Shape::Spreads(..) => {
                area.draw(&PathElement::new([(x, y), (end, y)], stroke(self.role, 1.4)))
            }
            Shape::Verticals(_, width) => {
                let ends = [(middle, y - fine(6)), (middle, y + fine(6))];
                area.draw(&PathElement::new(ends, stroke(self.role, *width)))
            }
            Shape::Dots(..) => area.draw(&dot((middle, y), 3.0, self.role)),
            Shape::Crosses(_) => area.draw(&cross((middle, y), self.role)),
            Shape::Band(..) | Shape::Spans(..) => {
                area.draw(&Rectangle::new(block, filled(self.role, 0.3)))
            }
            Shape::Bars(_) => area.draw(&Rectangle::new(block, filled(self.role, 1.0))),
            Shape::Words(_) | Shape::Named(_) | Shape::Flags(_) => Ok(()),
        }
    }

    fn draw(&self, chart: &mut Chart<'_, '_>, panel: &Panel) -> Result<(), DrawingError> {
        let (x, y, role) = (panel.x.span, panel.y.span, self.role);
        let apart = |places: &[Place]| apart(places, |place| chart.backend_coord(place));
        let area = chart.plotting_area();
        match &self.shape {
            Shape::Lines(lines, width) => {
                let mut pieces = lines.iter().flat_map(|line| within((x, y), line));
                pieces.try_for_each(|line| area.draw(&PathElement::new(line, stroke(role, *width))))
            }
            Shape::Dots(places, radius) => apart(places)
                .into_iter()
                .try_for_each(|place| area.draw(&dot(place, *radius, role))),
            Shape::Spreads(spreads, above) => {
                let pixel = (y.high - y.low) / f64::from(panel.height);
                let row = |pixels: f64| y.high + pixels * pixel;
                spreads.iter().try_for_each(|(from, to)| {
                    let tick = |x: f64| [(x, row(above - 3.0)), (x, row(above + 3.0))];
                    let bar = [(*from, row(*above)), (*to, row(*above))];
                    [tick(*from), bar, tick(*to)]
                        .into_iter()
                        .try_for_each(|line| area.draw(&PathElement::new(line, stroke(role, 1.4))))
                })
            }
            // Only recordings have them.
            Shape::Named(_) | Shape::Flags(_) => Ok(()),
            Shape::Crosses(places) => {
                apart(places).into_iter().try_for_each(|place| area.draw(&cross(place, role)))
            }
            Shape::Verticals(places, width) => places.iter().try_for_each(|at| {
                let ends = vec![(*at, y.low), (*at, y.high)];
                area.draw(&PathElement::new(ends, stroke(role, *width)))
            }),
            Shape::Band(low, high) => {
                let corners = [(x.low, *low), (x.high, *high)];
                area.draw(&Rectangle::new(corners, filled(role, 0.18)))
            }
            Shape::Spans(places, density) => places.iter().try_for_each(|(from, to)| {
                let corners = [(*from, y.low), (*to, y.high)];
                area.draw(&Rectangle::new(corners, filled(role, *density)))
            }),
            Shape::Bars(bars) => bars.iter().try_for_each(|(from, to)| {
                area.draw(&Rectangle::new([*from, *to], filled(role, 1.0)))
            }),
            Shape::Words(words) => {
                let style = letters(role).pos(Pos::new(HPos::Left, VPos::Center));
                words.iter().try_for_each(|(place, text)| {
                    let text = Text::new(text.clone(), (fine(5), 0), style.clone());
                    area.draw(&(EmptyElement::at(*place) + text))
                })
            }
        }
    }
}

/// Places without those that the sign at one before them hides.
fn apart(places: &[Place], drawn_at: impl Fn(&Place) -> (i32, i32)) -> Vec<Place> {
    /// Side of a square in which one sign hides the others, in pixels.
    const SQUARE: u32 = 4;
    let mut taken = HashSet::new();
    let square = |place: &Place| {
        let (x, y) = drawn_at(place);
        (x.div_euclid(fine(SQUARE)), y.div_euclid(fine(SQUARE)))
    };
    places.iter().filter(|place| taken.insert(square(place))).copied().collect()
}

fn dot<P>(place: P, radius: f64, role: Role) -> Circle<P, i32> {
    #[expect(clippy::cast_possible_truncation, reason = "a few pixels")]
    let radius = (radius * f64::from(FINE)).round() as i32;
    Circle::new(place, radius, filled(role, 1.0))
}

fn cross<P>(place: P, role: Role) -> Cross<P, i32> {
    Cross::new(place, fine(4), stroke(role, 1.8))
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

    /// Red, green and blue on light ground.
    pub(super) const fn rgb(self) -> (u8, u8, u8) {
        let [_, red, green, blue] = self.shades().0.to_be_bytes();
        (red, green, blue)
    }
}

/// The rules that give the lines and texts of figures their shade.
pub(super) fn figure_style() -> String {
    let (mut light, mut dark, mut rules) = (String::new(), String::new(), String::new());
    for (number, role) in Role::all().enumerate() {
        let (on_light, on_dark) = role.shades();
        write!(light, "--c{number}:#{on_light:06X};").unwrap_or_default();
        write!(dark, "--c{number}:#{on_dark:06X};").unwrap_or_default();
        for part in ["stroke", "fill"] {
            write!(rules, "[{part}=\"#{on_light:06X}\"]{{{part}:var(--c{number})}}")
                .unwrap_or_default();
        }
    }
    format!(
        ":root{{{light}}}@media (prefers-color-scheme:dark){{:root{{{dark}}}}}\
         @media print{{:root{{{light}}}}}{rules}"
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::figure::Span;

    fn svg(panel: Panel, name: &str) -> String {
        let (name, panels) = (name.to_owned(), vec![panel]);
        draw(&Figure { file: String::new(), name, width: 300, panels, caption: String::new() })
            .unwrap()
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
        let (red, green, blue) = Role::Model.rgb();
        let shade = format!("#{red:02X}{green:02X}{blue:02X}");
        let line = parsed.descendants().find(|node| node.attribute("stroke") == Some(&shade));
        let points = line.unwrap().attribute("points").unwrap();
        let numbers: Vec<i32> =
            points.split([',', ' ']).filter_map(|number| number.parse().ok()).collect();
        let [from_x, from_y, to_x, to_y] = numbers[..] else { panic!("{points}") };
        assert!((to_x - from_x - fine(300 - LEFT - RIGHT - 2)).abs() <= fine(1), "{points}");
        assert!((from_y - to_y - fine(100)).abs() <= fine(1), "{points}");
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

    #[test]
    fn a_shade_means_one_thing() {
        let mut shades: Vec<u32> = Role::all().map(|role| role.shades().0).collect();
        shades.sort_unstable();
        shades.dedup();
        assert_eq!(shades.len(), Role::all().count());
    }

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
