//! MCAP: logs of ROS 2. Each number of the messages of each topic is a column.
//!
//! A column is called by topic and field: `/valve.data[0]`, `/joint_states.position[boom]`.
//! An element of an array is called by its name where the message names its elements, in a
//! field `name` or `…names`, else by its number from 0. Messages are decoded by the
//! definitions that the file itself holds.
//!
//! Topics come in their own time. The rows are the messages of the topic of the output; what
//! comes from other topics is held from their latest message. Messages are read twice at
//! most: until each topic is known, and for their values, which are all that is kept.

mod message;
mod series;
mod stream;

use std::collections::HashMap;
use std::fs::File;
use std::io::BufReader;
use std::ops::ControlFlow;
use std::path::Path;

use mcap::records::{MessageHeader, Record};

use self::message::{Decoder, Field, stamp};
use self::series::Series;
use self::stream::Summary;
use super::super::ReadError;
use super::super::table::{
    Hashing, Head, Header, Labels, OpenTable, RowNumbers, Rows, Table, Wanted,
};

/// What is wrong with a file, and what to do about it.
#[derive(Debug)]
struct Fault {
    reason: String,
    remedy: &'static str,
}

impl Fault {
    fn refuse(self, path: &Path) -> ReadError {
        let (reason, remedy) = (self.reason, self.remedy);
        ReadError::Format { path: path.to_owned(), format: "MCAP", reason, remedy }
    }
}

/// The times that a message bears.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Clock {
    /// When it was recorded.
    Log,
    /// When it was published.
    Publish,
    /// What the message says itself.
    Stamp,
}

impl Clock {
    const ALL: [Self; 3] = [Self::Log, Self::Publish, Self::Stamp];

    fn name(self) -> &'static str {
        match self {
            Self::Log => "log_time",
            Self::Publish => "publish_time",
            Self::Stamp => "header.stamp",
        }
    }

    /// The time of a message in nanoseconds.
    fn time(self, header: &MessageHeader, value: &re_ros_msg::deserialize::Value) -> Option<i64> {
        match self {
            Self::Log => i64::try_from(header.log_time).ok(),
            Self::Publish => i64::try_from(header.publish_time).ok(),
            Self::Stamp => stamp(value),
        }
    }
}

/// A topic, what its messages hold, and how many of them were looked at.
#[derive(Debug)]
struct Topic {
    name: String,
    fields: Vec<Field>,
}

/// What a header stands for.
#[derive(Clone, Debug)]
enum Place {
    Time(Clock),
    Field { topic: usize, field: Field },
}

/// What is known of a file before its messages are read.
#[derive(Debug, Default)]
struct Contents {
    topics: Vec<Topic>,
    /// Topic and decoder of each channel that can be read.
    channels: HashMap<u16, (usize, Decoder)>,
    schemas: HashMap<u16, (String, String, Vec<u8>)>,
    /// Topics that cannot be read, and why.
    left: Vec<String>,
    /// The earliest time by each clock.
    zero: [Option<i64>; 3],
    /// Messages that were looked at, by channel.
    seen: HashMap<u16, u64>,
}

/// A file whose topics are known.
struct Unread {
    contents: Contents,
    places: Vec<Place>,
}

/// Opens the log and looks at the first messages of each topic.
pub(super) fn open(path: &Path) -> Result<OpenTable, ReadError> {
    let io_error = |source| ReadError::Io { path: path.to_owned(), source };
    let file = File::open(path).map_err(io_error)?;
    let summary = stream::summary(&file);
    let start = summary.as_ref().and_then(|summary| summary.start);
    let mut contents = Contents { zero: [start, None, None], ..Contents::default() };
    let file = File::open(path).map_err(io_error)?;
    stream::each_record(BufReader::new(file), |record| contents.look_at(record, summary.as_ref()))
        .map_err(|fault| fault.refuse(path))?;
    if contents.topics.iter().all(|topic| topic.fields.is_empty()) {
        return Err(contents.nothing().refuse(path));
    }
    let places = contents.places();
    let headers = places.iter().map(|place| contents.header(place)).collect();
    let rows = Box::new(Unread { contents, places });
    let head = Head { path: path.to_owned(), headers, header_row: 0 };
    Ok(OpenTable { head, rows })
}

