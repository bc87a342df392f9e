//! Drawings: lines, points and texts on a sheet, each part at an entity of its own. What stays is
//! written once; what changes along a timeline has a row per drawing.

use rerun::{AsComponents, Color, EntityPath, LineStrips2D, Points2D, SerializedComponentColumn};

use super::canvas::{Dot, Strip, Text};
use super::chunk::{Chunks, Index};
use super::error::RecordError;
use super::palette::{Rgb, color};
use super::paths::at;

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
