//! Fields that come up behind the first messages of a topic, from which its columns are known.

use std::collections::{BTreeSet, HashSet};

use re_ros_msg::deserialize::Value;

use super::contents::Contents;
use super::message::fields;

/// Lengths of messages that are looked at, and fields that are kept, at most.
const MOST: usize = 100;

/// Fields of later messages that are no columns.
#[derive(Debug, Default)]
pub(super) struct LaterFields {
    /// Topics, and the lengths of their messages: a message of another one may hold other fields.
    lengths: HashSet<(usize, usize)>,
    /// Topics, and the names of these fields.
    found: BTreeSet<(usize, String)>,
}

impl LaterFields {
    /// Looks at a message of so many bytes, unless one of that length was seen.
    pub(super) fn look_at(
        &mut self,
        contents: &Contents,
        (topic, bytes): (usize, usize),
        message: &Value,
    ) {
        if self.lengths.len() >= MOST || !self.lengths.insert((topic, bytes)) {
            return;
        }
        let new = fields(message).into_iter().filter(|field| !contents.has(topic, &field.text));
        let room = MOST - self.found.len();
        self.found.extend(new.take(room).map(|field| (topic, field.text)));
    }

    /// A note on each topic that has any.
    pub(super) fn notes(&self, contents: &Contents) -> Vec<String> {
        let topics: BTreeSet<usize> = self.found.iter().map(|(topic, _)| *topic).collect();
        let note = |topic: usize| {
            let mut names =
                self.found.iter().filter(|found| found.0 == topic).map(|found| &found.1);
            let first = names.next()?;
            let more = match names.count() {
                0 => String::new(),
                more => format!(" and {more} more"),
            };
            Some(format!(
                "`{}` has `{first}`{more} in later messages alone: columns are what the first \
                 messages of a topic hold; these cannot be read",
                contents.name(topic)
            ))
        };
        topics.into_iter().filter_map(note).collect()
    }
}