impl Contents {
    /// Learns from a record; ends when each topic is known, where the file tells how many
    /// messages it has.
    fn look_at(
        &mut self,
        record: Record<'_>,
        summary: Option<&Summary>,
    ) -> Result<ControlFlow<()>, Fault> {
        /// Messages of a topic that show what it holds. Nodes that take turns on one topic
        /// name their own joints.
        const ENOUGH: u64 = 20;
        let known = |(channel, count): (&u16, &u64)| {
            self.seen.get(channel).copied().unwrap_or_default() >= ENOUGH.min(*count)
        };
        if summary.is_some_and(|summary| summary.counts.iter().all(known)) {
            return Ok(ControlFlow::Break(()));
        }
        if let Record::Message { header, data } = record {
            let seen = self.seen.entry(header.channel_id).or_default();
            *seen += 1;
            if *seen <= ENOUGH {
                self.learn(&header, &data)?;
            }
        } else {
            self.register(record)?;
        }
        Ok(ControlFlow::Continue(()))
    }

    /// Keeps definitions and channels.
    fn register(&mut self, record: Record<'_>) -> Result<(), Fault> {
        match record {
            Record::Schema { header, data } => {
                self.schemas.insert(header.id, (header.name, header.encoding, data.into_owned()));
            }
            Record::Channel(channel) if !self.channels.contains_key(&channel.id) => {
                let schema = self.schemas.get(&channel.schema_id);
                let (name, encoding) = schema.map_or(("", ""), |(name, e, _)| (name, e));
                if (encoding, channel.message_encoding.as_str()) != ("ros2msg", "cdr") {
                    let what = format!("{} ({} {name})", channel.topic, channel.message_encoding);
                    if !self.left.contains(&what) {
                        self.left.push(what);
                    }
                    return Ok(());
                }
                let definition = schema.map(|(_, _, text)| text.as_slice()).unwrap_or_default();
                let decoder = Decoder::new(name, definition).map_err(|reason| Fault {
                    reason: format!("topic `{}`: definition of {name}: {reason}", channel.topic),
                    remedy: "record it again with the definitions of its messages",
                })?;
                let topic = self.topic(channel.topic);
                self.channels.insert(channel.id, (topic, decoder));
            }
            _ => {}
        }
        Ok(())
    }

    /// The place of the topic with this name, which may be new.
    fn topic(&mut self, name: String) -> usize {
        let known = self.topics.iter().position(|topic| topic.name == name);
        known.unwrap_or_else(|| {
            self.topics.push(Topic { name, fields: Vec::new() });
            self.topics.len() - 1
        })
    }

    /// Learns the fields and the times of a message.
    fn learn(&mut self, header: &MessageHeader, data: &[u8]) -> Result<(), Fault> {
        let Some((topic, decoder)) = self.channels.get(&header.channel_id) else { return Ok(()) };
        let Some(topic) = self.topics.get_mut(*topic) else { return Ok(()) };
        let value = decoder.decode(data).map_err(|reason| broken(&topic.name, header, &reason))?;
        for field in message::fields(&value) {
            if !topic.fields.contains(&field) {
                topic.fields.push(field);
            }
        }
        for (clock, zero) in Clock::ALL.into_iter().zip(&mut self.zero) {
            let time = clock.time(header, &value);
            *zero = [*zero, time].into_iter().flatten().min();
        }
        Ok(())
    }

    /// No message can be read.
    fn nothing(&self) -> Fault {
        let reason = match self.left.as_slice() {
            [] => "it holds no message with a number in it".to_owned(),
            left => format!(
                "no topic has messages of ROS 2 (ros2msg, cdr) with numbers; it holds {}",
                super::super::error::listed(left.iter().map(String::as_str))
            ),
        };
        Fault { reason, remedy: "record topics of ROS 2 with `ros2 bag record -s mcap`" }
    }

