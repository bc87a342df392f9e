//! Columns of rows, with ids that are the same in every run.
//!
//! Rerun's own calls draw ids from the clock, so that two runs never compare equal. Here
//! an id is a namespace (one per joint), a tag of the recording, and a counter: viewers keep
//! state by id, so no two recordings share any.

use std::ops::RangeInclusive;
use std::sync::Arc;

use rerun::external::arrow::array::{
    Array as _, ArrayRef, Float32Array, Float64Array, Int64Array, ListArray, StringArray,
};
use rerun::external::arrow::buffer::{NullBuffer, OffsetBuffer, ScalarBuffer};
use rerun::external::arrow::datatypes::Field;
use rerun::external::re_log_types::external::re_tuid::Tuid;
use rerun::log::{Chunk, ChunkId, RowId, TimeColumn};
use rerun::{
    AsComponents, ComponentDescriptor, EntityPath, SerializedComponentBatch,
    SerializedComponentColumn,
};

use super::error::RecordError;
use crate::delay::FineDelay;
use crate::wording::number;

/// Where rows lie on the timelines; one value per row and timeline.
#[derive(Clone, Debug, Default)]
pub(super) struct Index {
    pub(super) decision: Vec<i64>,
    pub(super) segment: Vec<i64>,
    pub(super) sample: Vec<i64>,
    pub(super) time_ns: Vec<i64>,
    /// Revisions of a model; empty where rows are of none.
    revision: Vec<i64>,
    /// Settings of a sweep; likewise.
    pub(super) setting: Vec<i64>,
    /// Ranks of decisions by doubt; likewise.
    doubt: Vec<i64>,
    /// Ranks of decisions by their difference to other results; likewise.
    difference: Vec<i64>,
}

/// What a recording opens on.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Opening {
    /// Its first tick on the timeline of decisions: up to 0 lie the candidates of the decision that is
    /// shown first, so that the right arrow goes through them.
    pub(super) tick: i64,
    /// The first revision of any model, or of several the tick before it.
    pub(super) revision: Option<i64>,
    /// Whether there are other results to compare with.
    pub(super) is_compared: bool,
}

/// Where one row lies on the timelines.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Moment {
    pub(super) decision: i64,
    pub(super) segment: i64,
    pub(super) sample: i64,
    pub(super) time_ns: i64,
}

impl Extend<Moment> for Index {
    fn extend<T: IntoIterator<Item = Moment>>(&mut self, moments: T) {
        for moment in moments {
            self.decision.push(moment.decision);
            self.segment.push(moment.segment);
            self.sample.push(moment.sample);
            self.time_ns.push(moment.time_ns);
        }
    }
}

impl FromIterator<Moment> for Index {
    fn from_iter<T: IntoIterator<Item = Moment>>(moments: T) -> Self {
        let mut index = Self::default();
        index.extend(moments);
        index
    }
}

impl Index {
    pub(super) fn len(&self) -> usize {
        let Self { decision, segment, sample, revision, setting, doubt, .. } = self;
        let lengths = [decision, segment, sample, revision, setting, doubt].map(Vec::len);
        lengths.into_iter().max().unwrap_or(0)
    }

    /// These rows on the timeline of doubt, too.
    pub(super) fn with_doubt(self, ranks: impl Iterator<Item = i64>) -> Self {
        Self { doubt: ranks.collect(), ..self }
    }

    /// These rows on the timeline of differences, too; without any, there is none.
    pub(super) fn with_difference(self, ranks: impl Iterator<Item = i64>) -> Self {
        Self { difference: ranks.collect(), ..self }
    }

    /// These rows off the timeline of segments.
    ///
    /// On it the samples of a segment would all lie at one place, and a plot of them would be a
    /// comb.
    pub(super) fn without_segment(self) -> Self {
        Self { segment: Vec::new(), ..self }
    }

    /// These rows on the timeline of revisions, too, all at one of them.
    pub(super) fn at_revision(self, revision: Option<i64>) -> Self {
        let revision = revision.map_or_else(Vec::new, |number| vec![number; self.len()]);
        Self { revision, ..self }
    }

    /// One row before all others, on the timelines of decisions and, where it is opened on, of
    /// revisions or of differences alone.
    pub(super) fn before_all(opening: Opening) -> Self {
        Self { decision: vec![opening.tick], ..Self::default() }.opened(opening)
    }

    /// One row at a tick of the timeline of decisions, and on no other.
    fn at_tick(tick: i64) -> Self {
        Self { decision: vec![tick], ..Self::default() }
    }

