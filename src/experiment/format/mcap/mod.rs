//! MCAP: logs of ROS 2. Each number of the messages of each topic is a column.
//!
//! A column is called by topic and field: `/valve.data[0]`, `/joint_states.position[boom]`.
//! An element of an array is called by its name where the message names its elements, in a
//! field `name` or `…names`, else by its number from 0. Messages are decoded by the
//! definitions that the file itself holds.
//!
//! Each topic has times of its own. The rows are the messages of the topic of the output;
//! what comes from other topics is held from their latest message; of a slow output there are rows meanwhile.
//! The file is read twice: to see what there is, and for the values that are wanted, which are all that
//! is kept.

mod fields;
mod message;
mod messages;
mod notes;
mod stream;
mod topics;

use std::fs::File;
use std::io::BufReader;
use std::path::{Path, PathBuf};

use mcap::records::{MessageHeader, Record};

use self::messages::{Aligned, Messages, times_of};
use self::stream::refused;
use self::topics::{Clock, Place, Topics};
use crate::experiment::error::ReadError;
use crate::experiment::memory::Budget;
use crate::experiment::names::listed;
use crate::experiment::table::{Column, Head, Labels, Opened, Rows, Table, Wanted};

/// A file whose topics are known.
struct Unread {
    path: PathBuf,
    topics: Topics,
    places: Vec<Place>,
}

/// Opens the log and looks at its messages.
pub(super) fn open(path: &Path, budget: &Budget) -> Result<Opened, ReadError> {
    let (file, size) = opened(path)?;
    let mut topics = Topics::default();
    stream::each_record(file, size, budget, |record| topics.look_at(record, budget))
        .and_then(|()| topics.check())?;
    let places = topics.places();
    let headers = places.iter().map(|place| topics.header(place)).collect();
    let unread = std::mem::take(&mut topics.left);
    let rows = Box::new(Unread { path: path.to_owned(), topics, places });
    Ok((Head { headers, header_row: 0, unread }, rows))
}

/// The file, and its length in bytes.
fn opened(path: &Path) -> Result<(BufReader<File>, u64), ReadError> {
    let file = File::open(path)?;
    let size = file.metadata()?.len();
    Ok((BufReader::new(file), size))
}

impl Rows for Unread {
    fn read(self: Box<Self>, wanted: &Wanted<'_>) -> Result<Table, ReadError> {
        let clock = self.clock(wanted);
        let mut messages = self.collect(clock, wanted)?;
        let mut table = messages.table(wanted)?;
        if table.times.is_empty() && times_of(&messages.list, wanted.clock).next().is_some() {
            return Err(self.never_together(&messages, wanted.clock));
        }
        let zero = self.topics.zero.get(&clock).copied().unwrap_or_default();
        let notes = self.notes(&messages, &table, (clock, zero), wanted);
        let column = |header: usize| messages.column(header).map(|at| &table.columns[at]);
        let labels = wanted.label.and_then(column).into_iter().flatten().map(f64::to_string);
        let labels = Labels::of(labels, wanted.budget)?;
        let column = |index: &usize| match self.places.get(*index) {
            Some(Place::Time(other)) => {
                let times = table.times.iter().filter(|_| *other == clock);
                times.map(|time| time.saturating_sub(zero) as f64 / 1e9).collect()
            }
            _ => messages
                .column(*index)
                .map_or_else(Vec::new, |at| std::mem::take(&mut table.columns[at])),
        };
        let columns = wanted.numeric.iter().map(column).map(Column::of).collect();
        Ok(Table { notes, ..Table::counted(table.times.len(), columns, labels) })
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

    /// Collects what is wanted of the messages.
    fn collect(&self, clock: Clock, wanted: &Wanted<'_>) -> Result<Messages, ReadError> {
        let mut messages = Messages::default();
        for index in wanted.numeric.iter().chain(&wanted.label).copied() {
            if let Some(Place::Field(topic, field)) = self.places.get(index) {
                messages.want(*topic, field, index);
            }
        }
        let (file, size) = opened(&self.path)?;
        stream::each_record(file, size, wanted.budget, |record| match record {
            Record::Message { header, data } => {
                self.take(&header, &data, clock, (&mut messages, wanted.budget))
            }
            _ => Ok(()),
        })?;
        Ok(messages)
    }

    fn never_together(&self, messages: &Messages, clock: usize) -> ReadError {
        let others = messages.topics.keys().filter(|topic| **topic != clock);
        let others: Vec<&str> = others.map(|topic| self.topics.name(*topic)).collect();
        let (topic, others) = (self.topics.name(clock), listed(others.into_iter()));
        refused(
            format!("no message of {topic} comes after the first ones of {others}"),
            "choose topics that were recorded together, and `--time log_time` where their stamps are of \
             several clocks",
        )
    }

    /// What the reader of the log should know.
    fn notes(
        &self,
        messages: &Messages,
        table: &Aligned,
        (clock, zero): (Clock, i64),
        wanted: &Wanted<'_>,
    ) -> Vec<String> {
        let name = |topic| self.topics.name(topic);
        let mut notes =
            vec![format!("times are {} from {:.9} s on", clock.name(), zero as f64 * 1e-9)];
        notes.extend(notes::held(messages, wanted.clock, table.early, name));
        if table.empty_runs > 0 {
            let runs = table.empty_runs;
            notes.push(format!(
                "its clock starts anew, and {runs} runs without a message of each topic are left out"
            ));
        }
        notes.extend(notes::clocks_differ(messages, name, clock.name()));
        notes
    }

    /// Takes what is wanted of a message.
    fn take(
        &self,
        header: &MessageHeader,
        data: &[u8],
        clock: Clock,
        (messages, budget): (&mut Messages, &Budget),
    ) -> Result<(), ReadError> {
        let Some(channel) = self.topics.channels.get(&header.channel_id) else { return Ok(()) };
        let Some(topic) = messages.topics.get_mut(&channel.topic) else { return Ok(()) };
        let name = self.topics.name(channel.topic);
        let value = channel.decoder.decode(data).map_err(|reason| {
            let (number, time) = (header.sequence, header.log_time);
            refused(
                format!(
                    "the message of `{name}` with the sequence number {number}, logged at {time} ns: {reason}"
                ),
                "check that it was recorded with the definition that the file holds",
            )
        })?;
        let Some(time) = clock.time(header, &value) else {
            return Err(refused(
                format!("the messages of `{name}` have no {}", clock.name()),
                "choose another time column; `log_time` is the time of recording",
            ));
        };
        let lag = Clock::Log.time(header, &value).map(|recorded| recorded.saturating_sub(time));
        topic.least_lag = [topic.least_lag, lag].into_iter().flatten().min();
        messages.push(channel.topic, time, &value, budget)
    }
}
