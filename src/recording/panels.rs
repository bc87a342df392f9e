//! Panels as strips and points on a sheet, which Rerun's own plots cannot draw: the other back end of
//! [`figure`](crate::figure), beside the SVG of a report.

use std::ops::RangeInclusive;

use rerun::datatypes::Vec2D;

use super::canvas::{HALF_LETTER, Labels, Plot, Strips, simplified};
use super::error::RecordError;
use super::layers::{Ink, Layers};
use super::palette::{self, Rgb};
use super::paths::of_model;
use crate::figure::{Axis, Mark, Panel, Role, Shape};

/// Half the width of the lines that fill an area: their ends are round.
pub(super) const HATCH: f32 = 1.5;

/// Height of a line of text on a sheet in a window of 1280 points.
const LINE: f32 = 44.0;

/// Where the name of a panel stands, and its legend.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Names {
    Above,
    None,
}

/// A panel with its place on the sheet.
pub(super) struct Placed {
    panel: Panel,
    names: Names,
    pub(super) plot: Plot,
}

impl Placed {
    /// A panel between two columns and two rows; above it stand its name and its legend.
    pub(super) fn new(panel: Panel, columns: (f32, f32), rows: RangeInclusive<f32>) -> Self {
        let plot = Plot::within(columns, rows, panel.x.span, panel.y.span);
        Self { panel, names: Names::Above, plot }
    }

    /// One so low that it has no room for its name and its legend.
    pub(super) fn unnamed(panel: Panel, columns: (f32, f32), rows: RangeInclusive<f32>) -> Self {
        Self { names: Names::None, ..Self::new(panel, columns, rows) }
    }

    /// Frame, grid, and the texts of ticks, name and legend.
    fn around(&self, grid: &mut Strips, texts: &mut Labels) {
        let (Panel { x, y, .. }, plot) = (&self.panel, &self.plot);
        grid.push(plot.frame());
        grid.extend(x.ticks.iter().map(|(x, _)| plot.vertical(*x).to_vec()));
        grid.extend(y.ticks.iter().map(|(y, _)| plot.level(*y).to_vec()));
        for (x, text) in apart(x, |x| plot.x(x), width) {
            texts.put_in(palette::BORDER, plot.below(x, 2.0), text);
        }
        for (y, text) in apart(y, |y| plot.y(y), |_| LINE) {
            texts.put_in(palette::BORDER, plot.left_of(y, 0.5 * width(&text)), text);
        }
        if self.names == Names::None {
            return;
        }
        let named = self
            .panel
            .marks
            .iter()
            .filter_map(|mark| Some((rgb(mark.role), format!("– {}", mark.name.as_deref()?))));
        let name = [y.name.as_str(), x.name.as_str()].into_iter().filter(|name| !name.is_empty());
        let name = (palette::BORDER, name.collect::<Vec<_>>().join(" over "));
        let names: Vec<(Rgb, String)> = [name].into_iter().chain(named).collect();
        let whole: f32 = names.iter().map(|(_, text)| width(text)).sum();
        // Nothing is cut at the sides of the sheet.
        let (start, end) = (plot.x(x.span.low) - 100.0, plot.x(x.span.high) + 15.0);
        let mut left = (plot.x(plot.middle()) - 0.5 * whole).min(end - whole).max(start);
        for (rgb, text) in names {
            let half = 0.5 * width(&text);
            texts.put_in(rgb, Vec2D::new(left + half, plot.top - LINE), text);
            left += 2.0 * half;
        }
    }
}

/// Room of a text on a sheet in a window of 1280 points.
fn width(text: &str) -> f32 {
    2.0 * HALF_LETTER * (text.chars().count() + 2) as f32
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
fn rgb(role: Role) -> Rgb {
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
    }
}

/// What is drawn of a mark.
#[derive(Clone, Default)]
struct Drawn {
    strips: Strips,
    points: Vec<Vec2D>,
    texts: Labels,
}