    /// This row at the first sample of the record, too.
    pub(super) fn and_at(self, Moment { sample, time_ns, .. }: Moment) -> Self {
        Self { sample: vec![sample; self.len()], time_ns: vec![time_ns; self.len()], ..self }
    }

    /// One row on every timeline, at its first tick or before it; `start` is the first sample.
    pub(super) fn everywhere(start: Moment, opening: Opening) -> Self {
        let start = Moment { decision: opening.tick, ..start };
        Self { doubt: vec![1], ..std::iter::once(start).collect() }.opened(opening)
    }

    /// One row on each timeline on which no sample lies.
    pub(super) fn off_the_record(opening: Opening) -> Self {
        Self { segment: vec![1], doubt: vec![1], ..Self::default() }.opened(opening)
    }

    fn opened(self, Opening { revision, is_compared, .. }: Opening) -> Self {
        let difference = if is_compared { vec![1; self.len()] } else { Vec::new() };
        Self { difference, ..self.at_revision(revision) }
    }

    /// A row per setting of a sweep, on the timeline of settings alone.
    pub(super) fn of_settings(count: usize) -> Self {
        Self { setting: (1..).take(count).collect(), ..Self::default() }
    }

    /// A row per rank by doubt, on the timeline of doubt alone.
    pub(super) fn of_doubts(count: usize) -> Self {
        Self { doubt: (1..).take(count).collect(), ..Self::default() }
    }

    /// A row per revision, all of them at `moment` and, where decisions are ranked, at this rank by
    /// doubt: on the other timelines the last one is seen.
    pub(super) fn of_revisions(revision: Vec<i64>, moment: Moment, rank: Option<i64>) -> Self {
        let moments = std::iter::repeat_n(moment, revision.len());
        let doubt = rank.map_or_else(Vec::new, |rank| vec![rank; revision.len()]);
        Self { revision, doubt, ..moments.collect() }
    }

    fn columns(self) -> Vec<TimeColumn> {
        let sequences = [
            ("decision", self.decision),
            ("segment", self.segment),
            ("sample", self.sample),
            ("revision", self.revision),
            ("setting", self.setting),
            ("doubt", self.doubt),
            ("difference", self.difference),
        ];
        let filled = sequences.into_iter().filter(|(_, values)| !values.is_empty());
        let mut columns: Vec<_> =
            filled.map(|(name, values)| TimeColumn::new_sequence(name, values)).collect();
        if !self.time_ns.is_empty() {
            columns.push(TimeColumn::new_duration_nanos("time", self.time_ns));
        }
        columns
    }
}

/// Ids of one recording: those of another one have another tag.
#[derive(Clone, Copy, Debug)]
pub(super) struct Ids {
    tag: u64,
}

impl Ids {
    /// Those of the recording, or the blueprint, with this id.
    pub(super) fn of(id: &str) -> Self {
        use sha2::{Digest as _, Sha256};
        let mut tag = [0; 8];
        // 31 bits stay: above them is the mark of chunks, below 32 bits that count.
        tag.iter_mut().skip(4).zip(Sha256::digest(id)).for_each(|(to, byte)| *to = byte);
        Self { tag: u64::from_be_bytes(tag) & 0x7fff_ffff }
    }

    /// Collects chunks of `namespace`: those of one recording must differ; 0 is not allowed.
    pub(super) fn chunks(self, namespace: u64) -> Chunks {
        Chunks { namespace, tag: self.tag << 32, rows: 0, made: Vec::new() }
    }
}

/// Collects chunks of one namespace.
pub(super) struct Chunks {
    namespace: u64,
    tag: u64,
    rows: u64,
    made: Vec<Chunk>,
}

impl Chunks {
    /// Rows of `columns` at the moments of `index`; nothing when there is none.
    pub(super) fn push(
        &mut self,
        entity: EntityPath,
        index: Index,
        columns: impl IntoIterator<Item = SerializedComponentColumn>,
    ) -> Result<(), RecordError> {
        let rows = index.len();
        self.push_rows(entity, rows, index.columns(), columns)
    }

    /// Rows of `columns` on the timeline of revisions alone.
    pub(super) fn push_revisions(
        &mut self,
        entity: EntityPath,
        revisions: Vec<i64>,
        columns: impl IntoIterator<Item = SerializedComponentColumn>,
    ) -> Result<(), RecordError> {
        let rows = revisions.len();
        self.push_rows(entity, rows, [TimeColumn::new_sequence("revision", revisions)], columns)
    }

