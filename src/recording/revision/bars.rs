//! Bars that lie, one below another, each with its name and its value.

use rerun::Color;
use rerun::datatypes::Vec2D;

use crate::recording::canvas::{Labels, Plot, Span};
use crate::recording::error_share::{HATCH, hatched};

/// Rows of bars with names on the left.
#[derive(Clone, Copy, Debug)]
pub(super) struct Bars {
    plot: Plot,
    rows: usize,
    /// Middle of the column with the names.
    names: f32,
    middle_of_all: f32,
}

/// Where on the sheet the names and the bars lie, from left to right.
#[derive(Clone, Copy, Debug)]
pub(super) struct Columns {
    pub(super) left: f32,
    /// Least and farthest end of the names.
    pub(super) names: (f32, f32),
    pub(super) right: f32,
}

/// Part of a row that its bar fills.
const FILLED: f64 = 0.62;

/// Highest row, on the sheet.
const HIGHEST: f32 = 90.0;

/// Top and bottom of the bars on the sheet.
const ROWS: (f32, f32) = (44.0, 450.0);

/// Half of the height of a line of text, on the sheet.
const HALF_LINE: f32 = 14.0;

impl Bars {
    /// `rows` bars up to the length `most`, between two columns of the sheet. The names end
    /// where the one of `longest` letters does, but between `short` and `long`.
    pub(super) fn new(columns: Columns, (rows, longest): (usize, usize), most: f64) -> Self {
        /// Room for a value behind the longest bar.
        const ROOM: f64 = 1.8;
        /// Width of a letter on the sheet in a window of 1280 points.
        const LETTER: f32 = 15.0;
        let Columns { left, names: (short, long), right } = columns;
        let names = (left + LETTER * (longest + 2) as f32).clamp(short, long);
        let bottom = (ROWS.0 + HIGHEST * rows.max(1) as f32).min(ROWS.1);
        let (x, y) = (Span::new(0.0, ROOM * most), Span::new(0.0, rows.max(1) as f64));
        let plot = Plot::within((names, right), ROWS.0..=bottom, x, y);
        let middle_of_all = f32::midpoint(left, right);
        Self { plot, rows, names: f32::midpoint(left, names), middle_of_all }
    }

    /// How many there are.
    pub(super) fn rows(&self) -> usize {
        self.rows
    }

    fn middle(&self, row: usize) -> f64 {
        self.rows as f64 - row as f64 - 0.5
    }

    /// The lines that fill the bar of a row.
    pub(super) fn bar(&self, row: usize, length: f64, color: Color) -> Vec<(Vec<Vec2D>, Color)> {
        let middle = self.middle(row);
        let [top, bottom] = [0.5, -0.5].map(|half| self.plot.y(middle + half * FILLED));
        let (left, right) = (self.plot.x(0.0) + HATCH, self.plot.x(length) - HATCH);
        let line = |y| (vec![Vec2D::new(left, y), Vec2D::new(right.max(left), y)], color);
        hatched(top, bottom).map(line).collect()
    }

    /// A mark across the bar of a row.
    pub(super) fn mark(&self, row: usize, value: f64) -> Vec<Vec2D> {
        let middle = self.middle(row);
        [0.5, -0.5].map(|half| self.plot.at(value, middle + half)).to_vec()
    }

    /// A line across all bars.
    pub(super) fn line(&self, value: f64) -> Vec<Vec2D> {
        self.plot.vertical(value).to_vec()
    }

    pub(super) fn name(&self, labels: &mut Labels, row: usize, name: &str) {
        // Two lines where it is two changes; what came stands for both where rows are narrow.
        let height = self.plot.y(self.middle(row + 1)) - self.plot.y(self.middle(row));
        let (name, drop) = match name.split_once(", ") {
            Some((came, gone)) if height >= 4.0 * HALF_LINE => {
                (format!("{came}\n{gone}"), 2.0 * HALF_LINE)
            }
            Some((came, _)) => (format!("{came}, …"), HALF_LINE),
            None => (name.to_owned(), HALF_LINE),
        };
        labels.put(Vec2D::new(self.names, self.plot.y(self.middle(row)) - drop), name);
    }

    /// The value of a row, behind its bar.
    pub(super) fn value(&self, labels: &mut Labels, row: usize, end: f64, text: String) {
        let half = 7.0 * (text.chars().count() + 2) as f32;
        let (x, y) = (self.plot.x(end) + half, self.plot.y(self.middle(row)));
        labels.put(Vec2D::new(x, y - HALF_LINE), text);
    }

    /// A text above all, in the middle.
    pub(super) fn title(&self, labels: &mut Labels, text: &str) {
        labels.put(Vec2D::new(self.middle_of_all, 4.0), text);
    }

    /// A text below the line at `value`.
    pub(super) fn below(&self, labels: &mut Labels, value: f64, text: String) {
        let half = 7.0 * (text.chars().count() + 2) as f32;
        let Vec2D([x, y]) = self.plot.below(value, 4.0);
        labels.put(Vec2D::new(x.max(self.names + half), y), text);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::recording::palette::{self, color};

    #[test]
    fn the_first_bar_is_the_highest_and_lengths_are_in_proportion() {
        let columns = Columns { left: 0.0, names: (300.0, 300.0), right: 650.0 };
        let bars = Bars::new(columns, (2, 10), 1.0);
        let length = |row, value| {
            let lines = bars.bar(row, value, color(palette::model(0)));
            let ends = lines.first().map(|(line, _)| (line[0].x(), line[1].x(), line[0].y()));
            ends.unwrap()
        };
        let (whole, half) = (length(0, 1.0), length(1, 0.5));
        assert!(whole.2 < half.2, "above");
        let full = |(left, right, _): (f32, f32, f32)| right - left + 2.0 * HATCH;
        assert!((full(whole) / full(half) - 2.0).abs() < 1e-3);
    }
}
