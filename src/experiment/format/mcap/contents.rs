//! What is known of a file before its messages are read: topics, their fields, times.

use std::collections::hash_map::Entry;
use std::collections::{HashMap, HashSet};
use std::ops::ControlFlow;
use std::sync::Arc;

use mcap::records::{MessageHeader, Record};

use super::clock::Clock;
use super::fault::Fault;
use super::message::{self, Decoder, Field};
use super::stream::Summary;
use crate::experiment::memory::Budget;
use crate::experiment::names::listed;
use crate::experiment::table::Header;

/// A topic, what its messages hold, and how many of them were looked at.
#[derive(Debug)]
pub(super) struct Topic {
    pub(super) name: String,
    pub(super) fields: Vec<Field>,
    /// The names of these fields.
    known: HashSet<String>,
}

/// Topics that cannot be read and are listed by name.
const MOST_LEFT: usize = 100;

/// Memory of a decoder per byte of its definition, and of a field per byte of its name, at most.
const DECODER_SIZE: usize = 20;
const FIELD_SIZE: usize = 40;

/// What a header stands for.
#[derive(Clone, Debug)]
pub(super) enum Place {
    Time(Clock),
    Field { topic: usize, field: Field },
}

/// What is known of a file before its messages are read.
#[derive(Debug, Default)]
pub(super) struct Contents {
    pub(super) topics: Vec<Topic>,
    /// Places of the topics by their names.
    pub(super) by_name: HashMap<String, usize>,
    /// Topic and decoder of each channel that can be read.
    pub(super) channels: HashMap<u16, (usize, Arc<Decoder>)>,
    /// The decoders of schemas, or why there is none.
    pub(super) decoders: HashMap<u16, Result<Arc<Decoder>, String>>,
    pub(super) schemas: HashMap<u16, (String, String, Vec<u8>)>,
    /// Topics that cannot be read, and why.
    pub(super) left: Vec<String>,
    /// The earliest time by each clock.
    pub(super) zero: [Option<i64>; 3],
    /// Messages that were looked at, by channel.
    pub(super) seen: HashMap<u16, u64>,
    /// Channels of which enough was seen, where the file says how many messages it has.
    pub(super) known: usize,
}

impl Contents {
    /// Learns from a record; ends when each topic is known, where the file says how many
    /// messages it has.
    pub(super) fn look_at(
        &mut self,
        record: Record<'_>,
        summary: Option<&Summary>,
        budget: &Budget,
    ) -> Result<ControlFlow<()>, Fault> {
        /// Messages of a channel that show what it holds. Nodes that take turns on one topic
        /// name their own joints.
        const ENOUGH: u64 = 100;
        if summary.is_some_and(|summary| self.known >= summary.counts.len()) {
            return Ok(ControlFlow::Break(()));
        }
        if let Record::Message { header, data } = record {
            let seen = self.seen.entry(header.channel_id).or_default();
            *seen += 1;
            let count = summary.and_then(|summary| summary.counts.get(&header.channel_id));
            self.known += usize::from(count.is_some_and(|count| *seen == ENOUGH.min(*count)));
            if *seen <= ENOUGH {
                self.learn(&header, &data, budget)?;
            }
        } else {
            self.register(record, budget)?;
        }
        Ok(ControlFlow::Continue(()))
    }

    /// Keeps definitions and channels.
    pub(super) fn register(&mut self, record: Record<'_>, budget: &Budget) -> Result<(), Fault> {
        match record {
            Record::Schema { header, data } => {
                budget.take(data.len() as u64)?;
                let schema = (header.name, header.encoding, data.into_owned());
                let before = self.schemas.insert(header.id, schema);
                // A file that was appended to may use a number anew.
                if before.as_ref() != self.schemas.get(&header.id) {
                    self.decoders.remove(&header.id);
                }
            }
            Record::Channel(channel) if !self.channels.contains_key(&channel.id) => {
                let schema = self.schemas.get(&channel.schema_id);
                let (name, encoding) = schema.map_or(("", ""), |(name, e, _)| (name, e));
                if (encoding, channel.message_encoding.as_str()) != ("ros2msg", "cdr") {
                    self.leave(format!("{} ({} {name})", channel.topic, channel.message_encoding));
                    return Ok(());
                }
                let definition = schema.map(|(_, _, text)| text.as_slice()).unwrap_or_default();
                let decoder = match self.decoders.entry(channel.schema_id) {
                    Entry::Occupied(known) => known.into_mut(),
                    Entry::Vacant(new) => {
                        budget.take_values(definition.len(), DECODER_SIZE)?;
                        new.insert(Decoder::new(name, definition).map(Arc::new))
                    }
                };
                match decoder {
                    Ok(decoder) => {
                        let decoder = Arc::clone(decoder);
                        budget.take_values(channel.topic.len() + 1, FIELD_SIZE)?;
                        let topic = self.topic(channel.topic);
                        self.channels.insert(channel.id, (topic, decoder));
                    }
                    // Another topic may be all that is asked for.
                    Err(reason) => {
                        let topic = &channel.topic;
                        let what = format!("{topic} (definition of {name}: {reason})");
                        self.leave(what);
                    }
                }
            }
            _ => {}
        }
        Ok(())
    }

