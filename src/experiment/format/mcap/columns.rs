//! The columns of a file: its topics found, and the messages of those that are wanted.

use std::collections::BTreeMap;
use std::fs::File;
use std::io::{BufReader, Seek as _};
use std::ops::ControlFlow;
use std::path::Path;

use mcap::records::{MessageHeader, Record};
use re_ros_msg::deserialize::Value;

use super::align::{align, clocks_differ};
use super::clock::Clock;
use super::contents::{Contents, Place, broken};
use super::fault::Fault;
use super::later::LaterFields;
use super::series::Series;
use super::stream;
use crate::experiment::error::ReadError;
use crate::experiment::memory::Budget;
use crate::experiment::source::Hashing;
use crate::experiment::table::{Head, Labels, OpenTable, RowNumbers, Rows, Table, Wanted};

/// A file whose topics are known.
struct Unread {
    contents: Contents,
    places: Vec<Place>,
    budget: Budget,
}

/// Opens the log and looks at the first messages of each topic.
pub(in crate::experiment::format) fn open(
    path: &Path,
    budget: Budget,
) -> Result<OpenTable, ReadError> {
    let io_error = |source| ReadError::Io { path: path.to_owned(), source };
    let mut file = File::open(path).map_err(io_error)?;
    let size = file.metadata().map_err(io_error)?.len();
    let summary = stream::summary(&file, size, &budget);
    let start = summary.as_ref().and_then(|summary| summary.start);
    let mut contents = Contents { zero: [start, None, None], ..Contents::default() };
    file.rewind().map_err(io_error)?;
    stream::each_record(BufReader::new(file), size, &budget, |record| {
        contents.look_at(record, summary.as_ref(), &budget)
    })
    .map_err(|fault| fault.refuse(path))?;
    if contents.topics.iter().all(|topic| topic.fields.is_empty()) {
        return Err(contents.nothing().refuse(path));
    }
    let places = contents.places();
    let headers = places.iter().map(|place| contents.header(place)).collect();
    let unread = std::mem::take(&mut contents.left);
    let rows = Box::new(Unread { contents, places, budget });
    let head = Head { path: path.to_owned(), headers, header_row: 0, unread };
    Ok(OpenTable { head, rows })
}

impl Rows for Unread {
    fn read(self: Box<Self>, wanted: &Wanted<'_>) -> Result<Table, ReadError> {
        let refuse = |fault: Fault| fault.refuse(wanted.path());
        let io_error = |source| ReadError::Io { path: wanted.path().to_owned(), source };
        let file = File::open(wanted.path()).map_err(io_error)?;
        let size = file.metadata().map_err(io_error)?.len();
        let clock = self.clock(wanted);
        let mut series = self.series(wanted);
        let mut file = Hashing::new(BufReader::new(file));
        let mut place = 0_u32;
        let mut later = LaterFields::default();
        stream::each_record(&mut file, size, &self.budget, |record| {
            if let Record::Message { header, data } = record {
                if let Some((topic, value)) =
                    self.collect((&header, place), &data, clock, &mut series)?
                {
                    later.look_at(&self.contents, (topic, data.len()), &value);
                }
                place = place.saturating_add(1);
            }
            Ok(ControlFlow::Continue(()))
        })
        .map_err(refuse)?;
        let source = file.finish(wanted.path())?;
        let series: Vec<Series> = series.into_values().collect();
        let of_several = clocks_differ(&series, |topic| self.contents.name(topic), clock.name());
        let refuse = |fault: Fault| fault.also(of_several.as_deref()).refuse(wanted.path());
        let mut aligned = align(series, (wanted.clock, wanted.label), &self.budget, |topic| {
            self.contents.name(topic)
        })
        .map_err(refuse)?;
        let zero = self.contents.zero(clock);
        let mut notes = vec![format!(
            "{}: times are {} from {:.9} s on",
            wanted.path().display(),
            clock.name(),
            zero as f64 * 1e-9
        )];
        let mut held = std::mem::take(&mut aligned.notes);
        held.extend(later.notes(&self.contents));
        held.extend(of_several);
        notes.extend(held.iter().map(|note| format!("{}: {note}", wanted.path().display())));
        let mut column = |index: &usize| match self.places.get(*index) {
            Some(Place::Time(other)) => aligned.times(*other, clock, zero),
            _ => aligned.column(*index),
        };
        let columns = wanted.numeric.iter().map(&mut column).collect();
        let mut labels = Labels::default();
        for (value, row) in
            wanted.label.map(|label| column(&label).values).iter().flatten().zip(1..)
        {
            labels.push(&value.to_string(), row, (wanted.path(), &self.budget))?;
        }
        let rows = RowNumbers::counted(aligned.rows());
        Ok(Table { source, rows, columns, trials: labels.runs(), notes })
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
            if let Some(Place::Field { topic, field }) = self.places.get(index) {
                match series.get_mut(topic) {
                    Some(known) => known.add(index, field),
                    None => {
                        series.insert(*topic, Series::of(*topic, index, field));
                    }
                }
            }
        }
        series
    }

    /// Takes what is wanted of a message; comes back with it and its topic, if that is wanted.
    fn collect(
        &self,
        (header, place): (&MessageHeader, u32),
        data: &[u8],
        clock: Clock,
        series: &mut BTreeMap<usize, Series>,
    ) -> Result<Option<(usize, Value)>, Fault> {
        let Some((topic, decoder)) = self.contents.channels.get(&header.channel_id) else {
            return Ok(None);
        };
        let Some(series) = series.get_mut(topic) else { return Ok(None) };
        let name = self.contents.name(*topic);
        let value = decoder.decode(data).map_err(|reason| broken(name, header, &reason))?;
        let Some(time) = clock.time(header, &value) else {
            return Err(Fault::new(
                format!("the messages of `{name}` have no {}", clock.name()),
                "choose another time column; `log_time` is the time of recording",
            ));
        };
        let lag = Clock::Log.time(header, &value).map(|recorded| recorded.saturating_sub(time));
        series.least_lag = [series.least_lag, lag].into_iter().flatten().min();
        series.push((time, place), &value, &self.budget)?;
        Ok(Some((*topic, value)))
    }
}
