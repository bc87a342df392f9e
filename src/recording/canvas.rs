//! A sheet to draw a plot on in a 2D view: Rerun has no x-y plot that follows a cursor.
//!
//! The view's y axis points down, both axes have the same scale, and there are no
//! ticks, so data are mapped onto a sheet of fixed size with a grid of its own.
//!
//! A drawing is lines, points and texts on it, each part at an entity of its own. What stays is
//! written once; what changes along a timeline has a row per drawing.

use std::ops::RangeInclusive;

use rerun::datatypes::Vec2D;
use rerun::{AsComponents, Color, EntityPath, LineStrips2D, Points2D, SerializedComponentColumn};

use super::chunk::{Chunks, Index};
use super::error::RecordError;
use super::palette::{Rgb, color};
use super::paths::at;

pub(super) use crate::figure::{Place, Span};

/// A line through places of the sheet, and its colour.
pub(super) type Strip = (Vec<Vec2D>, Rgb);

/// A filled circle, with the name that a pointer shows.
#[derive(Clone, Debug)]
pub(super) struct Dot {
    pub(super) at: Vec2D,
    pub(super) radius: f32,
    pub(super) rgb: Rgb,
    pub(super) name: Option<String>,
}

/// A text, its middle in the horizontal and its upper end.
pub(super) type Text = (Vec2D, String, Rgb);

/// Width and height of the sheet.
pub(super) const SHEET: (f32, f32) = (1600.0, 640.0);

/// Height of a line of text on a sheet in a window of 1280 points.
pub(super) const LINE: f32 = 44.0;

/// Width and height of the sheets in the tabs below a record, which share one view.
pub(super) const TAB: (f32, f32) = (1840.0, 376.0);

/// How far below its point the middle of a text is drawn.
const LABEL_DROP: f32 = 18.0;

/// Room of a text on a sheet in a window of 1280 points.
pub(super) fn width(text: &str) -> f32 {
    /// Width of a letter on the sheet, where it is shown at half of its size.
    const LETTER: f32 = 14.0;
    let letters = text.lines().map(|line| line.chars().count()).max().unwrap_or(0);
    LETTER * (letters + 2) as f32
}

/// Part of the sheet that data are mapped onto.
#[derive(Clone, Copy, Debug)]
pub(super) struct Plot {
    pub(super) left: f32,
    pub(super) right: f32,
    pub(super) top: f32,
    pub(super) bottom: f32,
    pub(super) x_span: Span,
    pub(super) y_span: Span,
}

impl Plot {
    /// A plot between two columns and two rows of the sheet.
    pub(super) fn new(
        (left, right): (f32, f32),
        rows: RangeInclusive<f32>,
        (x_span, y_span): (Span, Span),
    ) -> Self {
        Self { left, right, top: *rows.start(), bottom: *rows.end(), x_span, y_span }
    }

    pub(super) fn x(&self, value: f64) -> f32 {
        #[expect(clippy::cast_possible_truncation, reason = "a place on the sheet")]
        let part = self.x_span.part(value) as f32;
        self.left + part * (self.right - self.left)
    }

    pub(super) fn y(&self, value: f64) -> f32 {
        #[expect(clippy::cast_possible_truncation, reason = "a place on the sheet")]
        let part = self.y_span.part(value) as f32;
        self.bottom - part * (self.bottom - self.top)
    }

    /// Data as a place on the sheet.
    pub(super) fn at(&self, (x, y): Place) -> Vec2D {
        Vec2D::new(self.x(x), self.y(y))
    }

    /// A line from edge to edge at `x`.
    pub(super) fn vertical(&self, x: f64) -> Vec<Vec2D> {
        vec![Vec2D::new(self.x(x), self.top), Vec2D::new(self.x(x), self.bottom)]
    }

    /// A line from edge to edge at `y`.
    pub(super) fn level(&self, y: f64) -> Vec<Vec2D> {
        vec![Vec2D::new(self.left, self.y(y)), Vec2D::new(self.right, self.y(y))]
    }

    pub(super) fn frame(&self) -> Vec<Vec2D> {
        let [left, right, top, bottom] = [self.left, self.right, self.top, self.bottom];
        let corners = [(left, top), (right, top), (right, bottom), (left, bottom), (left, top)];
        corners.map(|(x, y)| Vec2D::new(x, y)).to_vec()
    }

    /// Where a text is put to be so far below the plot.
    pub(super) fn below(&self, x: f64, distance: f32) -> Vec2D {
        Vec2D::new(self.x(x), self.bottom + distance)
    }

    /// Where a text is put to end beside `y`, left of the plot: above the texts below it.
    pub(super) fn left_of(&self, y: f64, text: &str) -> Vec2D {
        /// Room below its middle.
        const BELOW: f32 = 14.0;
        let middle = self.y(y).min(self.bottom - BELOW);
        Vec2D::new(self.left - 0.5 * width(text), middle - LABEL_DROP)
    }

