//! Panels as strips and points on a sheet, which Rerun's own plots cannot draw: the other back end of
//! [`figure`](crate::figure), beside the SVG of a report.

use std::ops::RangeInclusive;

use rerun::datatypes::Vec2D;

use super::canvas::{Dot, LINE, Layers, Plot, Strip, Text, simplified, width};
use super::error::RecordError;
use super::palette::{self, Rgb};
use super::paths::of_model;
use crate::figure::{Axis, Mark, Panel, Place, Role, Shape, within};

/// Half the width of the lines that fill an area: their ends are round.
const HATCH: f32 = 1.5;

/// A panel with its place on the sheet, and what stands above it.
pub(super) struct Placed {
    panel: Panel,
    /// Its name and its legend, in lines.
    names: Vec<Vec<(Rgb, String)>>,
    pub(super) plot: Plot,
}

impl Placed {
    /// A panel between two columns and two rows; above it stand its name and its legend, for which it
    /// begins further below where they need several lines.
    pub(super) fn new(panel: Panel, columns: (f32, f32), rows: RangeInclusive<f32>) -> Self {
        let mut placed = Self::unnamed(panel, columns, rows);
        let plot = &mut placed.plot;
        let labels = placed.panel.y.ticks.iter().map(|(_, text)| width(text));
        let room = plot.right + 15.0 - (plot.left - labels.fold(100.0, f32::max));
        placed.names = names(&placed.panel, room);
        plot.top += LINE * placed.names.len().saturating_sub(1) as f32;
        placed
    }

    /// One so low that it has no room for its name and its legend.
    pub(super) fn unnamed(panel: Panel, columns: (f32, f32), rows: RangeInclusive<f32>) -> Self {
        let plot = Plot::new(columns, rows, (panel.x.span, panel.y.span));
        Self { panel, names: Vec::new(), plot }
    }

    /// Frame, grid, and the texts of ticks, name and legend.
    fn around(&self) -> (Vec<Strip>, Vec<Text>) {
        let (Panel { x, y, .. }, plot) = (&self.panel, &self.plot);
        let levels = y.ticks.iter().filter(|_| !y.has_names).map(|(y, _)| plot.level(*y));
        let grid = x.ticks.iter().map(|(x, _)| plot.vertical(*x)).chain(levels);
        let grid = grid.chain([plot.frame()]).map(|strip| (strip, palette::GRID)).collect();
        let mut texts = Vec::new();
        for (x, text) in apart(x, |x| plot.x(x), width) {
            texts.push((plot.below(x, 2.0), text, palette::BORDER));
        }
        // Of names none is left out.
        let room = |_: &str| if y.has_names { 0.0 } else { LINE };
        for (y, text) in apart(y, |y| plot.y(y), room) {
            texts.push((plot.left_of(y, &text), text, palette::BORDER));
        }
        for (line, names) in self.names.iter().enumerate() {
            let whole: f32 = names.iter().map(|(_, text)| width(text)).sum();
            let middle = f32::midpoint(plot.left, plot.right);
            let mut left = (middle - 0.5 * whole).min(plot.right + 15.0 - whole).max(0.0);
            let above = plot.top - LINE * (self.names.len() - line) as f32;
            for (rgb, text) in names {
                texts.push((Vec2D::new(left + 0.5 * width(text), above), text.clone(), *rgb));
                left += width(text);
            }
        }
        (grid, texts)
    }
}

/// The name of a panel and its legend in lines, each as long as there is `room` for.
fn names(panel: &Panel, room: f32) -> Vec<Vec<(Rgb, String)>> {
    let name = [panel.y.name.as_str(), panel.x.name.as_str()];
    let name = name.into_iter().filter(|name| !name.is_empty()).collect::<Vec<_>>().join(" over ");
    let name = broken(&name, room).into_iter().filter(|line| !line.is_empty());
    let name = name.map(|line| (palette::BORDER, line));
    let legend = panel.legend().map(|(mark, name)| (rgb(mark.role), format!("– {name}")));
    let mut lines: Vec<Vec<(Rgb, String)>> = Vec::new();
    for piece in name.chain(legend) {
        let taken =
            |line: &Vec<(Rgb, String)>| line.iter().map(|(_, text)| width(text)).sum::<f32>();
        match lines.last_mut() {
            Some(line) if taken(line) + width(&piece.1) <= room => line.push(piece),
            _ => lines.push(vec![piece]),
        }
    }
    lines
}

