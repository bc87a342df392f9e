//! Grid, ticks and words of a drawing that has several plots.

use rerun::datatypes::Vec2D;
use rerun::{Color, EntityPath, LineStrips2D, Points2D};

use super::canvas::{Labels, Plot, SHEET, Span};
use super::chunk::Chunks;
use super::error::RecordError;
use super::palette::{self, Rgb, color};
use super::paths::{self, at};
use super::rows::HIDDEN;
use crate::wording::number;

/// How far above a plot its title is put: it covers no data in a window of 1280 points.
const TITLE: f32 = 44.0;

/// What all plots of a drawing have behind and around their data.
#[derive(Debug)]
pub(super) struct Sheet {
    width: f32,
    grid: Vec<Vec<Vec2D>>,
    labels: Labels,
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
        self.frame(plot, &x_ticks, &numbered(plot.y_span().ticks(3.0)), title);
        for x in x_ticks {
            self.labels.put_within(self.width, plot.below(x, 2.0), number(x));
        }
    }

    /// Frame and grid of `plot`, with the ticks that are given, and its title.
    pub(super) fn frame(
        &mut self,
        plot: &Plot,
        x_ticks: &[f64],
        y_ticks: &[(f64, String)],
        title: &str,
    ) {
        self.outline(plot, x_ticks, y_ticks);
        self.put(plot.above(middle(plot.x_span()), TITLE), title);
    }

    /// Frame and grid of `plot`, with the ticks that are given.
    pub(super) fn outline(&mut self, plot: &Plot, x_ticks: &[f64], y_ticks: &[(f64, String)]) {
        self.grid.extend(plot.grid(x_ticks, y_ticks, &mut self.labels));
    }

    /// A text at a place.
    pub(super) fn put(&mut self, place: Vec2D, text: impl Into<String>) {
        self.labels.put(place, text);
    }

    /// Lines and texts, for a drawing that changes.
    pub(super) fn into_parts(self) -> (Vec<Vec<Vec2D>>, Labels) {
        (self.grid, self.labels)
    }

    /// Adds `grid` and `texts` below `root`.
    pub(super) fn push(self, chunks: &mut Chunks, root: &EntityPath) -> Result<(), RecordError> {
        strips(chunks, at(root, paths::GRID), palette::GRID, 0.7, self.grid)?;
        put_texts(chunks, at(root, paths::TEXTS), self.labels, &[color(palette::BORDER)])
    }
}

fn middle(span: Span) -> f64 {
    f64::midpoint(span.low, span.high)
}

fn numbered(ticks: Vec<f64>) -> Vec<(f64, String)> {
    ticks.into_iter().map(|tick| (tick, number(tick))).collect()
}

/// Lines of one colour and width.
pub(super) fn strips(
    chunks: &mut Chunks,
    entity: EntityPath,
    rgb: Rgb,
    radius: f32,
    strips: Vec<Vec<Vec2D>>,
) -> Result<(), RecordError> {
    let strips = LineStrips2D::new(strips).with_colors([color(rgb)]).with_radii([radius]);
    chunks.push_static(entity, &strips)
}

/// Texts of one colour, or of one each.
pub(super) fn put_texts(
    chunks: &mut Chunks,
    entity: EntityPath,
    labels: Labels,
    colors: &[Color],
) -> Result<(), RecordError> {
    let texts = Points2D::new(labels.places).with_labels(labels.texts).with_radii([HIDDEN]);
    let texts = texts.with_colors(colors.iter().copied()).with_show_labels(true);
    chunks.push_static(entity, &texts)
}
