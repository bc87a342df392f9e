//! MCAP: logs of ROS 2. Each number of the messages of each topic is a column.
//!
//! A column is called by topic and field: `/valve.data[0]`, `/joint_states.position[boom]`.
//! An element of an array is called by its name where the message names its elements, in a
//! field `name` or `…names`, else by its number from 0. Messages are decoded by the
//! definitions that the file itself holds.
//!
//! Each topic is a series with times of its own. The rows are the messages of the topic of the output;
//! what comes from other topics is held from their latest message; of a slow output there are rows meanwhile.
//! The file is read twice: to see what there is, and for the values that are wanted, which are all that
//! is kept.

mod align;
mod fault;
mod fields;
mod message;
mod notes;
mod runs;
mod series;
mod stream;
mod topics;

use std::collections::BTreeMap;
use std::fs::File;
use std::io::{BufReader, Read};
use std::path::Path;

use mcap::records::{MessageHeader, Record};

use self::align::{Aligned, Alignment};
use self::fault::Fault;
use self::series::Series;
use self::topics::{Clock, Place, Topics};
use crate::experiment::error::ReadError;
use crate::experiment::memory::Budget;
use crate::experiment::source::Hashing;
use crate::experiment::table::{Head, Labels, OpenTable, RowNumbers, Rows, Table, Wanted};

/// A file whose topics are known.
struct Unread {
    topics: Topics,
    places: Vec<Place>,
    budget: Budget,
}

/// Opens the log and looks at its messages.
pub(super) fn open(path: &Path, budget: Budget) -> Result<OpenTable, ReadError> {
    let (file, size) = opened(path)?;
    let mut topics = Topics::default();
    stream::each_record(BufReader::new(file), size, &budget, |record| {
        topics.look_at(record, &budget)
    })
    .and_then(|()| topics.check())
    .map_err(|fault| fault.refuse(path))?;
    let places = topics.places();
    let headers = places.iter().map(|place| topics.header(place)).collect();
    let unread = std::mem::take(&mut topics.left);
    let rows = Box::new(Unread { topics, places, budget });
    let head = Head { path: path.to_owned(), headers, header_row: 0, unread };
    Ok(OpenTable { head, rows })
}

/// The file, and its length in bytes.
fn opened(path: &Path) -> Result<(File, u64), ReadError> {
    let io_error = |source| ReadError::Io { path: path.to_owned(), source };
    let file = File::open(path).map_err(io_error)?;
    let size = file.metadata().map_err(io_error)?.len();
    Ok((file, size))
}

impl Rows for Unread {
    fn read(self: Box<Self>, wanted: &Wanted<'_>) -> Result<Table, ReadError> {
        let path = wanted.path();
        let (file, size) = opened(path)?;
        let mut file = Hashing::new(BufReader::new(file));
        let clock = self.clock(wanted);
        let series = self
            .collect(&mut file, size, clock, self.series(wanted))
            .map_err(|fault| fault.refuse(path))?;
        let source = file.finish(path)?;
        let name = |topic| self.topics.name(topic);
        let of_several = notes::clocks_differ(&series, name, clock.name());
        let alignment = Alignment {
            topics: &self.topics,
            topic: wanted.clock,
            label: wanted.label,
            budget: &self.budget,
        };
        let mut aligned = alignment.align(series).map_err(|fault| fault.refuse(path))?;
        let zero = self.topics.zero(clock).unwrap_or_default();
        let times = format!("times are {} from {:.9} s on", clock.name(), zero as f64 * 1e-9);
        let notes = [times].into_iter().chain(std::mem::take(&mut aligned.notes)).chain(of_several);
        let notes = notes.map(|note| format!("{}: {note}", path.display())).collect();
        let trials = self.labels(wanted, &aligned)?.runs();
        let rows = RowNumbers::counted(aligned.rows());
        let column = |index: &usize| match self.places.get(*index) {
            Some(Place::Time(other)) => aligned.times(*other, clock, zero),
            _ => aligned.column(*index),
        };
        let columns = wanted.numeric.iter().map(column).collect();
        Ok(Table { source, rows, columns, trials, notes })
    }
}

impl Unread {
    /// The clock that is wanted; the recorded time where there is a sample period instead.
    fn clock(&self, wanted: &Wanted<'_>) -> Clock {
        let clock = |index: &usize| match self.places.get(*index) {
            Some(Place::Time(clock)) => Some(*clock),
            _ => None,
        };
        wanted.numeric.iter().find_map(clock).unwrap_or(Clock::Log)
    }

    /// What is to be collected, by topics.
    fn series(&self, wanted: &Wanted<'_>) -> BTreeMap<usize, Series> {
        let mut series: BTreeMap<usize, Series> = BTreeMap::new();
        for index in wanted.numeric.iter().chain(&wanted.label).copied() {
            if let Some(Place::Field(topic, field)) = self.places.get(index) {
                series.entry(*topic).or_insert_with(|| Series::of(*topic)).add(index, field);
            }
        }
        series
    }

    /// Collects what is wanted of the messages of a file of `size` bytes.
    fn collect(
        &self,
        file: impl Read,
        size: u64,
        clock: Clock,
        mut series: BTreeMap<usize, Series>,
    ) -> Result<Vec<Series>, Fault> {
        let mut place = 0_u32;
        stream::each_record(file, size, &self.budget, |record| {
            if let Record::Message { header, data } = record {
                self.take((&header, place), &data, clock, &mut series)?;
                place = place.saturating_add(1);
            }
            Ok(())
        })?;
        Ok(series.into_values().collect())
    }

    /// Takes what is wanted of a message.
    fn take(
        &self,
        (header, place): (&MessageHeader, u32),
        data: &[u8],
        clock: Clock,
        series: &mut BTreeMap<usize, Series>,
    ) -> Result<(), Fault> {
        let Some(channel) = self.topics.channels.get(&header.channel_id) else { return Ok(()) };
        let Some(series) = series.get_mut(&channel.topic) else { return Ok(()) };
        let name = self.topics.name(channel.topic);
        let value = channel.decoder.decode(data).map_err(|reason| {
            let (number, time) = (header.sequence, header.log_time);
            Fault::new(
                format!(
                    "the message of `{name}` with the sequence number {number}, logged at {time} ns: {reason}"
                ),
                "check that it was recorded with the definition that the file holds",
            )
        })?;
        let Some(time) = clock.time(header, &value) else {
            return Err(Fault::new(
                format!("the messages of `{name}` have no {}", clock.name()),
                "choose another time column; `log_time` is the time of recording",
            ));
        };
        let lag = Clock::Log.time(header, &value).map(|recorded| recorded.saturating_sub(time));
        series.least_lag = [series.least_lag, lag].into_iter().flatten().min();
        Ok(series.push((time, place), &value, &self.budget)?)
    }

    /// The labels of the rows.
    fn labels(&self, wanted: &Wanted<'_>, aligned: &Aligned) -> Result<Labels, ReadError> {
        let mut labels = Labels::default();
        let values = wanted.label.map_or(&[][..], |label| aligned.values(label));
        for (value, row) in values.iter().zip(1..) {
            labels.push(&value.to_string(), row, (wanted.path(), &self.budget))?;
        }
        Ok(labels)
    }
}
