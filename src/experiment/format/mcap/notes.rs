//! What the reader of a recording should know of its topics.

use std::ops::RangeInclusive;

use super::messages::{Messages, times_of};
use crate::experiment::grid::filled_s;
use crate::numerics::median;

/// What was held at the messages of the topic `clock`, of which so many are too `early` and left out, and what
/// is missing; `name` is that of a topic.
pub(super) fn held<'a>(
    messages: &Messages,
    clock: usize,
    early: usize,
    name: impl Fn(usize) -> &'a str,
) -> Vec<String> {
    let mut notes = Vec::new();
    let (topic, list) = (name(clock), &messages.list);
    let others: Vec<usize> =
        messages.topics.keys().copied().filter(|topic| *topic != clock).collect();
    if !others.is_empty() {
        let early = match early {
            0 => String::new(),
            _ => format!(", of which the first {early} come too early and are left out"),
        };
        let are = if others.len() > 1 { "are held from their" } else { "is held from its" };
        let others = others.iter().map(|topic| name(*topic)).collect::<Vec<_>>().join("`, `");
        notes.push(format!("`{others}` {are} latest message at each message of `{topic}`{early}"));
    }
    let empty = messages.topics.get(&clock).map_or(0, |topic| topic.empty);
    if empty > 0 {
        let all = empty + times_of(list, clock).count();
        notes.push(format!(
            "{empty} of {all} messages of `{topic}` have none of its values and are left out"
        ));
    }
    let end = times_of(list, clock).last().unwrap_or_default();
    notes.extend(others.into_iter().filter_map(|topic| missing(messages, topic, end, name(topic))));
    notes
}

/// A line on what is missing from a topic that is held, up to the `end` of the record: messages without a
/// value, and pauses of one that else sends at one rate.
fn missing(messages: &Messages, topic: usize, end: i64, name: &str) -> Option<String> {
    /// Messages to one without the values, at least (chosen): where many have none, these are the messages of
    /// another node, which says nothing of these joints.
    const SELDOM: usize = 10;
    let of_topic = messages.list.iter().filter(|message| message.topic == topic);
    let lacking = of_topic.filter(|message| message.numbers.iter().any(|n| n.is_nan())).count();
    let times: Vec<i64> = times_of(&messages.list, topic).collect();
    let empty = messages.topics.get(&topic).map_or(0, |topic| topic.empty);
    let lacking = lacking + if SELDOM * empty < times.len() { empty } else { 0 };
    let mut said = Vec::new();
    let (count, longest) = pauses(&times, end);
    if count > 0 {
        let times = if count == 1 { "once".to_owned() } else { format!("{count} times") };
        said.push(format!("pauses {times}, for up to {longest:.2} s"));
    }
    if lacking > 0 {
        said.push(format!("has {lacking} messages without a value"));
    }
    let held = "the last value is held, so a step in such a pause is seen late or not at all";
    (!said.is_empty()).then(|| format!("`{name}` {}: {held}", said.join(" and ")))
}

/// How often a topic with messages at these `times` pauses up to the `end` of the record, and the longest
/// pause in seconds, where it sends at one rate: what is sent at changes alone does not.
fn pauses(times: &[i64], end: i64) -> (usize, f64) {
    /// Part of the intervals that are as long as usual, and how long they may be.
    const ALIKE: f64 = 0.9;
    const USUAL: RangeInclusive<f64> = 0.3..=2.0;
    let seconds = |from: i64, to: i64| to.saturating_sub(from) as f64 * 1e-9;
    let mut intervals: Vec<f64> = times.windows(2).map(|pair| seconds(pair[0], pair[1])).collect();
    let usual = median(&intervals).unwrap_or_default();
    let alike = intervals.iter().filter(|interval| USUAL.contains(&(*interval / usual))).count();
    if usual <= 0.0 || (alike as f64) < ALIKE * intervals.len() as f64 {
        return (0, 0.0);
    }
    intervals.extend(times.last().map(|last| seconds(*last, end)));
    // As rows that are lost from a table and not filled are.
    intervals.retain(|interval| *interval > filled_s(usual));
    (intervals.len(), intervals.into_iter().fold(0.0, f64::max))
}

/// A line on topics whose messages are timed by clocks that differ, as those of two computers do: by the
/// time from the stamp of a message to its recording, at least.
pub(super) fn clocks_differ<'a>(
    messages: &Messages,
    name: impl Fn(usize) -> &'a str,
    clock: &str,
) -> Option<String> {
    /// Nanoseconds that messages may take to their recording.
    const USUAL: i64 = 50_000_000;
    let lags = || messages.topics.iter().filter_map(|(topic, of)| Some((of.least_lag?, *topic)));
    let ((least, of_least), (most, of_most)) = lags().min().zip(lags().max())?;
    let apart = most.saturating_sub(least);
    (apart > USUAL).then(|| {
        format!(
            "compared with the time of recording, the {clock} of `{}` is {:.3} s behind that of \
             `{}`: if these are the clocks of two computers, delays are wrong by this time; \
             `--time log_time` uses one clock for both",
            name(of_most),
            apart as f64 * 1e-9,
            name(of_least)
        )
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::experiment::format::mcap::messages::Message;

    fn note(seconds: impl Iterator<Item = f64>, end_s: f64, without: usize) -> Option<String> {
        let nanoseconds = |seconds: f64| format!("{:.0}", seconds * 1e9).parse::<i64>().unwrap();
        let mut messages = Messages::default();
        messages.want(0, 0, 1);
        let message = |time| Message { place: 0, time, topic: 0, numbers: vec![1.0] };
        messages.list = seconds.map(|s| message(nanoseconds(s))).collect();
        messages.topics.get_mut(&0).unwrap().empty = without;
        missing(&messages, 0, nanoseconds(end_s), "/valve")
    }

    #[test]
    fn pauses_are_those_of_a_topic_that_sends_at_one_rate() {
        let at = |k: i32| 0.01 * f64::from(k) + 0.002 * (1.3 * f64::from(k)).sin();
        assert_eq!(note((0..1000).map(at), 10.0, 0), None);
        let lost = (0..1000).filter(|k| !(300..365).contains(k)).map(at);
        let said = note(lost, 25.0, 0).unwrap();
        assert!(said.starts_with("`/valve` pauses 2 times, for up to 15.0"), "{said}");
        let changes = (1..40).map(|k| 0.1 * f64::from(k).powi(3));
        assert_eq!(note(changes, 9000.0, 0), None, "sent at changes");
        let said = note((0..1000).map(at), 10.0, 65).unwrap();
        assert!(said.starts_with("`/valve` has 65 messages without a value: the last"), "{said}");
        assert_eq!(note((0..1000).map(at), 10.0, 500), None, "those of another node");
        assert_eq!(note([].into_iter(), 1.0, 0), None);
        assert_eq!(note([0.5].into_iter(), 1.0, 0), None);
    }
}
