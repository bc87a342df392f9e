//! A sheet to draw a plot on in a 2D view: Rerun has no x-y plot that follows a cursor.
//!
//! The view's y axis points down, both axes have the same scale, and there are no
//! ticks, so data are mapped onto a sheet of fixed size with a grid of its own.

use std::ops::RangeInclusive;

use rerun::Color;
use rerun::datatypes::Vec2D;

use super::palette::{Rgb, color};
pub(super) use crate::figure::error_share::short;
pub(super) use crate::figure::{Place, Span, thinned_to};
use crate::wording::number;

/// Lines of one drawing.
pub(super) type Strips = Vec<Vec<Vec2D>>;

/// Width and height of the sheet.
pub(super) const SHEET: (f32, f32) = (1600.0, 640.0);

/// Part of the sheet that data are mapped onto.
#[derive(Clone, Copy, Debug)]
pub(super) struct Plot {
    left: f32,
    right: f32,
    pub(super) top: f32,
    pub(super) bottom: f32,
    x: Span,
    y: Span,
}

/// How far below its point the middle of a text is drawn.
const LABEL_DROP: f32 = 14.0;

/// Half the width of a letter on the sheet, where it is shown at half of its size.
pub(super) const HALF_LETTER: f32 = 7.0;

/// Left and right end of all plots: room for labels on the left.
const SIDES: (f32, f32) = (120.0, SHEET.0 - 15.0);

impl Plot {
    /// A plot over the whole width, from `rows.start` to `rows.end` of the sheet.
    pub(super) fn new(rows: RangeInclusive<f32>, x: Span, y: Span) -> Self {
        Self::within(SIDES, rows, x, y)
    }

    /// A plot between two columns and two rows of the sheet.
    pub(super) fn within(
        (left, right): (f32, f32),
        rows: RangeInclusive<f32>,
        x: Span,
        y: Span,
    ) -> Self {
        Self { left, right, top: *rows.start(), bottom: *rows.end(), x, y }
    }

    pub(super) fn x_span(&self) -> Span {
        self.x
    }

    pub(super) fn y_span(&self) -> Span {
        self.y
    }

    pub(super) fn x(&self, value: f64) -> f32 {
        #[expect(clippy::cast_possible_truncation, reason = "a place on the sheet")]
        let part = self.x.part(value) as f32;
        self.left + part * (self.right - self.left)
    }

    /// A place on the sheet; what is off the plot is drawn on its edge.
    pub(super) fn y(&self, value: f64) -> f32 {
        #[expect(clippy::cast_possible_truncation, reason = "a place on the sheet")]
        let part = self.y.part(value).clamp(-0.04, 1.04) as f32;
        self.bottom - part * (self.bottom - self.top)
    }

    pub(super) fn at(&self, x: f64, y: f64) -> Vec2D {
        Vec2D::new(self.x(x), self.y(y))
    }

    /// Data as places on the sheet.
    pub(super) fn places(&self, data: impl IntoIterator<Item = Place>) -> Vec<Vec2D> {
        data.into_iter().map(|(x, y)| self.at(x, y)).collect()
    }

    /// Down through this plot and the one `below` it.
    pub(super) fn through(&self, below: &Self, x: f64) -> [Vec2D; 2] {
        [Vec2D::new(self.x(x), self.top), Vec2D::new(self.x(x), below.bottom)]
    }

    /// A line from edge to edge at `x`.
    pub(super) fn vertical(&self, x: f64) -> [Vec2D; 2] {
        [Vec2D::new(self.x(x), self.top), Vec2D::new(self.x(x), self.bottom)]
    }

    /// A line from edge to edge at `y`.
    pub(super) fn level(&self, y: f64) -> [Vec2D; 2] {
        [Vec2D::new(self.left, self.y(y)), Vec2D::new(self.right, self.y(y))]
    }

