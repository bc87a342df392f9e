//! What is missing from a topic whose last value is held: pauses of one that else sends at one rate, and
//! messages without a value.

use crate::numerics::median;

/// What is missing from a topic.
#[derive(Debug, Default, PartialEq)]
pub(super) struct Missing {
    /// Pauses, and the longest of them in seconds.
    pauses: usize,
    longest_s: f64,
    /// Messages without a value.
    messages: usize,
}

/// Of messages at these `times` in their order, up to the `end` of the record, in nanoseconds, where so
/// many `messages` have no value.
pub(super) fn missing(times: &[i64], end: i64, messages: usize) -> Missing {
    /// Part of the intervals that are as long as usual, and how long they may be, of a topic that sends
    /// at one rate: what is sent at changes alone does not.
    const ALIKE: f64 = 0.9;
    const USUAL: std::ops::RangeInclusive<f64> = 0.3..=2.0;
    /// A pause is longer than this in usual intervals and in seconds, as rows that are lost from a table
    /// and not filled are.
    const LONG: f64 = 5.0;
    const LONG_S: f64 = 0.05;
    let ends = times.iter().skip(1).chain([&end]);
    let seconds = |(from, to): (&i64, &i64)| to.saturating_sub(*from) as f64 * 1e-9;
    let mut intervals: Vec<f64> = times.iter().zip(ends).map(seconds).collect();
    let up_to_end = intervals.pop();
    let usual = median(&intervals).filter(|usual| *usual > 0.0);
    let is_usual =
        |interval: &&f64| usual.is_some_and(|usual| USUAL.contains(&(*interval / usual)));
    let alike = intervals.iter().filter(is_usual).count() as f64;
    let mut missing = Missing { messages, ..Missing::default() };
    let Some(usual) = usual.filter(|_| alike >= ALIKE * intervals.len() as f64) else {
        return missing;
    };
    let limit = (LONG * usual).max(LONG_S);
    for pause in intervals.into_iter().chain(up_to_end).filter(|interval| *interval > limit) {
        missing.pauses += 1;
        missing.longest_s = missing.longest_s.max(pause);
    }
    missing
}

impl Missing {
    /// What a reader should know of a topic of this `name`.
    pub(super) fn note(&self, name: &str) -> Option<String> {
        let times =
            if self.pauses == 1 { "once".to_owned() } else { format!("{} times", self.pauses) };
        let pauses = format!("pauses {times}, for up to {:.2} s", self.longest_s);
        let messages = match self.messages {
            1 => "has 1 message without a value".to_owned(),
            count => format!("has {count} messages without a value"),
        };
        let said = [(self.pauses, pauses), (self.messages, messages)];
        let said: Vec<String> =
            said.into_iter().filter(|(count, _)| *count > 0).map(|(_, said)| said).collect();
        let held = "the last value is held, so that a step in between is seen late or not at all";
        (!said.is_empty()).then(|| format!("`{name}` {}: {held}", said.join(" and ")))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn note(seconds: impl Iterator<Item = f64>, end_s: f64, without: usize) -> Option<String> {
        let nanoseconds = |seconds: f64| format!("{:.0}", seconds * 1e9).parse::<i64>().unwrap();
        let times: Vec<i64> = seconds.map(nanoseconds).collect();
        missing(&times, nanoseconds(end_s), without).note("/valve")
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
        assert_eq!(note([].into_iter(), 1.0, 0), None);
        assert_eq!(note([0.5].into_iter(), 1.0, 0), None);
    }
}