    /// Where a text is put to begin beside a place; one that would run over the frame from within the
    /// plot ends there, if there is room before it.
    pub(super) fn beside(&self, place: Place, text: &str) -> Vec2D {
        /// Half the height of a text, and how far one may reach beyond the frame.
        const HALF: f32 = 14.0;
        let Vec2D([x, y]) = self.at(place);
        let (x, room) = (x.max(self.left), width(text));
        let is_over = x < self.right - 1.0 && x + room > self.right + HALF && x - room > self.left;
        let middle = if is_over { x - 0.5 * room } else { x + 0.5 * room };
        let y = y.min(self.bottom - HALF).max(self.top + HALF);
        Vec2D::new(middle, y - LABEL_DROP)
    }
}

/// Leaves out points of a curve (x ascending) that the line between their neighbours
/// meets to within [`INVISIBLE`]: a swinging door that opens no wider than that.
pub(super) fn simplified(points: Vec<Vec2D>) -> Vec<Vec2D> {
    let mut kept: Vec<Vec2D> = Vec::new();
    let mut door = (f32::NEG_INFINITY, f32::INFINITY);
    let mut last: Option<Vec2D> = None;
    for point in points {
        let Some(&anchor) = kept.last() else {
            kept.push(point);
            continue;
        };
        let slope =
            |from: Vec2D, shift: f32| (point.y() + shift - from.y()) / (point.x() - from.x());
        let here = slope(anchor, 0.0);
        let (anchor, fresh) = match last.filter(|_| here < door.0 || here > door.1) {
            Some(corner) => {
                kept.push(corner);
                (corner, true)
            }
            None => (anchor, false),
        };
        let (low, high) = if fresh { (f32::NEG_INFINITY, f32::INFINITY) } else { door };
        door = (low.max(slope(anchor, -INVISIBLE)), high.min(slope(anchor, INVISIBLE)));
        last = Some(point);
    }
    kept.extend(last);
    kept
}

/// A third of a screen's pixel, on the sheet.
const INVISIBLE: f32 = 0.5;

/// Radius of a text's own point: too small to be seen.
pub(super) const HIDDEN: f32 = 0.01;

/// The parts of a drawing, which lie below one root; each is drawn in front of the one before.
pub(super) struct Layers<'c> {
    chunks: &'c mut Chunks,
    root: EntityPath,
    /// The moments of the rows; none where there is one that stays.
    index: Option<Index>,
    /// Where the next part is drawn: behind those with a higher number.
    order: f32,
    /// Whether the index has a moment before all rows, at which the last one is seen.
    opens_on_last: bool,
}

impl<'c> Layers<'c> {
    /// A drawing below `root` that stays.
    pub(super) fn fixed(chunks: &'c mut Chunks, root: impl Into<EntityPath>) -> Self {
        Self { chunks, root: root.into(), index: None, order: 1.0, opens_on_last: false }
    }

    /// A drawing with a row at each moment of `index`.
    pub(super) fn rows(chunks: &'c mut Chunks, root: impl Into<EntityPath>, index: Index) -> Self {
        Self { index: Some(index), ..Self::fixed(chunks, root) }
    }

    /// These parts in front of those of another drawing.
    pub(super) fn in_front(self) -> Self {
        Self { order: 100.0, ..self }
    }

    /// These rows after a copy of the last one, for which the index has a moment of its own.
    pub(super) fn opening_on_last(self) -> Self {
        Self { opens_on_last: true, ..self }
    }

    /// Whether all of it stays.
    pub(super) fn is_fixed(&self) -> bool {
        self.index.is_none()
    }

    /// The lines of each row.
    pub(super) fn strips(
        &mut self,
        path: &str,
        radius: f32,
        rows: Vec<Vec<Strip>>,
    ) -> Result<(), RecordError> {
        let (strips, lengths) = self.flattened(rows);
        let (strips, rgbs): (Vec<_>, Vec<_>) = strips.into_iter().unzip();
        let style = LineStrips2D::update_fields().with_radii([radius]);
        let style = style.with_draw_order(self.next_order());
        let strips = LineStrips2D::update_fields().with_strips(strips);
        match shared(&rgbs) {
            Some(rgb) => self.put(path, &style.with_colors([color(rgb)]), (&strips, &lengths)),
            None => self.put(path, &style, (&strips.with_colors(colors(&rgbs)), &lengths)),
        }
    }

