//! What is known of a file before its values are read: topics, their fields, times.

use std::collections::{BTreeMap, HashMap, HashSet};
use std::sync::Arc;

use mcap::records::{Channel, MessageHeader, Record};

use super::fields::each_number;
use super::message::{Decoder, Value};
use super::stream::refused;
use crate::experiment::error::ReadError;
use crate::experiment::memory::Budget;
use crate::experiment::names::listed;
use crate::experiment::table::Header;

/// Messages of a channel that show what it holds: nodes that take turns on one topic name their own
/// joints. Of later ones those are looked at that are of another length, as where a joint is added.
const ENOUGH: u64 = 100;

/// Topics that cannot be read and are listed by name.
const MOST_LEFT: usize = 100;

/// Memory of a decoder per byte of its definition, and of a field per byte of its name, at most.
const DECODER_SIZE: usize = 20;
const FIELD_SIZE: usize = 40;

/// The times that a message bears.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Clock {
    /// When it was recorded.
    Log,
    /// When it was published.
    Publish,
    /// What the message says itself.
    Stamp,
}

impl Clock {
    pub(super) fn name(self) -> &'static str {
        match self {
            Self::Log => "log_time",
            Self::Publish => "publish_time",
            Self::Stamp => "header.stamp",
        }
    }

    /// The time of a message in nanoseconds.
    pub(super) fn time(self, header: &MessageHeader, value: &Value<'_>) -> Option<i64> {
        match self {
            Self::Log => i64::try_from(header.log_time).ok(),
            Self::Publish => i64::try_from(header.publish_time).ok(),
            Self::Stamp => value.stamp(),
        }
    }
}

/// What a header stands for.
#[derive(Clone, Debug)]
pub(super) enum Place {
    Time(Clock),
    /// A number in the messages of a topic, by its name.
    Field(usize, String),
}

/// A topic, and the names of the numbers in its messages in the order in which they came up.
#[derive(Debug)]
struct Topic {
    name: String,
    fields: Vec<String>,
    known: HashSet<String>,
}

impl Topic {
    /// Learns the numbers of a message.
    fn learn(&mut self, message: &Value<'_>, budget: &Budget) -> Result<(), ReadError> {
        each_number(
            message,
            |_| true,
            |name, _| {
                if !self.known.contains(name) {
                    budget.take_values(name.len() + 1, FIELD_SIZE)?;
                    self.known.insert(name.to_owned());
                    self.fields.push(name.to_owned());
                }
                Ok(())
            },
        )
    }
}

#[derive(Debug)]
struct Schema {
    definition: Vec<u8>,
    decoder: Result<Arc<Decoder>, String>,
}

/// A channel that can be read.
#[derive(Debug)]
pub(super) struct Readable {
    pub(super) topic: usize,
    pub(super) decoder: Arc<Decoder>,
    /// Messages that were looked at, and the lengths of all.
    seen: u64,
    lengths: HashSet<usize>,
}

/// What is known of a file.
#[derive(Debug, Default)]
pub(super) struct Topics {
    list: Vec<Topic>,
    by_name: HashMap<String, usize>,
    schemas: HashMap<u16, Schema>,
    pub(super) channels: HashMap<u16, Readable>,
    /// Topics that cannot be read, and why.
    pub(super) left: Vec<String>,
    /// The earliest time by each clock that messages have, in nanoseconds.
    pub(super) zero: BTreeMap<Clock, i64>,
}

impl Topics {
    /// Learns from a record.
    pub(super) fn look_at(&mut self, record: Record<'_>, budget: &Budget) -> Result<(), ReadError> {
        match record {
            Record::Schema { header, data } => {
                // It may be repeated; a file that was appended to may use its number anew.
                let known = self.schemas.get(&header.id);
                if known.is_some_and(|schema| schema.definition == *data) {
                    return Ok(());
                }
                budget.take_values(data.len(), DECODER_SIZE)?;
                let decoder = decoder(&header.name, &header.encoding, &data).map(Arc::new);
                self.schemas.insert(header.id, Schema { definition: data.into_owned(), decoder });
                Ok(())
            }
            Record::Channel(channel) => self.register(channel, budget),
            Record::Message { header, data } => self.learn(&header, &data, budget),
            _ => Ok(()),
        }
    }

