//! The columns of a file: its topics found, and the messages of those that are wanted.

use std::fs::File;
use std::io::{BufReader, Seek as _};
use std::ops::ControlFlow;
use std::path::Path;

use mcap::records::{MessageHeader, Record};

use super::align::align;
use super::clock::Clock;
use super::contents::{Contents, Place, broken};
use super::fault::Fault;
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
    let rows = Box::new(Unread { contents, places, budget });
    let head = Head { path: path.to_owned(), headers, header_row: 0 };
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
        stream::each_record(&mut file, size, &self.budget, |record| {
            if let Record::Message { header, data } = record {
                self.collect((&header, place), &data, clock, &mut series)?;
                place = place.saturating_add(1);
            }
            Ok(ControlFlow::Continue(()))
        })
        .map_err(refuse)?;
        let source = file.finish(wanted.path())?;
        let mut aligned =
            align(series, wanted.clock, |topic| self.contents.name(topic)).map_err(refuse)?;
        let zero = self.contents.zero(clock);
        let mut notes = vec![format!(
            "{}: times are {} from {:.9} s on",
            wanted.path().display(),
            clock.name(),
            zero as f64 * 1e-9
        )];
        let held = std::mem::take(&mut aligned.notes);
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

    /// What is to be collected of each topic.
    fn series(&self, wanted: &Wanted<'_>) -> Vec<Series> {
        let mut series: Vec<Series> = Vec::new();
        for index in wanted.numeric.iter().chain(&wanted.label).copied() {
            if let Some(Place::Field { topic, field }) = self.places.get(index) {
                match series.iter_mut().find(|known| known.topic == *topic) {
                    Some(known) => known.add(index, field),
                    None => series.push(Series::of(*topic, index, field)),
                }
            }
        }
        series
    }

    fn collect(
        &self,
        (header, place): (&MessageHeader, u32),
        data: &[u8],
        clock: Clock,
        series: &mut [Series],
    ) -> Result<(), Fault> {
        let Some((topic, decoder)) = self.contents.channels.get(&header.channel_id) else {
            return Ok(());
        };
        let Some(series) = series.iter_mut().find(|series| series.topic == *topic) else {
            return Ok(());
        };
        let name = self.contents.name(*topic);
        let value = decoder.decode(data).map_err(|reason| broken(name, header, &reason))?;
        let Some(time) = clock.time(header, &value) else {
            return Err(Fault::new(
                format!("the messages of `{name}` have no {}", clock.name()),
                "choose another time column; `log_time` is the time of recording",
            ));
        };
        series.push((time, place), &value, &self.budget)?;
        Ok(())
    }
}