    /// The circles of each row.
    pub(super) fn dots(&mut self, path: &str, rows: Vec<Vec<Dot>>) -> Result<(), RecordError> {
        /// More of them fill an area, and are drawn smaller.
        const MANY: usize = 1000;
        let most = rows.iter().map(Vec::len).max().unwrap_or(0);
        let radius = |dot: &Dot| if most < MANY { dot.radius } else { dot.radius.min(1.2) };
        let (dots, lengths) = self.flattened(rows);
        let rgbs: Vec<Rgb> = dots.iter().map(|dot| dot.rgb).collect();
        let mut style = Points2D::update_fields().with_draw_order(self.next_order());
        let mut points = Points2D::update_fields().with_positions(dots.iter().map(|dot| dot.at));
        match shared(&rgbs) {
            Some(rgb) => style = style.with_colors([color(rgb)]),
            None => points = points.with_colors(colors(&rgbs)),
        }
        match shared(&dots.iter().map(radius).collect::<Vec<_>>()) {
            Some(radius) => style = style.with_radii([radius]),
            None => points = points.with_radii(dots.iter().map(radius)),
        }
        if dots.iter().any(|dot| dot.name.is_some()) {
            let names = dots.iter().map(|dot| dot.name.clone().unwrap_or_default());
            points = points.with_labels(names);
            style = style.with_show_labels(false);
        }
        self.put(path, &style, (&points, &lengths))
    }

    /// The texts of each row.
    pub(super) fn texts(&mut self, path: &str, rows: Vec<Vec<Text>>) -> Result<(), RecordError> {
        let (texts, lengths) = self.flattened(rows);
        let rgbs: Vec<Rgb> = texts.iter().map(|(.., rgb)| *rgb).collect();
        let mut points = Points2D::update_fields().with_positions(texts.iter().map(|text| text.0));
        points = points.with_labels(texts.iter().map(|text| text.1.clone()));
        let mut style = Points2D::update_fields().with_radii([HIDDEN]).with_show_labels(true);
        match shared(&rgbs) {
            Some(rgb) => style = style.with_colors([color(rgb)]),
            None => points = points.with_colors(colors(&rgbs)),
        }
        self.put(path, &style, (&points, &lengths))
    }

    /// Anything else that stays.
    pub(super) fn stays(&mut self, path: &str, data: &dyn AsComponents) -> Result<(), RecordError> {
        self.chunks.push_static(at(&self.root, path), data)
    }

    /// Anything else, of which each row has so many.
    pub(super) fn push(
        &mut self,
        path: &str,
        data: &dyn AsComponents,
        lengths: &[usize],
    ) -> Result<(), RecordError> {
        let batches = data.as_serialized_batches().into_iter();
        let columns = batches.map(|batch| batch.partitioned(lengths.iter().copied()));
        let columns: Vec<SerializedComponentColumn> = columns.collect::<Result<_, _>>()?;
        self.chunks.push(at(&self.root, path), self.index.clone().unwrap_or_default(), columns)
    }

    /// What all rows share, and the rows with how many each of them has.
    fn put(
        &mut self,
        path: &str,
        style: &dyn AsComponents,
        (data, lengths): (&dyn AsComponents, &[usize]),
    ) -> Result<(), RecordError> {
        if self.is_fixed() {
            let parts = [data.as_serialized_batches(), style.as_serialized_batches()].concat();
            return self.stays(path, &parts);
        }
        self.stays(path, style)?;
        self.push(path, data, lengths)
    }

    /// What is in all rows, with the one that is opened on, and how much of it is in each.
    fn flattened<T: Clone>(&self, mut rows: Vec<Vec<T>>) -> (Vec<T>, Vec<usize>) {
        if let Some(last) = rows.last().filter(|_| self.opens_on_last).cloned() {
            rows.insert(0, last);
        }
        let lengths = rows.iter().map(Vec::len).collect();
        (rows.into_iter().flatten().collect(), lengths)
    }

    fn next_order(&mut self) -> f32 {
        self.order += 1.0;
        self.order
    }
}

/// What all of `several` are, where they are alike.
fn shared<T: PartialEq + Copy>(several: &[T]) -> Option<T> {
    let first = *several.first()?;
    several.iter().all(|other| *other == first).then_some(first)
}

fn colors(rgbs: &[Rgb]) -> impl Iterator<Item = Color> {
    rgbs.iter().map(|rgb| color(*rgb))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_straight_line_needs_its_ends_only() {
        let line: Vec<_> = (0..50).map(|k| Vec2D::new(k as f32, 3.0 * k as f32)).collect();
        assert_eq!(simplified(line), [Vec2D::new(0.0, 0.0), Vec2D::new(49.0, 147.0)]);
        assert_eq!(simplified(Vec::new()), []);
    }

    #[test]
    fn a_simplified_curve_stays_where_it_was() {
        let curve = |x: f32| 40.0 * (x / 30.0).sin();
        let points: Vec<_> = (0..400).map(|k| Vec2D::new(k as f32, curve(k as f32))).collect();
        let kept = simplified(points.clone());
        assert!(kept.len() < 80, "{}", kept.len());
        for pair in kept.windows(2) {
            let inside = points.iter().filter(|p| p.x() > pair[0].x() && p.x() < pair[1].x());
            for point in inside {
                let part = (point.x() - pair[0].x()) / (pair[1].x() - pair[0].x());
                let line = pair[0].y() + part * (pair[1].y() - pair[0].y());
                assert!((line - point.y()).abs() < 2.0 * INVISIBLE, "{point:?}");
            }
        }
    }
}