    /// Keeps a channel; of one that cannot be read its topic, as another may be all that is asked for.
    fn register(&mut self, channel: Channel, budget: &Budget) -> Result<(), ReadError> {
        if self.channels.contains_key(&channel.id) {
            return Ok(());
        }
        let decoder = match self.schemas.get(&channel.schema_id).map(|schema| &schema.decoder) {
            Some(Ok(decoder)) if channel.message_encoding == "cdr" => Arc::clone(decoder),
            other => {
                let refused = other.and_then(|decoder| decoder.as_ref().err());
                let reason = refused.unwrap_or(&channel.message_encoding);
                leave(&mut self.left, format!("{} ({reason})", channel.topic));
                return Ok(());
            }
        };
        budget.take_values(channel.topic.len() + 1, FIELD_SIZE)?;
        let topic = *self.by_name.entry(channel.topic.clone()).or_insert_with(|| {
            let (fields, known) = (Vec::new(), HashSet::new());
            self.list.push(Topic { name: channel.topic, fields, known });
            self.list.len() - 1
        });
        let readable = Readable { topic, decoder, seen: 0, lengths: HashSet::new() };
        self.channels.insert(channel.id, readable);
        Ok(())
    }

    /// Learns the fields and the times of a message.
    fn learn(
        &mut self,
        header: &MessageHeader,
        data: &[u8],
        budget: &Budget,
    ) -> Result<(), ReadError> {
        let zero = &mut self.zero;
        let mut note = |clock, time: Option<i64>| {
            if let Some(time) = time {
                zero.entry(clock).and_modify(|zero| *zero = time.min(*zero)).or_insert(time);
            }
        };
        note(Clock::Log, i64::try_from(header.log_time).ok());
        let Some(channel) = self.channels.get_mut(&header.channel_id) else { return Ok(()) };
        let Some(topic) = self.list.get_mut(channel.topic) else { return Ok(()) };
        channel.seen += 1;
        if !channel.lengths.insert(data.len()) && channel.seen > ENOUGH {
            return Ok(());
        }
        let value = match channel.decoder.decode(data) {
            Ok(value) => value,
            // It is refused where it is asked for.
            Err(reason) => {
                leave(&mut self.left, format!("{} (a message of it: {reason})", topic.name));
                return Ok(());
            }
        };
        for clock in [Clock::Log, Clock::Publish, Clock::Stamp] {
            note(clock, clock.time(header, &value));
        }
        topic.learn(&value, budget)
    }

    /// Refuses a file in which no message can be read.
    pub(super) fn check(&self) -> Result<(), ReadError> {
        if self.list.iter().any(|topic| !topic.fields.is_empty()) {
            return Ok(());
        }
        let reason = match self.left.as_slice() {
            [] => "it holds no message with a number in it".to_owned(),
            left => format!(
                "no topic has messages of ROS 2 (ros2msg, cdr) with numbers that can be read; it holds {}",
                listed(left.iter().map(String::as_str))
            ),
        };
        Err(refused(reason, "record topics of ROS 2 with `ros2 bag record -s mcap`"))
    }

    /// The times, and the fields of all topics.
    pub(super) fn places(&self) -> Vec<Place> {
        let mut places: Vec<Place> = self.zero.keys().copied().map(Place::Time).collect();
        for (number, topic) in self.list.iter().enumerate() {
            places.extend(topic.fields.iter().map(|field| Place::Field(number, field.clone())));
        }
        places
    }

    /// The recorded time is `time`, so that it is found where none is named.
    pub(super) fn header(&self, place: &Place) -> Header {
        match place {
            Place::Time(Clock::Log) => {
                Header { text: "log_time".to_owned(), ..Header::plain("time", 0) }
            }
            Place::Time(clock) => Header::plain(clock.name(), 0),
            Place::Field(topic, field) => {
                Header::plain(&format!("{}.{field}", self.name(*topic)), *topic)
            }
        }
    }

    pub(super) fn name(&self, topic: usize) -> &str {
        self.list.get(topic).map_or("", |topic| &topic.name)
    }
}

/// The decoder of a schema, or why there is none.
fn decoder(name: &str, encoding: &str, definition: &[u8]) -> Result<Decoder, String> {
    if encoding != "ros2msg" {
        return Err(format!("{encoding} {name}"));
    }
    Decoder::new(name, definition).map_err(|reason| format!("definition of {name}: {reason}"))
}

/// Notes a topic, or a message of it, that cannot be read, and why.
fn leave(left: &mut Vec<String>, what: String) {
    if left.len() < MOST_LEFT && !left.contains(&what) {
        left.push(what);
    }
}