    /// Data that is there at all times.
    pub(super) fn push_static(
        &mut self,
        entity: EntityPath,
        data: &dyn AsComponents,
    ) -> Result<(), RecordError> {
        let columns = data.as_serialized_batches().into_iter().map(Into::into);
        self.push_rows(entity, 1, [], columns)
    }

    /// One row on the timeline of blueprints, by which the viewer knows them.
    pub(super) fn push_blueprint(
        &mut self,
        entity: EntityPath,
        data: &dyn AsComponents,
    ) -> Result<(), RecordError> {
        let columns = data.as_serialized_batches().into_iter().map(Into::into);
        self.push_rows(entity, 1, [TimeColumn::new_sequence("blueprint", [0])], columns)
    }

    /// Adds a row at `index` of what the entities below `root` have at the tick `decision`: only
    /// of components whose name begins so.
    pub(super) fn repeat(
        &mut self,
        (root, component): (&EntityPath, &str),
        decision: i64,
        index: &Index,
    ) -> Result<(), RecordError> {
        let rows: Vec<_> = self
            .below(root)
            .filter_map(|(chunk, ticks)| {
                let row = ticks.iter().rposition(|tick| *tick <= decision)?;
                Some((chunk.entity_path().clone(), cells(chunk, row, component)))
            })
            .collect();
        for (entity, columns) in rows.into_iter().filter(|(_, columns)| !columns.is_empty()) {
            self.push(entity, index.clone(), columns)?;
        }
        Ok(())
    }

    /// Adds once more, from the tick `from` on, the rows that the entities below `root` have at `ticks`
    /// of decisions, on that timeline alone.
    pub(super) fn replay(
        &mut self,
        root: &EntityPath,
        ticks: RangeInclusive<i64>,
        from: i64,
    ) -> Result<(), RecordError> {
        let mut rows = Vec::new();
        for (chunk, at) in self.below(root) {
            for (row, tick) in at.iter().enumerate().filter(|(_, tick)| ticks.contains(*tick)) {
                let index = Index::at_tick(tick - ticks.start() + from);
                rows.push((chunk.entity_path().clone(), index, cells(chunk, row, "")));
            }
        }
        rows.into_iter().try_for_each(|(entity, index, columns)| self.push(entity, index, columns))
    }

    /// The chunks of the entities below `root` that have ticks of decisions, with these.
    fn below(&self, root: &EntityPath) -> impl Iterator<Item = (&Chunk, &[i64])> {
        let shown = self.made.iter().filter(|chunk| chunk.entity_path().starts_with(root));
        shown.filter_map(|chunk| {
            Some((chunk, chunk.timelines().get(&"decision".into())?.times_raw()))
        })
    }

    fn push_rows(
        &mut self,
        entity: EntityPath,
        rows: usize,
        timelines: impl IntoIterator<Item = TimeColumn>,
        columns: impl IntoIterator<Item = SerializedComponentColumn>,
    ) -> Result<(), RecordError> {
        if rows == 0 {
            return Ok(());
        }
        let id = ChunkId::from_tuid(self.tuid(0x8000_0000_0000_0000 | self.made.len() as u64));
        let first = self.rows;
        self.rows += rows as u64;
        let row_ids: Vec<_> =
            (first..self.rows).map(|row| RowId::from_tuid(self.tuid(row + 1))).collect();
        let timelines = timelines.into_iter().map(|column| (*column.timeline().name(), column));
        let components = columns.into_iter().map(|c| (c.descriptor, c.list_array)).collect();
        let timelines = timelines.collect();
        let chunk = Chunk::from_native_row_ids(id, entity, None, &row_ids, timelines, components)?;
        self.made.push(chunk);
        Ok(())
    }

    fn tuid(&self, counter: u64) -> Tuid {
        Tuid::from_nanos_and_inc(self.namespace, self.tag | counter)
    }

    pub(super) fn into_chunks(self) -> Vec<Chunk> {
        self.made
    }
}

/// What `chunk` has in a row, of the components whose name begins so.
fn cells(chunk: &Chunk, row: usize, component: &str) -> Vec<SerializedComponentColumn> {
    let columns = chunk.components().0.values();
    let named = columns.filter(|c| c.descriptor.component.as_str().starts_with(component));
    let cell = named.map(|column| {
        let (list, name) = (column.list_array.slice(row, 1), column.descriptor.clone());
        SerializedComponentColumn::new(list, name)
    });
    cell.collect()
}