impl Drawn {
    fn add(&mut self, mark: &Mark, plot: &Plot) {
        let (x, y) = (plot.x_span(), plot.y_span());
        match &mark.shape {
            Shape::Lines(lines, _) => {
                let lines = lines.iter().map(|line| plot.places(line.iter().copied()));
                // What goes back is no curve over its axis.
                let is_curve = |line: &[Vec2D]| line.is_sorted_by(|a, b| a.x() < b.x());
                let thin = |line: Vec<Vec2D>| if is_curve(&line) { simplified(line) } else { line };
                self.strips.extend(lines.map(thin));
            }
            Shape::Dots(places) => self.points.extend(plot.places(places.iter().copied())),
            Shape::Crosses(places) => self.strips.extend(places.iter().flat_map(|(x, y)| {
                let Vec2D([x, y]) = plot.at(*x, *y);
                let line = |dy: f32| vec![Vec2D::new(x - 4.0, y - dy), Vec2D::new(x + 4.0, y + dy)];
                [line(4.0), line(-4.0)]
            })),
            Shape::Verticals(places, _) => {
                self.strips.extend(places.iter().map(|x| plot.vertical(*x).to_vec()));
            }
            Shape::Band(low, high) => {
                let inside = [*low, *high]
                    .into_iter()
                    .filter(|y| (0.0..=1.0).contains(&plot.y_span().part(*y)));
                self.strips.extend(inside.map(|y| plot.level(y).to_vec()));
            }
            Shape::Spans(spans, _) => {
                let area = |(from, to): &(f64, f64)| filled(plot, (*from, y.low), (*to, y.high));
                self.strips.extend(spans.iter().map(area));
            }
            Shape::Bars(bars) => {
                self.strips.extend(bars.iter().map(|(from, to)| filled(plot, *from, *to)));
            }
            Shape::Words(words) => {
                for (place, text) in words {
                    let Vec2D([left, y]) = plot.at(place.0.max(x.low), place.1);
                    self.texts.put(Vec2D::new(left + 0.5 * width(text), y - 14.0), text.clone());
                }
            }
        }
    }
}

/// An area that is filled by one line to and fro.
fn filled(plot: &Plot, from: (f64, f64), to: (f64, f64)) -> Vec<Vec2D> {
    let [a, b] = [from, to].map(|(x, y)| plot.at(x, y));
    let (top, bottom) = (a.y().min(b.y()), a.y().max(b.y()));
    let (top, bottom) = ((top + HATCH).min(bottom), (bottom - HATCH).max(top));
    let columns = hatched(a.x().min(b.x()), a.x().max(b.x())).enumerate();
    let column = |(number, x): (usize, f32)| {
        let (from, to) = if number % 2 == 0 { (top, bottom) } else { (bottom, top) };
        [Vec2D::new(x, from), Vec2D::new(x, to)]
    };
    columns.flat_map(column).collect()
}

/// Places between two others that lines of radius [`HATCH`] cover without a gap.
pub(super) fn hatched(left: f32, right: f32) -> impl Iterator<Item = f32> {
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "small")]
    let count = ((right - left) / (1.2 * HATCH)).ceil().max(1.0) as usize;
    let step = (right - left - 2.0 * HATCH).max(0.0) / count as f32;
    (0..=count).map(move |k| left + HATCH + step * k as f32)
}