    /// The times, and the fields of all topics.
    fn places(&self) -> Vec<Place> {
        let clocks = Clock::ALL.into_iter().zip(&self.zero).filter(|(_, zero)| zero.is_some());
        let mut places: Vec<_> = clocks.map(|(clock, _)| Place::Time(clock)).collect();
        for (topic, known) in self.topics.iter().enumerate() {
            let place = |field: &Field| Place::Field { topic, field: field.clone() };
            places.extend(known.fields.iter().map(place));
        }
        places
    }

    /// The recorded time is `time`, so that it is found where none is named.
    fn header(&self, place: &Place) -> Header {
        let header = |name: String, text: String, clock| Header { name, text, unit: None, clock };
        match place {
            Place::Time(Clock::Log) => header("time".to_owned(), "log_time".to_owned(), 0),
            Place::Time(clock) => header(clock.name().to_owned(), clock.name().to_owned(), 0),
            Place::Field { topic, field } => {
                let name = format!("{}.{}", self.name(*topic), field.text);
                header(name.clone(), name, *topic)
            }
        }
    }

    fn name(&self, topic: usize) -> &str {
        self.topics.get(topic).map_or("", |topic| &topic.name)
    }

    fn zero(&self, clock: Clock) -> i64 {
        let place = Clock::ALL.iter().position(|other| *other == clock);
        place.and_then(|place| *self.zero.get(place)?).unwrap_or_default()
    }
}

fn broken(topic: &str, header: &MessageHeader, reason: &str) -> Fault {
    let number = header.sequence;
    Fault {
        reason: format!(
            "the message of `{topic}` with the sequence number {number}, logged at {} ns: {reason}",
            header.log_time
        ),
        remedy: "check that it was recorded with the definition that the file holds",
    }
}

impl Rows for Unread {
    fn read(self: Box<Self>, wanted: &Wanted<'_>) -> Result<Table, ReadError> {
        let refuse = |fault: Fault| fault.refuse(wanted.path());
        let file = File::open(wanted.path())
            .map_err(|source| ReadError::Io { path: wanted.path().to_owned(), source })?;
        let clock = self.clock(wanted);
        let mut series = self.series(wanted);
        let mut file = Hashing::new(BufReader::new(file));
        stream::each_record(&mut file, |record| {
            if let Record::Message { header, data } = record {
                self.collect(&header, &data, clock, &mut series)?;
            }
            Ok(ControlFlow::Continue(()))
        })
        .map_err(refuse)?;
        let source = file.finish(wanted.path())?;
        let mut aligned = series::align(series, wanted.clock, |topic| self.contents.name(topic))
            .map_err(refuse)?;
        let zero = self.contents.zero(clock);
        let mut notes = vec![format!(
            "{}: times are {} from {:.9} s on",
            wanted.path().display(),
            clock.name(),
            zero as f64 * 1e-9
        )];
        let held = aligned.note.take();
        notes.extend(held.map(|note| format!("{}: {note}", wanted.path().display())));
        let mut column = |index: &usize| match self.places.get(*index) {
            Some(Place::Time(other)) => aligned.times(*other, clock, zero),
            _ => aligned.column(*index),
        };
        let columns = wanted.numeric.iter().map(&mut column).collect();
        let mut labels = Labels::default();
        for (value, row) in
            wanted.label.map(|label| column(&label).values).iter().flatten().zip(1..)
        {
            labels.push(&value.to_string(), row, wanted.path())?;
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
        header: &MessageHeader,
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
            return Err(Fault {
                reason: format!("the messages of `{name}` have no {}", clock.name()),
                remedy: "leave out `--time`, so that the time of recording is used",
            });
        };
        series.push(time, &value);
        Ok(())
    }
}