    /// A bar so far above the plot from one value of the horizontal axis to another, as far as it reaches,
    /// with a tick at each end.
    pub(super) fn interval(&self, ends: [f64; 2], above: f32, half_tick: f32) -> Strips {
        let [low, high] = ends.map(|x| x.clamp(self.x.low, self.x.high));
        let bar = [low, high].map(|x| self.above(x, above)).to_vec();
        let tick = |x: f64| {
            [above - half_tick, above + half_tick].map(|above| self.above(x, above)).to_vec()
        };
        vec![tick(low), bar, tick(high)]
    }

    /// The part of a line between two places that is in the plot: none of it lies on the frame.
    pub(super) fn clipped(&self, [from, to]: [Place; 2]) -> Option<[Vec2D; 2]> {
        let parts = |place: Place| (self.x.part(place.0), self.y.part(place.1));
        let ((x0, y0), (x1, y1)) = (parts(from), parts(to));
        let (mut start, mut end) = (0.0_f64, 1.0_f64);
        // Liang and Barsky, "A new concept and method for line clipping", 1984.
        for (way, room) in [(x0 - x1, x0), (x1 - x0, 1.0 - x0), (y0 - y1, y0), (y1 - y0, 1.0 - y0)]
        {
            if way < 0.0 {
                start = start.max(room / way);
            } else if way > 0.0 {
                end = end.min(room / way);
            } else if room < 0.0 {
                return None;
            }
        }
        let at = |t: f64| self.at(from.0 + t * (to.0 - from.0), from.1 + t * (to.1 - from.1));
        (start < end).then(|| [at(start), at(end)])
    }

    pub(super) fn frame(&self) -> Vec<Vec2D> {
        let corner = |x, y| Vec2D::new(x, y);
        vec![
            corner(self.left, self.top),
            corner(self.right, self.top),
            corner(self.right, self.bottom),
            corner(self.left, self.bottom),
            corner(self.left, self.top),
        ]
    }

    /// The middle of the horizontal axis.
    pub(super) fn middle(&self) -> f64 {
        f64::midpoint(self.x.low, self.x.high)
    }

    /// About so many round numbers on the vertical axis, and how they are written.
    pub(super) fn y_ticks(&self, count: f64) -> Vec<(f64, String)> {
        self.y.ticks(count).into_iter().map(|y| (y, number(y))).collect()
    }

    /// A frame over the whole height between two values of the horizontal axis.
    pub(super) fn column(&self, from: f64, to: f64) -> Vec<Vec2D> {
        let ([a, b], [c, d]) = (self.vertical(from), self.vertical(to));
        vec![a, b, d, c, a]
    }

    /// A curve of `values`, thinned to about so many points and simplified, whose value at an index
    /// lies at `x`.
    pub(super) fn curve(
        &self,
        values: &[f64],
        most: usize,
        x: impl Fn(usize) -> f64,
    ) -> Vec<Vec2D> {
        let kept = thinned_to(values, most).into_iter();
        let places = kept.filter_map(|index| Some(self.at(x(index), *values.get(index)?)));
        simplified(places.collect())
    }

    pub(super) fn below(&self, x: f64, distance: f32) -> Vec2D {
        Vec2D::new(self.x(x), self.bottom + distance)
    }

    pub(super) fn above(&self, x: f64, distance: f32) -> Vec2D {
        Vec2D::new(self.x(x), self.top - distance)
    }

    /// Where a text is put to be beside `y`, left of the plot.
    pub(super) fn left_of(&self, y: f64, distance: f32) -> Vec2D {
        Vec2D::new(self.left - distance, self.y(y) - LABEL_DROP)
    }

    /// Where a text is put to be beside `y`, right of the plot.
    pub(super) fn right_of(&self, y: f64, distance: f32) -> Vec2D {
        Vec2D::new(self.right + distance, self.y(y) - LABEL_DROP)
    }
}

/// Texts at places of the sheet.
#[derive(Clone, Debug, Default)]
pub(super) struct Labels {
    pub(super) places: Vec<Vec2D>,
    pub(super) texts: Vec<String>,
    /// Where they have colours of their own, one each.
    pub(super) colors: Vec<Color>,
}

