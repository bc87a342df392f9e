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
mod fields;
mod message;
mod notes;
mod runs;
mod series;
mod stream;
mod topics;

use std::collections::BTreeMap;
use std::fs::File;
use std::io::BufReader;
use std::path::{Path, PathBuf};

use mcap::records::{MessageHeader, Record};

use self::series::Series;
use self::stream::refused;
use self::topics::{Clock, Place, Topics};
use crate::experiment::error::ReadError;
use crate::experiment::memory::Budget;
use crate::experiment::table::{Column, Head, Labels, OpenTable, Rows, Table, Wanted};

/// A file whose topics are known.
struct Unread {
    path: PathBuf,
    topics: Topics,
    places: Vec<Place>,
    budget: Budget,
}

/// Opens the log and looks at its messages.
pub(super) fn open(path: &Path, budget: Budget) -> Result<OpenTable, ReadError> {
    let (file, size) = opened(path)?;
    let mut topics = Topics::default();
    stream::each_record(file, size, &budget, |record| topics.look_at(record, &budget))
        .and_then(|()| topics.check())?;
    let places = topics.places();
    let headers = places.iter().map(|place| topics.header(place)).collect();
    let unread = std::mem::take(&mut topics.left);
    let rows = Box::new(Unread { path: path.to_owned(), topics, places, budget });
    Ok(OpenTable { head: Head { headers, header_row: 0, unread }, rows })
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
        let series = self.collect(clock, self.series(wanted))?;
        let name = |topic| self.topics.name(topic);
        let of_several = notes::clocks_differ(&series, name, clock.name());
        let mut aligned = self.topics.align(series, wanted, &self.budget)?;
        let zero = self.topics.zero.get(&clock).copied().unwrap_or_default();
        let times = format!("times are {} from {:.9} s on", clock.name(), zero as f64 * 1e-9);
        let notes = [times].into_iter().chain(std::mem::take(&mut aligned.notes)).chain(of_several);
        let notes = notes.collect();
        let labels = wanted.label.and_then(|label| aligned.columns.get(&label));
        let labels = labels.into_iter().flatten().map(f64::to_string);
        let labels = Labels::of(labels, &self.budget)?;
        let column = |index: &usize| match self.places.get(*index) {
            Some(Place::Time(other)) => {
                let times = aligned.times.iter().filter(|_| *other == clock);
                times.map(|time| time.saturating_sub(zero) as f64 / 1e9).collect()
            }
            _ => aligned.columns.remove(index).unwrap_or_default(),
        };
        let columns = wanted.numeric.iter().map(column).map(Column::of).collect();
        let rows = aligned.times.len();
        Ok(Table { notes, ..Table::counted(rows, columns, labels) })
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

    /// Collects what is wanted of the messages.
    fn collect(
        &self,
        clock: Clock,
        mut series: BTreeMap<usize, Series>,
    ) -> Result<Vec<Series>, ReadError> {
        let (file, size) = opened(&self.path)?;
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
    ) -> Result<(), ReadError> {
        let Some(channel) = self.topics.channels.get(&header.channel_id) else { return Ok(()) };
        let Some(series) = series.get_mut(&channel.topic) else { return Ok(()) };
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
        series.least_lag = [series.least_lag, lag].into_iter().flatten().min();
        series.push((time, place), &value, &self.budget)
    }
}