/// A text in lines for which there is `room`, as far as its words allow; a unit stays with its quantity.
fn broken(text: &str, room: f32) -> Vec<String> {
    let mut lines: Vec<String> = Vec::new();
    for word in text.replace(" [", "\u{a0}[").split(' ') {
        match lines.last_mut() {
            Some(line) if width(&format!("{line} {word}")) <= room => {
                line.push(' ');
                line.push_str(word);
            }
            _ => lines.push(word.to_owned()),
        }
    }
    lines.into_iter().map(|line| line.replace('\u{a0}', " ")).collect()
}

/// The ticks of an axis whose texts do not cover each other.
fn apart(
    axis: &Axis,
    at: impl Fn(f64) -> f32,
    room: impl Fn(&str) -> f32,
) -> impl Iterator<Item = (f64, String)> {
    let mut last: Option<(f32, f32)> = None;
    let ticks = axis.ticks.iter().filter(|(_, text)| !text.is_empty()).cloned();
    ticks.filter(move |(tick, text)| {
        let (place, own) = (at(*tick), room(text));
        let is_free =
            last.is_none_or(|(before, other)| (place - before).abs() >= 0.5 * (own + other));
        if is_free {
            last = Some((place, own));
        }
        is_free
    })
}

/// The colour of a meaning on the viewer's dark ground.
pub(super) fn rgb(role: Role) -> Rgb {
    match role {
        Role::Ink => palette::BORDER,
        Role::Faint => palette::RAW,
        Role::Grid => palette::GRID,
        Role::Input => palette::INPUT,
        Role::Measured => palette::MEASURED,
        Role::Smoothed => palette::SMOOTHED,
        Role::Accepted => palette::ACCEPTED,
        Role::Rejected | Role::Attention => palette::REJECTED,
        Role::Error => palette::ERROR,
        Role::Model => palette::model(0),
        Role::Noise => palette::NOISE,
        Role::Revision(one) => palette::model(one.place() + 1),
        Role::Own(red, green, blue) => (red, green, blue),
    }
}

/// What is drawn of the marks of one entity in one row.
#[derive(Clone, Default)]
struct Drawn {
    strips: Vec<Strip>,
    dots: Vec<Dot>,
    texts: Vec<Text>,
}

