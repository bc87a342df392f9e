//! A sheet to draw a plot on in a 2D view: Rerun has no x-y plot that follows a cursor.
//!
//! The view's y axis points down, both axes have the same scale, and there are no
//! ticks, so data are mapped onto a sheet of fixed size with a grid of its own.

use std::ops::RangeInclusive;

use rerun::datatypes::Vec2D;

use super::palette::Rgb;
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