    /// Notes a topic, or a message of it, that cannot be read, and why.
    fn leave(&mut self, what: String) {
        if self.left.len() < MOST_LEFT && !self.left.contains(&what) {
            self.left.push(what);
        }
    }

    /// The place of the topic with this name, which may be new.
    pub(super) fn topic(&mut self, name: String) -> usize {
        *self.by_name.entry(name.clone()).or_insert_with(|| {
            self.topics.push(Topic { name, fields: Vec::new(), known: HashSet::new() });
            self.topics.len() - 1
        })
    }

    /// Learns the fields and the times of a message.
    pub(super) fn learn(
        &mut self,
        header: &MessageHeader,
        data: &[u8],
        budget: &Budget,
    ) -> Result<(), Fault> {
        let Some((topic, decoder)) = self.channels.get(&header.channel_id) else { return Ok(()) };
        let Some(topic) = self.topics.get_mut(*topic) else { return Ok(()) };
        let value = match decoder.decode(data) {
            Ok(value) => value,
            // It is refused where it is asked for.
            Err(reason) => {
                let what = format!("{} (a message of it: {reason})", topic.name);
                self.leave(what);
                return Ok(());
            }
        };
        for field in message::fields(&value) {
            if topic.known.insert(field.text.clone()) {
                budget.take_values(field.text.len() + 1, FIELD_SIZE)?;
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
    pub(super) fn nothing(&self) -> Fault {
        let reason = match self.left.as_slice() {
            [] => "it holds no message with a number in it".to_owned(),
            left => format!(
                "no topic has messages of ROS 2 (ros2msg, cdr) with numbers that can be read; it holds {}",
                listed(left.iter().map(String::as_str))
            ),
        };
        Fault::new(reason, "record topics of ROS 2 with `ros2 bag record -s mcap`")
    }

    /// The times, and the fields of all topics.
    pub(super) fn places(&self) -> Vec<Place> {
        let clocks = Clock::ALL.into_iter().zip(&self.zero).filter(|(_, zero)| zero.is_some());
        let mut places: Vec<_> = clocks.map(|(clock, _)| Place::Time(clock)).collect();
        for (topic, known) in self.topics.iter().enumerate() {
            let place = |field: &Field| Place::Field { topic, field: field.clone() };
            places.extend(known.fields.iter().map(place));
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
            Place::Field { topic, field } => {
                Header::plain(&format!("{}.{}", self.name(*topic), field.text), *topic)
            }
        }
    }

    /// Whether a topic has the field of this name.
    pub(super) fn has(&self, topic: usize, field: &str) -> bool {
        self.topics.get(topic).is_some_and(|topic| topic.known.contains(field))
    }

    pub(super) fn name(&self, topic: usize) -> &str {
        self.topics.get(topic).map_or("", |topic| &topic.name)
    }

    pub(super) fn zero(&self, clock: Clock) -> i64 {
        let place = Clock::ALL.iter().position(|other| *other == clock);
        place.and_then(|place| *self.zero.get(place)?).unwrap_or_default()
    }
}

pub(super) fn broken(topic: &str, header: &MessageHeader, reason: &str) -> Fault {
    let number = header.sequence;
    let reason = format!(
        "the message of `{topic}` with the sequence number {number}, logged at {} ns: {reason}",
        header.log_time
    );
    Fault::new(reason, "check that it was recorded with the definition that the file holds")
}