impl Drawn {
    fn add(&mut self, mark: &Mark, plot: &Plot) {
        let (x, y, rgb) = (plot.x_span, plot.y_span, rgb(mark.role));
        let is_inside = |place: &Place| {
            (0.0..=1.0).contains(&x.part(place.0)) && (0.0..=1.0).contains(&y.part(place.1))
        };
        let places = |line: Vec<Place>| line.into_iter().map(|at| plot.at(at)).collect::<Vec<_>>();
        match &mark.shape {
            Shape::Lines(lines, _) => {
                let pieces = lines.iter().flat_map(|line| within((x, y), line)).map(places);
                // What goes back is no curve over its axis.
                let is_curve = |line: &[Vec2D]| line.is_sorted_by(|a, b| a.x() < b.x());
                let thin = |line: Vec<Vec2D>| if is_curve(&line) { simplified(line) } else { line };
                self.strips.extend(pieces.map(|line| (thin(line), rgb)));
            }
            Shape::Dots(dots, radius) => {
                let dots = dots.iter().filter(|place| is_inside(place));
                self.dots.extend(dots.map(|place| dot(plot, *place, *radius, rgb)));
            }
            Shape::Named(dots) => self.dots.extend(dots.iter().map(|(place, radius, name)| Dot {
                name: Some(name.clone()),
                ..dot(plot, *place, *radius, rgb)
            })),
            Shape::Crosses(places) => self.strips.extend(places.iter().flat_map(|place| {
                let Vec2D([x, y]) = plot.at(*place);
                let line = |dy: f32| vec![Vec2D::new(x - 4.0, y - dy), Vec2D::new(x + 4.0, y + dy)];
                [(line(4.0), rgb), (line(-4.0), rgb)]
            })),
            Shape::Verticals(places, _) => {
                let inside = places.iter().filter(|at| (0.0..=1.0).contains(&x.part(**at)));
                self.strips.extend(inside.map(|at| (plot.vertical(*at), rgb)));
            }
            Shape::Band(low, high) => {
                let inside =
                    [low, high].into_iter().filter(|at| (0.0..=1.0).contains(&y.part(**at)));
                self.strips.extend(inside.map(|at| (plot.level(*at), rgb)));
            }
            Shape::Spans(spans, density) => {
                let shade = palette::between(palette::GROUND, rgb, 1.5 * density);
                let area = |(from, to): &(f64, f64)| [(*from, y.low), (*to, y.high)];
                self.strips.extend(spans.iter().map(|span| (filled(plot, area(span)), shade)));
            }
            Shape::Bars(bars) => {
                self.strips.extend(bars.iter().map(|bar| (filled(plot, (*bar).into()), rgb)));
            }
            Shape::Spreads(spreads, above) => {
                let bars = spreads.iter().flat_map(|ends| spread(plot, *ends, *above));
                self.strips.extend(bars.map(|line| (line, rgb)));
            }
            Shape::Words(words) => {
                let word = |(place, text): &(Place, String)| {
                    (plot.beside(*place, text), text.clone(), rgb)
                };
                self.texts.extend(words.iter().map(word));
            }
            Shape::Flags(flags) => {
                self.texts
                    .extend(flagged(plot, flags).into_iter().map(|(at, text)| (at, text, rgb)));
            }
        }
    }
}

fn dot(plot: &Plot, place: Place, radius: f64, rgb: Rgb) -> Dot {
    #[expect(clippy::cast_possible_truncation, reason = "a few pixels")]
    Dot { at: plot.at(place), radius: radius as f32, rgb, name: None }
}

/// An area that is filled by one line to and fro.
fn filled(plot: &Plot, corners: [Place; 2]) -> Vec<Vec2D> {
    let [a, b] = corners.map(|at| plot.at(at));
    let (top, bottom) = (a.y().min(b.y()), a.y().max(b.y()));
    let (top, bottom) = ((top + HATCH).min(bottom), (bottom - HATCH).max(top));
    let column = |(number, x): (usize, f32)| {
        let (from, to) = if number % 2 == 0 { (top, bottom) } else { (bottom, top) };
        [Vec2D::new(x, from), Vec2D::new(x, to)]
    };
    hatched(a.x().min(b.x()), a.x().max(b.x())).enumerate().flat_map(column).collect()
}

/// Places between two others that lines of radius [`HATCH`] cover without a gap.
fn hatched(left: f32, right: f32) -> impl Iterator<Item = f32> {
    /// Distance of two lines in radii: at 1.2 seams are seen where a line is thinner than two pixels.
    const APART: f32 = 0.8;
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "small")]
    let count = ((right - left) / (APART * HATCH)).ceil().max(1.0) as usize;
    let step = (right - left - 2.0 * HATCH).max(0.0) / count as f32;
    (0..=count).map(move |k| left + HATCH + step * k as f32)
}

/// A bar so far above the plot, as far as it reaches, with a tick at each end.
fn spread(plot: &Plot, (low, high): (f64, f64), above: f64) -> [Vec<Vec2D>; 3] {
    #[expect(clippy::cast_possible_truncation, reason = "a few pixels")]
    let row = plot.top - above as f32;
    let [low, high] = [low, high].map(|x| plot.x(x.clamp(plot.x_span.low, plot.x_span.high)));
    let tick = |x: f32| vec![Vec2D::new(x, row - 6.0), Vec2D::new(x, row + 6.0)];
    [tick(low), vec![Vec2D::new(low, row), Vec2D::new(high, row)], tick(high)]
}

