//! Drawings: lines, points and texts on a sheet, each part at an entity of its own. What stays is
//! written once; what changes along a timeline has a row per drawing.

use rerun::datatypes::Vec2D;
use rerun::{AsComponents, Color, LineStrips2D, Points2D};
use rerun::{EntityPath, SerializedComponentColumn};

use super::canvas::{Labels, Strips};
use super::chunk::{Chunks, Index};
use super::error::RecordError;
use super::palette::{self, Rgb, color};
use super::paths::at;
use super::sheet::Sheet;

/// Radius of a text's own point: too small to be seen.
pub(super) const HIDDEN: f32 = 0.01;

/// Lines or points of all rows, and how many each row has.
type Data<'d> = (&'d dyn AsComponents, &'d [usize]);

/// The colour of what is drawn at one entity.
#[derive(Clone)]
pub(super) enum Ink {
    One(Rgb),
    /// Another one in each row.
    ByRow(Vec<Rgb>),
    /// Each line, point or text has its own.
    Own,
}

impl From<Rgb> for Ink {
    fn from(rgb: Rgb) -> Self {
        Self::One(rgb)
    }
}

/// The parts of a drawing, which lie below one root.
pub(super) struct Layers<'c> {
    chunks: &'c mut Chunks,
    root: EntityPath,
    /// The moments of the rows; none where there is one that stays.
    index: Option<Index>,
    /// Where the next part is drawn: behind those with a higher number, where it matters.
    order: Option<f32>,
    /// Whether each part is drawn in front of the one before.
    counts: bool,
    /// Whether the index has a moment before all rows, at which the last one is seen.
    opens_on_last: bool,
}

impl<'c> Layers<'c> {
    /// A drawing below `root` that stays.
    pub(super) fn fixed(chunks: &'c mut Chunks, root: impl Into<EntityPath>) -> Self {
        Self {
            chunks,
            root: root.into(),
            index: None,
            order: None,
            counts: false,
            opens_on_last: false,
        }
    }

    /// A drawing with a row at each moment of `index`.
    pub(super) fn rows(chunks: &'c mut Chunks, root: impl Into<EntityPath>, index: Index) -> Self {
        Self { index: Some(index), ..Self::fixed(chunks, root) }
    }

    /// What is pushed first is drawn behind the rest.
    pub(super) fn back_to_front(self) -> Self {
        Self { order: Some(1.0), counts: true, ..self }
    }

    /// These rows behind a copy of the last one, for which the index has a moment of its own.
    pub(super) fn opening_on_last(self) -> Self {
        Self { opens_on_last: true, ..self }
    }

    /// These parts, of which the next one is drawn behind those with a higher number.
    pub(super) fn order(&mut self, order: f32) -> &mut Self {
        self.order = Some(order);
        self
    }

    pub(super) fn strips(
        &mut self,
        path: &str,
        ink: impl Into<Ink>,
        radius: f32,
        rows: impl IntoIterator<Item = Strips>,
    ) -> Result<(), RecordError> {
        let (strips, lengths) = self.flattened(rows);
        let strips = LineStrips2D::update_fields().with_strips(strips);
        self.lines(path, ink.into(), radius, (&strips, &lengths))
    }

    /// Strips with a colour each.
    pub(super) fn colored(
        &mut self,
        path: &str,
        radius: f32,
        rows: impl IntoIterator<Item = Vec<(Vec<Vec2D>, Color)>>,
    ) -> Result<(), RecordError> {
        let (strips, lengths) = self.flattened(rows);
        let (strips, colors): (Vec<_>, Vec<_>) = strips.into_iter().unzip();
        let strips = LineStrips2D::update_fields().with_strips(strips).with_colors(colors);
        self.lines(path, Ink::Own, radius, (&strips, &lengths))
    }

    fn lines(
        &mut self,
        path: &str,
        ink: Ink,
        radius: f32,
        data: Data<'_>,
    ) -> Result<(), RecordError> {
        let mut style = LineStrips2D::update_fields().with_radii([radius]);
        if let Ink::One(rgb) = ink {
            style = style.with_colors([color(rgb)]);
        }
        if let Some(order) = self.next_order() {
            style = style.with_draw_order(order);
        }
        self.put(path, &style, data)?;
        let Ink::ByRow(rgbs) = ink else { return Ok(()) };
        let (colors, lengths) = self.by_row(&rgbs);
        self.push(path, &LineStrips2D::update_fields().with_colors(colors), &lengths)
    }

