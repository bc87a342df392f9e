//! MCAP: logs of ROS 2. Each number of the messages of each topic is a column.
//!
//! A column is called by topic and field: `/valve.data[0]`, `/joint_states.position[boom]`.
//! An element of an array is called by its name where the message names its elements, in a
//! field `name` or `…names`, else by its number from 0. Messages are decoded by the
//! definitions that the file itself holds.
//!
//! Each topic has times of its own. The rows are the messages of the topic of the output;
//! what comes from other topics is held from their latest message; of a slow output there are rows meanwhile.
//! All numbers of a file are kept, but for arrays of more elements than a machine has joints.

mod fields;
mod message;
mod messages;
mod notes;
mod stream;
mod topics;

use std::path::Path;

use self::messages::{Messages, times_of};
use self::stream::{for_each_record, refused};
use self::topics::{Clock, Place, Topics};
use crate::experiment::error::ReadError;
use crate::experiment::memory::Budget;
use crate::experiment::names::listed;
use crate::experiment::table::{Column, Head, Labels, Opened, Table, Wanted};

/// A file whose messages are known.
struct Unread {
    topics: Topics,
    places: Vec<Place>,
}

/// Opens the log and takes the numbers of its messages.
pub(super) fn open(path: &Path, budget: &Budget) -> Result<Opened, ReadError> {
    let mut topics = Topics::default();
    for_each_record(path, budget, |opcode, fields| topics.take(opcode, fields, budget))?;
    topics.check()?;
    let places = topics.places();
    let headers = places.iter().map(|place| topics.header(*place)).collect();
    let unread = std::mem::take(&mut topics.left);
    let head = Head { unread, ..Head::without_lines(headers) };
    let log = Unread { topics, places };
    Ok((head, Box::new(move |wanted| log.read(wanted))))
}

impl Unread {
    fn read(&self, wanted: &Wanted<'_>) -> Result<Table, ReadError> {
        // Where there is a sample period instead, messages are ordered by the recorded time.
        let clock = wanted.numeric.iter().find_map(|header| self.clock(*header));
        let clock = clock.unwrap_or(Clock::Log);
        let mut messages = Messages::default();
        for header in wanted.numeric.iter().chain(&wanted.label) {
            if let Some(Place::Field(topic, field)) = self.places.get(*header) {
                messages.want(*topic, *field, *header);
            }
        }
        messages.take(&self.topics, clock, wanted.budget)?;
        let mut table = messages.table(wanted)?;
        if table.times.is_empty() && times_of(&messages.list, wanted.clock).next().is_some() {
            return Err(self.never_together(&messages, wanted.clock));
        }
        let zero = self.topics.zero[clock as usize].unwrap_or_default();
        let name = |topic| self.topics.name(topic);
        let mut notes =
            vec![format!("times are {} from {:.9} s on", clock.name(), zero as f64 * 1e-9)];
        notes.extend(notes::held(&messages, wanted.clock, table.early, name));
        notes.extend(notes::clocks_differ(&messages, name, clock.name()));
        let column = |header: usize| messages.column(header).map(|at| &table.columns[at]);
        let labels = wanted.label.and_then(column).into_iter().flatten().map(f64::to_string);
        let labels = Labels::of(labels, wanted.budget)?;
        let column = |header: &usize| match (self.clock(*header), messages.column(*header)) {
            (Some(of), _) if of == clock => {
                let times = table.times.iter();
                times.map(|time| time.saturating_sub(zero) as f64 / 1e9).collect()
            }
            (_, Some(at)) => std::mem::take(&mut table.columns[at]),
            _ => Vec::new(),
        };
        let columns = wanted.numeric.iter().map(column).map(Column::of).collect();
        Ok(Table { notes, ..Table::counted(wanted, columns, labels) })
    }

    /// The clock whose times are in a column.
    fn clock(&self, header: usize) -> Option<Clock> {
        match self.places.get(header) {
            Some(Place::Time(clock)) => Some(*clock),
            _ => None,
        }
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
}