/// Names below a plot, in as many lines as keep them from covering each other.
fn flagged(plot: &Plot, flags: &[(f64, String)]) -> Vec<(Vec2D, String)> {
    let mut taken: Vec<(usize, f32, f32)> = Vec::new();
    let place = |(x, text): &(f64, String)| {
        // With room between two of them: that of a letter was not seen in 0.41.0.
        let half = 0.5 * width(text) + 7.0;
        let x = plot.x(*x).min(plot.right + 60.0 - half).max(half);
        let collides = |line: usize| {
            taken.iter().any(|(at, other, room)| *at == line && (x - other).abs() < half + room)
        };
        let line = (0..=taken.len()).find(|line| !collides(*line)).unwrap_or(0);
        taken.push((line, x, half));
        (Vec2D::new(x, plot.bottom + 2.0 + 40.0 * line as f32), text.clone())
    };
    flags.iter().map(place).collect()
}

/// What is drawn at one entity.
struct Part {
    path: String,
    radius: f32,
    /// Whether it is drawn below all else.
    is_ground: bool,
    rows: Vec<Drawn>,
}

impl Part {
    fn of(mark: &Mark, path: String) -> Self {
        #[expect(clippy::cast_possible_truncation, reason = "a few pixels")]
        let radius = match mark.shape {
            Shape::Lines(_, width) | Shape::Verticals(_, width) => width as f32,
            Shape::Spans(..) | Shape::Bars(_) => HATCH,
            _ => 1.0,
        };
        Self { path, radius, is_ground: mark.is_ground(), rows: Vec::new() }
    }

    fn push(self, layers: &mut Layers<'_>) -> Result<(), RecordError> {
        let Self { path, radius, rows, .. } = self;
        if rows.iter().any(|row| !row.texts.is_empty()) {
            return layers.texts(&path, rows.into_iter().map(|row| row.texts).collect());
        }
        if rows.iter().any(|row| !row.dots.is_empty()) {
            return layers.dots(&path, rows.into_iter().map(|row| row.dots).collect());
        }
        layers.strips(&path, radius, rows.into_iter().map(|row| row.strips).collect())
    }
}

/// The entities of a drawing, which is made row by row.
struct Parts {
    /// Whether the drawing stays, and so do its models.
    is_fixed: bool,
    rows: usize,
    all: Vec<Part>,
}

impl Parts {
    fn of(layers: &Layers<'_>) -> Self {
        Self { is_fixed: layers.is_fixed(), rows: 0, all: Vec::new() }
    }

    /// Where a mark lies below the drawing: by its name, and of a model in a drawing that stays by its
    /// number, so that it can be hidden.
    fn path(&self, mark: &Mark) -> String {
        let of_shape = match mark.shape {
            Shape::Lines(..) => "lines",
            Shape::Dots(..) | Shape::Named(_) => "dots",
            Shape::Crosses(_) => "crosses",
            Shape::Verticals(..) => "verticals",
            Shape::Band(..) => "band",
            Shape::Spans(..) => "spans",
            Shape::Bars(_) => "bars",
            Shape::Spreads(..) => "spreads",
            Shape::Words(_) => "words",
            Shape::Flags(_) => "flags",
        };
        let letter = |c: char| if c.is_alphanumeric() || c == '/' { c } else { '_' };
        let name = mark.part.as_deref().or(mark.name.as_deref()).unwrap_or(of_shape);
        let name: String = name.chars().map(letter).collect();
        match mark.role {
            Role::Model if self.is_fixed => of_model(&name, 0),
            Role::Revision(one) if self.is_fixed => of_model(&name, one.place() + 1),
            _ => name,
        }
    }

    fn add_row<'m>(&mut self, marks: impl Iterator<Item = (&'m Mark, &'m Plot)>) {
        self.rows += 1;
        for (mark, plot) in marks {
            let path = self.path(mark);
            let place = self.all.iter().position(|part| part.path == path);
            let place = place.unwrap_or_else(|| {
                self.all.push(Part::of(mark, path));
                self.all.len() - 1
            });
            let rows = &mut self.all[place].rows;
            rows.resize_with(self.rows, Drawn::default);
            rows[self.rows - 1].add(mark, plot);
        }
    }

    /// Those that are drawn below all else, and the others.
    fn divided(mut self) -> (Vec<Part>, Vec<Part>) {
        for part in &mut self.all {
            part.rows.resize_with(self.rows, Drawn::default);
        }
        self.all.into_iter().partition(|part| part.is_ground)
    }
}

