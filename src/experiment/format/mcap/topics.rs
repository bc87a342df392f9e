//! The topics of a file: their fields, and the times and numbers of their messages.

use std::collections::HashMap;
use std::sync::Arc;

use super::fields::each_number;
use super::message::Decoder;
use super::stream::{CHANNEL, Fields, MESSAGE, SCHEMA, refused};
use crate::experiment::error::ReadError;
use crate::experiment::memory::{Budget, NUMBER_SIZE};
use crate::experiment::names::listed;
use crate::experiment::table::Header;

/// Topics that cannot be read and are listed by name.
const MOST_LEFT: usize = 100;

/// Memory of a decoder per byte of its definition, and of a field per byte of its name, at most.
const DECODER_SIZE: usize = 20;
const FIELD_SIZE: usize = 40;

/// The times that a message bears.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Clock {
    /// When it was recorded.
    Log,
    /// When it was published.
    Publish,
    /// What the message says itself.
    Stamp,
}

impl Clock {
    const ALL: [Self; 3] = [Self::Log, Self::Publish, Self::Stamp];

    pub(super) fn name(self) -> &'static str {
        match self {
            Self::Log => "log_time",
            Self::Publish => "publish_time",
            Self::Stamp => "header.stamp",
        }
    }
}

/// Times in nanoseconds by each [`Clock`], where it is known.
pub(super) type Times = [Option<i64>; 3];

/// What a header stands for.
#[derive(Clone, Copy, Debug)]
pub(super) enum Place {
    Time(Clock),
    /// A topic and one of its fields, by their numbers.
    Field(usize, usize),
}

/// A topic: its messages, in the order of the file, and their numbers in the order in which names came up.
#[derive(Debug, Default)]
pub(super) struct Topic {
    pub(super) name: String,
    pub(super) fields: Vec<Field>,
    by_name: HashMap<String, usize>,
    /// Of each message its number in the file, and its times.
    pub(super) messages: Vec<(usize, Times)>,
    /// What is wrong with the first message that cannot be decoded.
    pub(super) fault: Option<String>,
}

/// A number in the messages of a topic.
#[derive(Debug)]
pub(super) struct Field {
    name: String,
    /// The messages that have it, by their numbers in the topic.
    pub(super) values: Vec<(usize, f64)>,
}

#[derive(Debug)]
struct Schema {
    definition: Vec<u8>,
    decoder: Result<Arc<Decoder>, String>,
}

/// What a file holds.
#[derive(Debug, Default)]
pub(super) struct Topics {
    pub(super) list: Vec<Topic>,
    by_name: HashMap<String, usize>,
    schemas: HashMap<u16, Schema>,
    /// The topic of each channel that can be read.
    channels: HashMap<u16, (usize, Arc<Decoder>)>,
    /// Topics that cannot be read, and why.
    pub(super) left: Vec<String>,
    /// The earliest time by each clock.
    pub(super) zero: Times,
    /// Messages so far.
    count: usize,
}

impl Topics {
    /// Takes the fields of a record, where it is one that is of use.
    pub(super) fn take(
        &mut self,
        opcode: u8,
        mut fields: Fields<'_>,
        budget: &Budget,
    ) -> Result<(), ReadError> {
        match opcode {
            SCHEMA => {
                let id = u16::from_le_bytes(fields.bytes()?);
                let (name, encoding, definition) =
                    (fields.text()?, fields.text()?, fields.block()?);
                // It may be repeated; a file that was appended to may use its number anew.
                if self.schemas.get(&id).is_none_or(|known| known.definition != definition) {
                    budget.take_values(definition.len(), DECODER_SIZE)?;
                    let decoder = decoder(name, encoding, definition).map(Arc::new);
                    self.schemas.insert(id, Schema { definition: definition.to_vec(), decoder });
                }
                Ok(())
            }
            CHANNEL => {
                let [id, schema] = [fields.bytes()?, fields.bytes()?].map(u16::from_le_bytes);
                let (topic, encoding) = (fields.text()?, fields.text()?);
                if self.channels.contains_key(&id) {
                    return Ok(());
                }
                match self.schemas.get(&schema).map(|schema| &schema.decoder) {
                    Some(Ok(decoder)) if encoding == "cdr" => {
                        let decoder = Arc::clone(decoder);
                        budget.take_values(topic.len() + 1, FIELD_SIZE)?;
                        let topic = self.number_of(topic);
                        self.channels.insert(id, (topic, decoder));
                    }
                    // Another topic may be all that is asked for.
                    other => {
                        let reason = other.and_then(|decoder| decoder.as_ref().err());
                        let reason = reason.map_or(encoding, String::as_str);
                        self.leave(format!("{topic} ({reason})"));
                    }
                }
                Ok(())
            }
            MESSAGE => self.learn(fields, budget),
            _ => Ok(()),
        }
    }

