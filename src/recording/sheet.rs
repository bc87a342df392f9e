//! Grid, ticks and words of a drawing that has several plots.

use rerun::datatypes::Vec2D;

use super::canvas::{Labels, Plot, SHEET, Strips};
use crate::wording::number;

/// How far above a plot its title is put: it covers no data in a window of 1280 points.
pub(super) const TITLE: f32 = 44.0;

/// What all plots of a drawing have behind and around their data.
#[derive(Debug)]
pub(super) struct Sheet {
    width: f32,
    pub(super) grid: Strips,
    pub(super) labels: Labels,
}

impl Default for Sheet {
    fn default() -> Self {
        Self::of_width(SHEET.0)
    }
}

impl Sheet {
    /// An empty sheet.
    pub(super) fn of_width(width: f32) -> Self {
        Self { width, grid: Vec::new(), labels: Labels::default() }
    }

    /// Frame, grid and ticks of `plot`, with about `x_ticks` of them below, and its title.
    pub(super) fn draw(&mut self, plot: &Plot, x_ticks: f64, title: &str) {
        let x_ticks = plot.x_span().ticks(x_ticks);
        self.outline(plot, &x_ticks, &plot.y_ticks(3.0));
        self.title(plot, TITLE, title);
        self.below(plot, 2.0, &x_ticks);
    }

    /// Frame and grid of `plot`, with the ticks that are given, and the names of those at the left.
    pub(super) fn outline(&mut self, plot: &Plot, x_ticks: &[f64], y_ticks: &[(f64, String)]) {
        self.grid.push(plot.frame());
        self.grid.extend(x_ticks.iter().map(|x| plot.vertical(*x).to_vec()));
        for (y, text) in y_ticks {
            self.grid.push(plot.level(*y).to_vec());
            self.put(plot.left_of(*y, 55.0), text.clone());
        }
    }

    /// A text so far above the middle of a plot.
    pub(super) fn title(&mut self, plot: &Plot, distance: f32, text: impl Into<String>) {
        self.put(plot.above(plot.middle(), distance), text);
    }

    /// Numbers below a plot, none of them cut at a side of the sheet.
    pub(super) fn below(&mut self, plot: &Plot, distance: f32, ticks: &[f64]) {
        for x in ticks {
            self.labels.put_within(self.width, plot.below(*x, distance), number(*x));
        }
    }

    /// A text at a place.
    pub(super) fn put(&mut self, place: Vec2D, text: impl Into<String>) {
        self.labels.put(place, text);
    }

    pub(super) fn into_parts(self) -> (Strips, Labels) {
        (self.grid, self.labels)
    }
}