/// Draws the panels of each row of a drawing, an entity for each mark: named as it, or as its shape;
/// of a model in a drawing of one row with its number, so that it can be hidden.
pub(super) fn add(layers: &mut Layers<'_>, rows: &[Vec<Placed>]) -> Result<(), RecordError> {
    let marks = || rows.iter().flatten().flat_map(|placed| &placed.panel.marks);
    let mut parts: Vec<(String, &Mark)> = Vec::new();
    for mark in marks() {
        let part = part(mark, rows.len());
        if parts.iter().all(|(known, _)| *known != part) {
            parts.push((part, mark));
        }
    }
    let (behind, before): (Vec<_>, Vec<_>) =
        parts.into_iter().partition(|(_, mark)| matches!(mark.shape, Shape::Spans(..)));
    behind.iter().try_for_each(|part| add_part(layers, rows, part))?;
    let (mut grids, mut texts) = (Vec::new(), Vec::new());
    for row in rows {
        let (mut grid, mut labels) = (Strips::new(), Labels::default());
        for placed in row {
            placed.around(&mut grid, &mut labels);
        }
        grids.push(grid);
        texts.push(labels);
    }
    layers.strips("grid", palette::GRID, 0.7, grids)?;
    before.iter().try_for_each(|part| add_part(layers, rows, part))?;
    layers.texts("texts", Ink::Own, texts)
}

/// The entity of a mark.
fn part(mark: &Mark, rows: usize) -> String {
    let name = mark.name.as_deref().unwrap_or(match mark.shape {
        Shape::Lines(..) => "lines",
        Shape::Dots(_) => "dots",
        Shape::Crosses(_) => "crosses",
        Shape::Verticals(..) => "verticals",
        Shape::Band(..) => "band",
        Shape::Spans(..) => "spans",
        Shape::Bars(_) => "bars",
        Shape::Words(_) => "words",
    });
    let name = name.replace(|c: char| !c.is_alphanumeric(), "_");
    match mark.role {
        Role::Model if rows == 1 => of_model(&name, 0),
        Role::Revision(one) if rows == 1 => of_model(&name, one.place() + 1),
        _ => name,
    }
}

fn add_part(
    layers: &mut Layers<'_>,
    rows: &[Vec<Placed>],
    (name, first): &(String, &Mark),
) -> Result<(), RecordError> {
    let own = |mark: &Mark| part(mark, rows.len()) == *name;
    let mut inks = Vec::new();
    let mut all = Vec::new();
    for row in rows {
        let (mut drawn, mut ink) = (Drawn::default(), rgb(first.role));
        for placed in row {
            for mark in placed.panel.marks.iter().filter(|mark| own(mark)) {
                drawn.add(mark, &placed.plot);
                ink = rgb(mark.role);
            }
        }
        if let Shape::Spans(_, density) = first.shape {
            ink = palette::between(palette::GROUND, ink, 1.5 * density);
        }
        inks.push(ink);
        all.push(drawn);
    }
    let ink = match inks.as_slice() {
        [one, others @ ..] if others.iter().all(|other| other == one) => Ink::One(*one),
        _ => Ink::ByRow(inks),
    };
    let points: usize = all.iter().map(|drawn| drawn.points.len()).max().unwrap_or(0);
    #[expect(clippy::cast_possible_truncation, reason = "a few pixels")]
    match first.shape {
        Shape::Dots(_) => {
            // Of many only a filled area would be seen.
            let radius = if points < 1000 { 3.0 } else { 1.2 };
            layers.points(name, ink, radius, all.into_iter().map(|drawn| drawn.points))
        }
        Shape::Words(_) => layers.texts(name, ink, all.into_iter().map(|drawn| drawn.texts)),
        Shape::Lines(_, width) | Shape::Verticals(_, width) => {
            layers.strips(name, ink, width as f32, all.into_iter().map(|drawn| drawn.strips))
        }
        Shape::Band(..) | Shape::Crosses(_) => {
            layers.strips(name, ink, 1.0, all.into_iter().map(|drawn| drawn.strips))
        }
        Shape::Spans(..) | Shape::Bars(_) => {
            layers.strips(name, ink, HATCH, all.into_iter().map(|drawn| drawn.strips))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_area_is_filled_and_no_wider_than_its_place() {
        let places: Vec<_> = hatched(10.0, 40.0).collect();
        assert!((places[0] - 11.5).abs() < 1e-4 && (places[places.len() - 1] - 38.5).abs() < 1e-4);
        assert!(places.windows(2).all(|pair| pair[1] - pair[0] < 2.0 * HATCH));
    }
}
