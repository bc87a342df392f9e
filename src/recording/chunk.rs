//! Columns of rows, with ids that are the same in every run.
//!
//! Rerun's own calls draw ids from the clock, so that two runs never compare equal. Here
//! an id is a namespace (one per joint), a tag of the recording, and a counter: viewers keep
//! state by id, so no two recordings share any.

use std::collections::BTreeMap;
use std::ops::RangeInclusive;
use std::sync::Arc;

use rerun::external::arrow::array::{
    Array, Float32Array, Float64Array, Int64Array, ListArray, StringArray,
};
use rerun::external::arrow::buffer::{NullBuffer, OffsetBuffer};
use rerun::external::arrow::datatypes::Field;
use rerun::external::re_log_types::external::re_tuid::Tuid;
use rerun::external::re_log_types::{SetStoreInfo, StoreInfo, StoreSource};
use rerun::log::{Chunk, ChunkId, LogMsg, RowId, TimeColumn};
use rerun::{
    AsComponents, ComponentDescriptor, EntityPath, Scalars, SerializedComponentBatch,
    SerializedComponentColumn, SeriesLines, StateChange, StoreId, TextDocument, TextLog,
};
use serde_json::Value;

use super::error::RecordError;
use super::palette::{Rgb, color};
use crate::report::Kind;
use crate::wording::number;