/// Draws the panels of each row of a drawing, an entity for each mark.
pub(super) fn add(
    layers: &mut Layers<'_>,
    rows: impl IntoIterator<Item = Vec<Placed>>,
) -> Result<(), RecordError> {
    let mut parts = Parts::of(layers);
    let (mut grids, mut texts) = (Vec::new(), Vec::new());
    for row in rows {
        let marks = row
            .iter()
            .flat_map(|placed| placed.panel.marks.iter().map(move |mark| (mark, &placed.plot)));
        parts.add_row(marks);
        let (grid, labels): (Vec<_>, Vec<_>) = row.iter().map(Placed::around).unzip();
        grids.push(grid.concat());
        texts.push(labels.concat());
    }
    let (ground, above) = parts.divided();
    ground.into_iter().try_for_each(|part| part.push(layers))?;
    layers.strips("grid", 0.7, grids)?;
    above.into_iter().try_for_each(|part| part.push(layers))?;
    layers.texts("texts", texts)
}

/// Draws marks in plots that are there, a row for each of `rows`.
pub(super) fn add_marks(
    layers: &mut Layers<'_>,
    rows: impl IntoIterator<Item = Vec<(Mark, Plot)>>,
) -> Result<(), RecordError> {
    let mut parts = Parts::of(layers);
    for row in rows {
        parts.add_row(row.iter().map(|(mark, plot)| (mark, plot)));
    }
    let (ground, above) = parts.divided();
    ground.into_iter().chain(above).try_for_each(|part| part.push(layers))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::figure::Span;

    #[test]
    fn an_area_is_filled_and_no_wider_than_its_place() {
        let places: Vec<_> = hatched(10.0, 40.0).collect();
        assert!((places[0] - 11.5).abs() < 1e-4 && (places[places.len() - 1] - 38.5).abs() < 1e-4);
        assert!(places.windows(2).all(|pair| pair[1] - pair[0] < 2.0 * HATCH));
    }

    #[test]
    fn a_name_that_is_too_long_for_its_panel_stands_in_two_lines() {
        let room = width("changes with the measured");
        let lines = broken("changes with the measured input's over lag [s]", room);
        assert_eq!(lines, ["changes with the measured", "input's over lag [s]"]);
        assert_eq!(
            broken("speed over input [%]", width("speed over input")),
            ["speed over", "input [%]"]
        );
        assert_eq!(broken("one_word_without_room", 10.0), ["one_word_without_room"]);
    }

    fn unit() -> (Span, Span) {
        (Span::new(0.0, 1.0), Span::new(0.0, 10.0))
    }

    #[test]
    fn no_line_and_no_dot_lies_on_the_frame_because_it_is_off_scale() {
        let (x, y) = unit();
        let plot = Plot::new((0.0, 100.0), 0.0..=100.0, (x, y));
        let curve = vec![(0.0, 5.0), (0.5, 40.0), (0.6, 41.0), (1.0, 5.0)];
        let mut drawn = Drawn::default();
        drawn.add(&Mark::lines(Role::Model, 1.0, vec![curve.clone()]), &plot);
        drawn.add(&Mark::dots(Role::Model, curve), &plot);
        assert_eq!((drawn.strips.len(), drawn.dots.len()), (2, 2));
        let along = |(strip, _): &Strip| {
            strip.windows(2).any(|pair| pair[0].y().total_cmp(&pair[1].y()).is_eq())
        };
        assert!(!drawn.strips.iter().any(along), "a piece along the frame");
    }

    #[test]
    fn names_that_would_cover_each_other_stand_below_one_another() {
        let plot = Plot::new((0.0, 1000.0), 0.0..=100.0, unit());
        let flags = [(0.5, "p = 100"), (0.51, "q = 104"), (0.9, "end")];
        let flags = flags.map(|(x, name)| (x, name.to_owned()));
        let rows: Vec<f32> = flagged(&plot, &flags).iter().map(|(at, _)| at.y()).collect();
        assert_eq!(rows, [102.0, 142.0, 102.0]);
    }
}