/// A column of numbers named `name`; `None` is null.
pub(super) fn numbers(name: &'static str, values: &[Option<f64>]) -> SerializedComponentColumn {
    let items: Float64Array = values.iter().flatten().copied().collect::<Vec<_>>().into();
    list_column(name, Arc::new(items), values.iter().map(Option::is_some))
}

/// A column of numbers to be looked at, named `name`: to five digits; `None` is null.
pub(super) fn shown(name: &'static str, values: &[Option<f64>]) -> SerializedComponentColumn {
    let rounded = |value: &f64| number(*value).parse().unwrap_or(f32::NAN);
    let items: Float32Array = values.iter().flatten().map(rounded).collect::<Vec<f32>>().into();
    list_column(name, Arc::new(items), values.iter().map(Option::is_some))
}

/// Names of the columns of [`fine_columns`].
const FINE: [&str; 3] = ["fine_delta", "delta_low", "delta_high"];

/// Delays between samples with their intervals; no columns where there is none.
pub(super) fn fine_columns(delays: &[Option<FineDelay>]) -> Vec<SerializedComponentColumn> {
    if delays.iter().all(Option::is_none) {
        return Vec::new();
    }
    let parts: [fn(FineDelay) -> f64; 3] = [|fine| fine.delay, |fine| fine.low, |fine| fine.high];
    let column = |(name, part): (&'static str, fn(FineDelay) -> f64)| {
        numbers(name, &delays.iter().map(|fine| fine.map(part)).collect::<Vec<_>>())
    };
    FINE.into_iter().zip(parts).map(column).collect()
}

/// A column of whole numbers named `name`; `None` is null.
pub(super) fn integers(name: &'static str, values: &[Option<i64>]) -> SerializedComponentColumn {
    let items: Int64Array = values.iter().flatten().copied().collect::<Vec<_>>().into();
    list_column(name, Arc::new(items), values.iter().map(Option::is_some))
}

/// A column of texts named `name`; `None` is null.
pub(super) fn texts(name: &'static str, values: &[Option<String>]) -> SerializedComponentColumn {
    let items: StringArray = values.iter().flatten().map(|text| Some(text.as_str())).collect();
    list_column(name, Arc::new(items), values.iter().map(Option::is_some))
}

/// A column of lists of numbers named `name`; `None` is null.
pub(super) fn optional_lists(
    name: &'static str,
    rows: &[Vec<Option<f64>>],
) -> SerializedComponentColumn {
    lists_of(name, rows.iter().flatten().copied().collect(), rows.iter().map(Vec::len))
}

/// A column of lists of numbers named `name`.
pub(super) fn lists(name: &'static str, rows: &[Vec<f64>]) -> SerializedComponentColumn {
    lists_of(name, rows.concat().into(), rows.iter().map(Vec::len))
}

fn lists_of(
    name: &'static str,
    items: Float64Array,
    lengths: impl Iterator<Item = usize>,
) -> SerializedComponentColumn {
    let field = Field::new_list_field(items.data_type().clone(), true);
    let offsets = OffsetBuffer::from_lengths(lengths);
    let list = ListArray::new(Arc::new(field), offsets, Arc::new(items), None);
    SerializedComponentColumn::new(list, ComponentDescriptor::partial(name))
}

/// Numbers named `name` for one row.
pub(super) fn list(
    name: &'static str,
    values: impl Iterator<Item = f64>,
) -> SerializedComponentBatch {
    let values: Float64Array = values.collect::<Vec<_>>().into();
    SerializedComponentBatch::new(Arc::new(values), ComponentDescriptor::partial(name))
}

/// Texts named `name` for one row.
pub(super) fn words<'a>(
    name: &'static str,
    texts: impl Iterator<Item = &'a str>,
) -> SerializedComponentBatch {
    let texts: StringArray = texts.map(Some).collect();
    SerializedComponentBatch::new(Arc::new(texts), ComponentDescriptor::partial(name))
}

fn list_column(
    name: &'static str,
    items: ArrayRef,
    filled: impl Iterator<Item = bool> + Clone,
) -> SerializedComponentColumn {
    let ends = filled.clone().scan(0, |end, filled| {
        *end += i32::from(filled);
        Some(*end)
    });
    let offsets: Vec<i32> = std::iter::once(0).chain(ends).collect();
    let field = Field::new_list_field(items.data_type().clone(), true);
    let offsets = OffsetBuffer::new(ScalarBuffer::from(offsets));
    let nulls: NullBuffer = filled.collect();
    let list = ListArray::new(Arc::new(field), offsets, items, Some(nulls));
    SerializedComponentColumn::new(list, ComponentDescriptor::partial(name))
}