    pub(super) fn points(
        &mut self,
        path: &str,
        ink: impl Into<Ink>,
        radius: f32,
        rows: impl IntoIterator<Item = Vec<Vec2D>>,
    ) -> Result<(), RecordError> {
        let (points, lengths) = self.flattened(rows);
        let mut style = Points2D::update_fields().with_radii([radius]);
        if let Some(order) = self.next_order() {
            style = style.with_draw_order(order);
        }
        let points = Points2D::update_fields().with_positions(points);
        self.dots(path, ink.into(), style, (&points, &lengths))
    }

    pub(super) fn texts(
        &mut self,
        path: &str,
        ink: impl Into<Ink>,
        rows: impl IntoIterator<Item = Labels>,
    ) -> Result<(), RecordError> {
        self.named_points(path, ink, HIDDEN, rows)
    }

    /// Points with texts beside them.
    pub(super) fn named_points(
        &mut self,
        path: &str,
        ink: impl Into<Ink>,
        radius: f32,
        rows: impl IntoIterator<Item = Labels>,
    ) -> Result<(), RecordError> {
        let mut all = Labels::default();
        let mut lengths = Vec::new();
        for labels in self.opened(rows) {
            lengths.push(labels.places.len());
            all.places.extend(labels.places);
            all.texts.extend(labels.texts);
            all.colors.extend(labels.colors);
        }
        let mut points = Points2D::update_fields().with_positions(all.places);
        points = points.with_labels(all.texts);
        let mut ink = ink.into();
        if !all.colors.is_empty() {
            ink = Ink::Own;
            points = points.with_colors(all.colors);
        }
        let style = Points2D::update_fields().with_radii([radius]).with_show_labels(true);
        self.dots(path, ink, style, (&points, &lengths))
    }

    fn dots(
        &mut self,
        path: &str,
        ink: Ink,
        mut style: Points2D,
        data: Data<'_>,
    ) -> Result<(), RecordError> {
        if let Ink::One(rgb) = ink {
            style = style.with_colors([color(rgb)]);
        }
        self.put(path, &style, data)?;
        let Ink::ByRow(rgbs) = ink else { return Ok(()) };
        let (colors, lengths) = self.by_row(&rgbs);
        self.push(path, &Points2D::update_fields().with_colors(colors), &lengths)
    }

    /// Grids and texts of sheets, one per row.
    pub(super) fn sheets(
        &mut self,
        sheets: impl IntoIterator<Item = Sheet>,
    ) -> Result<(), RecordError> {
        let (grids, texts): (Vec<_>, Vec<_>) = sheets.into_iter().map(Sheet::into_parts).unzip();
        self.strips("grid", palette::GRID, 0.7, grids)?;
        self.texts("texts", palette::BORDER, texts)
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

    /// What all rows share, and the rows.
    fn put(
        &mut self,
        path: &str,
        style: &dyn AsComponents,
        (data, lengths): Data<'_>,
    ) -> Result<(), RecordError> {
        if self.index.is_none() {
            let parts = [data.as_serialized_batches(), style.as_serialized_batches()].concat();
            return self.stays(path, &parts);
        }
        self.stays(path, style)?;
        self.push(path, data, lengths)
    }

    /// All rows, with the one that is opened on.
    fn opened<T: Clone>(&self, rows: impl IntoIterator<Item = T>) -> Vec<T> {
        let mut rows: Vec<T> = rows.into_iter().collect();
        if let Some(last) = rows.last().filter(|_| self.opens_on_last).cloned() {
            rows.insert(0, last);
        }
        rows
    }

    fn by_row(&self, rgbs: &[Rgb]) -> (Vec<Color>, Vec<usize>) {
        let colors = self.opened(rgbs.iter().map(|rgb| color(*rgb)));
        let lengths = vec![1; colors.len()];
        (colors, lengths)
    }

    fn flattened<T: Clone>(&self, rows: impl IntoIterator<Item = Vec<T>>) -> (Vec<T>, Vec<usize>) {
        let rows = self.opened(rows);
        let lengths = rows.iter().map(Vec::len).collect();
        (rows.into_iter().flatten().collect(), lengths)
    }

    fn next_order(&mut self) -> Option<f32> {
        let order = self.order;
        self.order = order.filter(|_| self.counts).map(|order| order + 1.0);
        order
    }
}