impl Labels {
    pub(super) fn put(&mut self, place: Vec2D, text: impl Into<String>) {
        self.places.push(place);
        self.texts.push(text.into());
    }

    /// One text.
    pub(super) fn one(place: Vec2D, text: impl Into<String>) -> Self {
        let mut labels = Self::default();
        labels.put(place, text);
        labels
    }

    /// A text in a colour of its own.
    pub(super) fn put_in(&mut self, rgb: Rgb, place: Vec2D, text: impl Into<String>) {
        self.put(place, text);
        self.colors.push(color(rgb));
    }

    /// Puts a text there, or as near as it can be without being cut at a side of the sheet.
    pub(super) fn put_whole(&mut self, place: Vec2D, text: impl Into<String>) {
        self.put_within(SHEET.0, place, text);
    }

    /// Puts a text whole on a sheet of this width.
    pub(super) fn put_within(&mut self, width: f32, Vec2D([x, y]): Vec2D, text: impl Into<String>) {
        let text = text.into();
        let half = HALF_LETTER * (text.chars().count() + 2) as f32;
        self.put(Vec2D::new(x.min(width - half).max(half), y), text);
    }
}

/// At most this many points of one curve: a screen has no more columns.
pub(super) const CURVE_POINTS: usize = 2000;

/// About so many samples of the horizontal axis of a plot.
pub(super) fn whole_ticks(plot: &Plot, count: f64) -> Vec<f64> {
    plot.x_span().ticks(count).into_iter().filter(|k| k.fract() == 0.0).collect()
}

/// A diamond about a place.
pub(super) fn diamond(Vec2D([x, y]): Vec2D, radius: f32) -> Vec<Vec2D> {
    let corners = [(0.0, -1.0), (1.0, 0.0), (0.0, 1.0), (-1.0, 0.0), (0.0, -1.0)];
    corners.map(|(dx, dy)| Vec2D::new(x + dx * radius, y + dy * radius)).to_vec()
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_text_at_the_edge_moves_inward() {
        let mut labels = Labels::default();
        labels.put_whole(Vec2D::new(SHEET.0 - 15.0, 4.0), "end = 12000");
        labels.put_whole(Vec2D::new(800.0, 4.0), "end = 12000");
        assert_eq!(labels.places, [Vec2D::new(SHEET.0 - 91.0, 4.0), Vec2D::new(800.0, 4.0)]);
    }

    #[test]
    fn a_line_is_drawn_as_far_as_it_is_in_its_plot() {
        let unit = Span::new(0.0, 1.0);
        let plot = Plot::within((0.0, 100.0), 0.0..=100.0, unit, unit);
        let whole = plot.clipped([(0.2, 0.2), (0.8, 0.4)]).unwrap();
        assert_eq!(whole, [Vec2D::new(20.0, 80.0), Vec2D::new(80.0, 60.0)]);
        let steep = plot.clipped([(0.5, -1.0), (0.5, 3.0)]).unwrap();
        assert_eq!(steep, [Vec2D::new(50.0, 100.0), Vec2D::new(50.0, 0.0)]);
        let leaves = plot.clipped([(0.5, 0.5), (1.5, 1.5)]).unwrap();
        assert_eq!(leaves[1], Vec2D::new(100.0, 0.0));
        assert_eq!(plot.clipped([(0.0, 1.2), (1.0, 1.1)]), None);
        assert_eq!(plot.clipped([(1.2, 0.0), (1.4, 1.0)]), None);
    }

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

    #[test]
    fn thinning_keeps_the_peaks() {
        let mut values = vec![0.0; 100_000];
        values[54_321] = 1.0;
        let kept = thinned_to(&values, CURVE_POINTS);
        assert!(kept.len() <= CURVE_POINTS);
        assert!(kept.contains(&54_321));
        assert!(kept.is_sorted());
    }
}