/// Where rows lie: on each timeline that is named here, one value per row.
#[derive(Clone, Debug, Default)]
pub(super) struct Index(BTreeMap<&'static str, Vec<i64>>);

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

impl FromIterator<Moment> for Index {
    fn from_iter<T: IntoIterator<Item = Moment>>(moments: T) -> Self {
        let moments: Vec<Moment> = moments.into_iter().collect();
        let values = |of: fn(&Moment) -> i64| moments.iter().map(of);
        Self::on("decision", values(|moment| moment.decision))
            .with("segment", values(|moment| moment.segment))
            .with("sample", values(|moment| moment.sample))
            .with("time", values(|moment| moment.time_ns))
    }
}

impl Index {
    /// A row at each of these ticks of one timeline alone.
    pub(super) fn on(timeline: &'static str, ticks: impl IntoIterator<Item = i64>) -> Self {
        Self::default().with(timeline, ticks)
    }

    /// These rows at these ticks of another timeline, too; without any they are not on it.
    pub(super) fn with(
        mut self,
        timeline: &'static str,
        ticks: impl IntoIterator<Item = i64>,
    ) -> Self {
        self.0.insert(timeline, ticks.into_iter().collect());
        self
    }

    /// These rows all at one tick of another timeline, if it is given.
    pub(super) fn all_at(self, timeline: &'static str, tick: Option<i64>) -> Self {
        let rows = self.len();
        self.with(timeline, tick.into_iter().flat_map(|tick| std::iter::repeat_n(tick, rows)))
    }

    pub(super) fn len(&self) -> usize {
        self.0.values().map(Vec::len).max().unwrap_or(0)
    }

    /// Some of these rows, in this order.
    pub(super) fn rows(&self, places: &[usize]) -> Self {
        let chosen = |ticks: &Vec<i64>| {
            places.iter().filter_map(|place| ticks.get(*place).copied()).collect()
        };
        Self(self.0.iter().map(|(timeline, ticks)| (*timeline, chosen(ticks))).collect())
    }

    /// These rows off the timeline of segments.
    ///
    /// On it the samples of a segment would all lie at one place, and a plot of them would be a
    /// comb.
    pub(super) fn without_segment(mut self) -> Self {
        self.0.remove("segment");
        self
    }

    /// One row before all others, on the timelines of decisions and, where it is opened on, of
    /// revisions or of differences alone.
    pub(super) fn before_all(opening: Opening) -> Self {
        Self::on("decision", [opening.tick]).opened(opening)
    }

    /// One row on every timeline, at its first tick or before it; `start` is the first sample.
    pub(super) fn everywhere(start: Moment, opening: Opening) -> Self {
        let start = Moment { decision: opening.tick, ..start };
        std::iter::once(start).collect::<Self>().with("doubt", [1]).opened(opening)
    }

    /// One row on each timeline on which no sample lies.
    pub(super) fn off_the_record(opening: Opening) -> Self {
        Self::on("segment", [1]).with("doubt", [1]).opened(opening)
    }

    fn opened(self, Opening { revision, is_compared, .. }: Opening) -> Self {
        self.all_at("revision", revision).all_at("difference", is_compared.then_some(1))
    }

    fn columns(self) -> impl Iterator<Item = TimeColumn> {
        let filled = self.0.into_iter().filter(|(_, ticks)| !ticks.is_empty());
        filled.map(|(timeline, ticks)| match timeline {
            "time" => TimeColumn::new_duration_nanos(timeline, ticks),
            _ => TimeColumn::new_sequence(timeline, ticks),
        })
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
        let root = EntityPath::root();
        Chunks { namespace, root, tag: self.tag << 32, rows: 0, made: Vec::new() }
    }
}

/// Collects chunks of one namespace, whose entities lie below one root.
pub(super) struct Chunks {
    namespace: u64,
    root: EntityPath,
    tag: u64,
    rows: u64,
    made: Vec<Chunk>,
}

impl Chunks {
    /// These chunks, with their entities below `root`.
    pub(super) fn rooted(self, root: EntityPath) -> Self {
        Self { root, ..self }
    }

    /// Rows of `columns` at the moments of `index`; nothing when there is none.
    pub(super) fn push(
        &mut self,
        entity: impl Into<EntityPath>,
        index: Index,
        columns: impl IntoIterator<Item = SerializedComponentColumn>,
    ) -> Result<(), RecordError> {
        match index.len() {
            0 => Ok(()),
            rows => self.push_rows(entity, rows, index.columns(), columns),
        }
    }

    /// Data that is there at all times.
    pub(super) fn push_static(
        &mut self,
        entity: impl Into<EntityPath>,
        data: &dyn AsComponents,
    ) -> Result<(), RecordError> {
        let columns = data.as_serialized_batches().into_iter().map(Into::into);
        self.push_rows(entity, 1, [], columns)
    }

    /// A page in Markdown that is there at all times.
    pub(super) fn page(
        &mut self,
        entity: impl Into<EntityPath>,
        text: String,
    ) -> Result<(), RecordError> {
        self.push_static(entity, &TextDocument::from_markdown(text))
    }

    /// A page in Markdown per row.
    pub(super) fn pages(
        &mut self,
        entity: impl Into<EntityPath>,
        index: Index,
        texts: impl IntoIterator<Item = String>,
    ) -> Result<(), RecordError> {
        let markdown = std::iter::repeat_n("text/markdown", index.len());
        let pages = TextDocument::update_fields().with_many_text(texts);
        let pages = pages.with_many_media_type(markdown);
        self.push(entity, index, pages.columns_of_unit_batches()?)
    }

    /// A line of a list per row; its level says in which colour.
    pub(super) fn lines(
        &mut self,
        entity: impl Into<EntityPath>,
        index: Index,
        lines: impl IntoIterator<Item = (Option<&'static str>, String)>,
    ) -> Result<(), RecordError> {
        let (levels, lines): (Vec<_>, Vec<_>) = lines.into_iter().unzip();
        let log = TextLog::update_fields().with_many_text(lines);
        let levels: Vec<_> = levels.into_iter().flatten().collect();
        let log = if levels.is_empty() { log } else { log.with_many_level(levels) };
        self.push(entity, index, log.columns_of_unit_batches()?)
    }

    /// A state of a lane per row.
    pub(super) fn states(
        &mut self,
        entity: impl Into<EntityPath>,
        index: Index,
        states: impl IntoIterator<Item = impl Into<String>>,
    ) -> Result<(), RecordError> {
        let states: Vec<String> = states.into_iter().map(Into::into).collect();
        let states = StateChange::new().with_state(states);
        self.push(entity, index, states.columns_of_unit_batches()?)
    }

    /// A number per row, or an empty one.
    pub(super) fn scalars(
        &mut self,
        entity: impl Into<EntityPath>,
        index: Index,
        values: &[Option<f64>],
    ) -> Result<(), RecordError> {
        let lengths = values.iter().map(|value| usize::from(value.is_some()));
        let scalars = Scalars::new(values.iter().copied().flatten());
        self.push(entity, index, scalars.columns(lengths)?)
    }

    /// A curve of a plot: its style, and a number per row, or an empty one where it breaks.
    pub(super) fn series(
        &mut self,
        entity: impl Into<EntityPath>,
        style: &SeriesLines,
        (index, values): (Index, Vec<Option<f64>>),
    ) -> Result<(), RecordError> {
        let entity = entity.into();
        self.push_static(entity.clone(), style)?;
        self.scalars(entity, index, &values)
    }

    /// Adds a row at `index` of what the entities below `path` have at the tick `decision`: only
    /// of components whose name begins so.
    pub(super) fn repeat(
        &mut self,
        (path, component): (&str, &str),
        decision: i64,
        index: &Index,
    ) -> Result<(), RecordError> {
        let rows: Vec<_> = self
            .below(path)
            .filter_map(|(chunk, ticks)| {
                let row = ticks.iter().rposition(|tick| *tick <= decision)?;
                Some((self.relative(chunk), cells(chunk, row, component)))
            })
            .collect();
        for (entity, columns) in rows.into_iter().filter(|(_, columns)| !columns.is_empty()) {
            self.push(entity, index.clone(), columns)?;
        }
        Ok(())
    }

    /// Adds once more, from the tick `from` on, the rows that the entities below `path` have at `ticks`
    /// of decisions, on that timeline alone.
    pub(super) fn replay(
        &mut self,
        path: &str,
        ticks: RangeInclusive<i64>,
        from: i64,
    ) -> Result<(), RecordError> {
        let mut rows = Vec::new();
        for (chunk, at) in self.below(path) {
            for (row, tick) in at.iter().enumerate().filter(|(_, tick)| ticks.contains(*tick)) {
                let index = Index::on("decision", [tick - ticks.start() + from]);
                rows.push((self.relative(chunk), index, cells(chunk, row, "")));
            }
        }
        rows.into_iter().try_for_each(|(entity, index, columns)| self.push(entity, index, columns))
    }

    /// The chunks of the entities below `path` that have ticks of decisions, with these.
    fn below(&self, path: &str) -> impl Iterator<Item = (&Chunk, &[i64])> {
        let root = self.root.join(&path.into());
        let shown = self.made.iter().filter(move |chunk| chunk.entity_path().starts_with(&root));
        shown.filter_map(|chunk| {
            Some((chunk, chunk.timelines().get(&"decision".into())?.times_raw()))
        })
    }

    /// The entity of one of these chunks below their root.
    fn relative(&self, chunk: &Chunk) -> EntityPath {
        chunk.entity_path().iter().skip(self.root.len()).cloned().collect()
    }

    fn push_rows(
        &mut self,
        entity: impl Into<EntityPath>,
        rows: usize,
        timelines: impl IntoIterator<Item = TimeColumn>,
        columns: impl IntoIterator<Item = SerializedComponentColumn>,
    ) -> Result<(), RecordError> {
        let id = ChunkId::from_tuid(self.tuid(0x8000_0000_0000_0000 | self.made.len() as u64));
        let first = self.rows;
        self.rows += rows as u64;
        let row_ids: Vec<_> =
            (first..self.rows).map(|row| RowId::from_tuid(self.tuid(row + 1))).collect();
        let timelines = timelines.into_iter().map(|column| (*column.timeline().name(), column));
        let components = columns.into_iter().map(|c| (c.descriptor, c.list_array)).collect();
        let timelines = timelines.collect();
        let entity = self.root.join(&entity.into());
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

/// What a store is and who made it: the first message of each.
pub(super) fn store_message(store: &StoreId) -> LogMsg {
    let info = StoreInfo::new(
        store.clone(),
        StoreSource::Other(format!("tauscope {}", env!("CARGO_PKG_VERSION"))),
    );
    LogMsg::SetStoreInfo(SetStoreInfo { row_id: Tuid::from_nanos_and_inc(1, 0), info })
}

/// A chunk of a store.
pub(super) fn chunk_message(store: &StoreId, chunk: &Chunk) -> Result<LogMsg, RecordError> {
    Ok(LogMsg::ArrowMsg(store.clone(), chunk.to_arrow_msg()?))
}

/// A curve of a plot: its name in legends, colour and width.
pub(super) fn line(name: impl Into<String>, rgb: Rgb, width: f32) -> SeriesLines {
    SeriesLines::new().with_names([name.into()]).with_colors([color(rgb)]).with_widths([width])
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

/// A column of a table with rows `R`: its name, what it holds, and the value of a row.
pub(super) type Column<R> = (&'static str, Kind, fn(&R) -> Value);

/// Such columns of `rows`.
pub(super) fn columns<R>(rows: &[R], all: &[Column<R>]) -> Vec<SerializedComponentColumn> {
    let column = |(name, kind, value): &Column<R>| values(name, *kind, rows.iter().map(value));
    all.iter().map(column).collect()
}

/// A column of values of a `kind` named `name`; what is not of the kind is null.
pub(super) fn values(
    name: &'static str,
    kind: Kind,
    values: impl Iterator<Item = Value>,
) -> SerializedComponentColumn {
    match kind {
        Kind::Text => {
            column::<_, StringArray>(name, values.map(|it| Some(it.as_str()?.to_owned())))
        }
        Kind::Whole => column::<_, Int64Array>(name, values.map(|it| it.as_i64())),
        Kind::Samples | Kind::Real | Kind::Plain => {
            column::<_, Float64Array>(name, values.map(|it| it.as_f64()))
        }
    }
}

/// A column of numbers to be looked at, named `name`: to five digits; `None` is null.
pub(super) fn shown(
    name: &'static str,
    values: impl IntoIterator<Item = Option<f64>>,
) -> SerializedComponentColumn {
    let rounded = |value: f64| number(value).parse().unwrap_or(f32::NAN);
    column::<_, Float32Array>(name, values.into_iter().map(|value| value.map(rounded)))
}

fn column<T, A: Array + FromIterator<Option<T>> + 'static>(
    name: &'static str,
    values: impl IntoIterator<Item = Option<T>>,
) -> SerializedComponentColumn {
    let values: Vec<Option<T>> = values.into_iter().collect();
    let is_there: Vec<bool> = values.iter().map(Option::is_some).collect();
    let lengths = is_there.iter().map(|is_there| usize::from(*is_there));
    let items: A = values.into_iter().flatten().map(Some).collect();
    lists_of(name, items, lengths, Some(is_there.clone().into()))
}

/// A column of lists of numbers named `name`; `None` is null.
pub(super) fn lists<N>(name: &'static str, rows: &[Vec<N>]) -> SerializedComponentColumn
where
    N: Copy,
    Option<f64>: From<N>,
{
    let items: Float64Array = rows.iter().flatten().map(|item| Option::from(*item)).collect();
    lists_of(name, items, rows.iter().map(Vec::len), None)
}

fn lists_of(
    name: &'static str,
    items: impl Array + 'static,
    lengths: impl Iterator<Item = usize>,
    nulls: Option<NullBuffer>,
) -> SerializedComponentColumn {
    let field = Field::new_list_field(items.data_type().clone(), true);
    let offsets = OffsetBuffer::from_lengths(lengths);
    let list = ListArray::new(Arc::new(field), offsets, Arc::new(items), nulls);
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
