//! Drawings that change along a timeline: a row per drawing, one call per entity.

use rerun::datatypes::Vec2D;
use rerun::{Color, EntityPath, LineStrips2D, Points2D, SerializedComponentColumn};

use super::canvas::Labels;
use super::chunk::{Chunks, Index};
use super::error::RecordError;
use super::palette::{Rgb, color};
use super::paths::at;

/// Radius of a text's own point: too small to be seen.
pub(super) const HIDDEN: f32 = 0.01;

/// Rows of the entities below one root, all at the same moments.
pub(super) struct Rows<'c> {
    chunks: &'c mut Chunks,
    root: EntityPath,
    index: Index,
    /// Where the next lines are drawn: behind those that follow, where it matters.
    order: Option<f32>,
    /// Whether the index has a moment before all rows, at which the last one is seen.
    opens_on_last: bool,
}

impl<'c> Rows<'c> {
    /// Rows at the moments of `index`.
    pub(super) fn new(chunks: &'c mut Chunks, root: EntityPath, index: Index) -> Self {
        Self { chunks, root, index, order: None, opens_on_last: false }
    }

    /// These rows, what is pushed first being drawn behind the rest.
    pub(super) fn back_to_front(self) -> Self {
        Self { order: Some(1.0), ..self }
    }

    /// These rows behind a copy of the last one, for which `index` has a moment of its own.
    pub(super) fn opening_on_last(self) -> Self {
        Self { opens_on_last: true, ..self }
    }

    /// All rows, with the one that is opened on.
    fn opened<T: Clone>(&self, rows: impl Iterator<Item = T>) -> Vec<T> {
        let mut rows: Vec<T> = rows.collect();
        if let Some(last) = rows.last().filter(|_| self.opens_on_last).cloned() {
            rows.insert(0, last);
        }
        rows
    }

    pub(super) fn strips(
        &mut self,
        path: &str,
        rgb: Rgb,
        radius: f32,
        rows: impl Iterator<Item = Vec<Vec<Vec2D>>>,
    ) -> Result<(), RecordError> {
        let (strips, lengths) = flattened(self.opened(rows));
        let style = LineStrips2D::update_fields().with_colors([color(rgb)]).with_radii([radius]);
        self.lines(path, style, LineStrips2D::update_fields().with_strips(strips), lengths)
    }

    /// Strips with a colour each.
    pub(super) fn colored(
        &mut self,
        path: &str,
        radius: f32,
        rows: impl Iterator<Item = Vec<(Vec<Vec2D>, Color)>>,
    ) -> Result<(), RecordError> {
        let (strips, lengths) = flattened(self.opened(rows));
        let (strips, colors): (Vec<_>, Vec<_>) = strips.into_iter().unzip();
        let lines = LineStrips2D::update_fields().with_strips(strips).with_colors(colors);
        let style = LineStrips2D::update_fields().with_radii([radius]);
        self.lines(path, style, lines, lengths)
    }

    /// Strips whose colour is another one in each row.
    pub(super) fn strips_by_row(
        &mut self,
        path: &str,
        rgbs: &[Rgb],
        radius: f32,
        rows: impl Iterator<Item = Vec<Vec<Vec2D>>>,
    ) -> Result<(), RecordError> {
        let (strips, lengths) = flattened(self.opened(rows));
        let style = LineStrips2D::update_fields().with_radii([radius]);
        self.lines(path, style, LineStrips2D::update_fields().with_strips(strips), lengths)?;
        let colors = LineStrips2D::update_fields().with_colors(self.colors(rgbs));
        self.color(path, colors.columns_of_unit_batches()?)
    }

    /// Points whose colour is another one in each row.
    pub(super) fn points_by_row(
        &mut self,
        path: &str,
        rgbs: &[Rgb],
        radius: f32,
        rows: impl Iterator<Item = Vec<Vec2D>>,
    ) -> Result<(), RecordError> {
        self.points(path, None, radius, rows)?;
        let colors = Points2D::update_fields().with_colors(self.colors(rgbs));
        self.color(path, colors.columns_of_unit_batches()?)
    }

    /// Texts whose colour is another one in each row.
    pub(super) fn texts_by_row(
        &mut self,
        path: &str,
        rgbs: &[Rgb],
        rows: impl Iterator<Item = Labels>,
    ) -> Result<(), RecordError> {
        self.texts(path, None, rows)?;
        let colors = Points2D::update_fields().with_colors(self.colors(rgbs));
        self.color(path, colors.columns_of_unit_batches()?)
    }

    fn colors(&self, rgbs: &[Rgb]) -> Vec<Color> {
        self.opened(rgbs.iter().map(|rgb| color(*rgb)))
    }

    fn color(
        &mut self,
        path: &str,
        colors: impl Iterator<Item = SerializedComponentColumn>,
    ) -> Result<(), RecordError> {
        self.chunks.push(at(&self.root, path), self.index.clone(), colors)
    }

    fn lines(
        &mut self,
        path: &str,
        mut style: LineStrips2D,
        lines: LineStrips2D,
        lengths: Vec<usize>,
    ) -> Result<(), RecordError> {
        let entity = at(&self.root, path);
        if let Some(order) = self.next_order() {
            style = style.with_draw_order(order);
        }
        self.chunks.push_static(entity.clone(), &style)?;
        self.chunks.push(entity, self.index.clone(), lines.columns(lengths)?)
    }

    pub(super) fn points(
        &mut self,
        path: &str,
        rgb: impl Into<Option<Rgb>>,
        radius: f32,
        rows: impl Iterator<Item = Vec<Vec2D>>,
    ) -> Result<(), RecordError> {
        let entity = at(&self.root, path);
        let (points, lengths) = flattened(self.opened(rows));
        let mut style = Points2D::update_fields().with_radii([radius]);
        if let Some(rgb) = rgb.into() {
            style = style.with_colors([color(rgb)]);
        }
        if let Some(order) = self.next_order() {
            style = style.with_draw_order(order);
        }
        self.chunks.push_static(entity.clone(), &style)?;
        let columns = Points2D::update_fields().with_positions(points).columns(lengths)?;
        self.chunks.push(entity, self.index.clone(), columns)
    }

    pub(super) fn texts(
        &mut self,
        path: &str,
        rgb: impl Into<Option<Rgb>>,
        rows: impl Iterator<Item = Labels>,
    ) -> Result<(), RecordError> {
        let entity = at(&self.root, path);
        let mut style = Points2D::update_fields().with_radii([HIDDEN]);
        if let Some(rgb) = rgb.into() {
            style = style.with_colors([color(rgb)]);
        }
        self.chunks.push_static(entity.clone(), &style.with_show_labels(true))?;
        let (mut places, mut texts, mut lengths) = (Vec::new(), Vec::new(), Vec::new());
        for labels in self.opened(rows) {
            lengths.push(labels.places.len());
            places.extend(labels.places);
            texts.extend(labels.texts);
        }
        let points = Points2D::update_fields().with_positions(places).with_labels(texts);
        self.chunks.push(entity, self.index.clone(), points.columns(lengths)?)
    }

    fn next_order(&mut self) -> Option<f32> {
        let order = self.order?;
        self.order = Some(order + 1.0);
        Some(order)
    }
}

fn flattened<T>(rows: Vec<Vec<T>>) -> (Vec<T>, Vec<usize>) {
    let (mut all, mut lengths) = (Vec::new(), Vec::new());
    for row in rows {
        lengths.push(row.len());
        all.extend(row);
    }
    (all, lengths)
}