    fn number_of(&mut self, topic: &str) -> usize {
        *self.by_name.entry(topic.to_owned()).or_insert_with(|| {
            self.list.push(Topic { name: topic.to_owned(), ..Topic::default() });
            self.list.len() - 1
        })
    }

    /// Notes a topic that cannot be read, or has a message that cannot, and why.
    fn leave(&mut self, what: String) {
        if self.left.len() < MOST_LEFT && !self.left.contains(&what) {
            self.left.push(what);
        }
    }

    /// Takes the times and the numbers of a message. One that cannot be decoded is refused where its topic is
    /// asked for.
    fn learn(&mut self, mut fields: Fields<'_>, budget: &Budget) -> Result<(), ReadError> {
        let channel = u16::from_le_bytes(fields.bytes()?);
        let number = u32::from_le_bytes(fields.bytes()?);
        let times = [fields.bytes()?, fields.bytes()?].map(u64::from_le_bytes);
        let [log, publish] = times.map(|time| i64::try_from(time).ok());
        let Some((topic, decoder)) = self.channels.get(&channel) else { return Ok(()) };
        let Some(topic) = self.list.get_mut(*topic) else { return Ok(()) };
        let value = match decoder.decode(fields.0) {
            Ok(value) => value,
            Err(reason) => {
                let [time, _] = times;
                topic.fault.get_or_insert_with(|| {
                    format!("with the sequence number {number}, logged at {time} ns: {reason}")
                });
                let what = format!("{} (a message of it: {reason})", topic.name);
                self.leave(what);
                return Ok(());
            }
        };
        let times = [log, publish, value.stamp()];
        for (zero, time) in self.zero.iter_mut().zip(times) {
            *zero = [*zero, time].into_iter().flatten().min();
        }
        budget.take_values(2, size_of::<(usize, Times)>())?;
        topic.messages.push((self.count, times));
        self.count += 1;
        each_number(&value, &mut |name, number| topic.take(name, number, budget))
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
        let clocks = Clock::ALL.into_iter().filter(|clock| self.zero[*clock as usize].is_some());
        let mut places: Vec<Place> = clocks.map(Place::Time).collect();
        for (number, topic) in self.list.iter().enumerate() {
            places.extend((0..topic.fields.len()).map(|field| Place::Field(number, field)));
        }
        places
    }

    /// The recorded time is `time`, so that it is found where none is named.
    pub(super) fn header(&self, place: Place) -> Header {
        match place {
            Place::Time(Clock::Log) => {
                Header { text: "log_time".to_owned(), ..Header::plain("time", 0) }
            }
            Place::Time(clock) => Header::plain(clock.name(), 0),
            Place::Field(number, field) => {
                let topic = &self.list[number];
                Header::plain(&format!("{}.{}", topic.name, topic.fields[field].name), number)
            }
        }
    }

    pub(super) fn name(&self, topic: usize) -> &str {
        self.list.get(topic).map_or("", |topic| &topic.name)
    }
}

impl Topic {
    /// Takes a number of the latest message; of two of one name the first.
    fn take(&mut self, name: &str, number: f64, budget: &Budget) -> Result<(), ReadError> {
        let message = self.messages.len() - 1;
        if !self.by_name.contains_key(name) {
            budget.take_values(name.len() + 1, FIELD_SIZE)?;
            self.by_name.insert(name.to_owned(), self.fields.len());
            self.fields.push(Field { name: name.to_owned(), values: Vec::new() });
        }
        let values = &mut self.fields[self.by_name[name]].values;
        if values.last().is_none_or(|(last, _)| *last != message) {
            budget.take_values(2, NUMBER_SIZE)?;
            values.push((message, number));
        }
        Ok(())
    }
}

/// The decoder of a schema, or why there is none.
fn decoder(name: &str, encoding: &str, definition: &[u8]) -> Result<Decoder, String> {
    if encoding != "ros2msg" {
        return Err(format!("{encoding} {name}"));
    }
    Decoder::new(name, definition).map_err(|reason| format!("definition of {name}: {reason}"))
}
