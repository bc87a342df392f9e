//! All that topics said, at the times of one.

use std::collections::BTreeMap;

use super::clock::Clock;
use super::fault::Fault;
use super::series::{ClockMessages, Series};
use crate::experiment::names::listed;
use crate::experiment::table::Column;

/// Columns with a value for each message of one topic.
#[derive(Default)]
pub(super) struct Aligned {
    /// Nanoseconds.
    times: Vec<i64>,
    /// By the header of each.
    columns: BTreeMap<usize, Vec<f64>>,
    /// What was held, and what is missing from it.
    pub(super) notes: Vec<String>,
}

/// All series at the times of the one of `topic`: each is held from its latest message.
/// What comes before the first message of any of them is left out. Where the clock starts anew, each
/// run is aligned by itself.
pub(super) fn align<'a>(
    series: Vec<Series>,
    topic: usize,
    name: impl Fn(usize) -> &'a str,
) -> Result<Aligned, Fault> {
    let Some(clock) = series.iter().find(|series| series.topic == topic) else {
        return Ok(Aligned::default());
    };
    let clock = ClockMessages::of(clock);
    let mut of_runs: Vec<Vec<Series>> = clock.starts.iter().map(|_| Vec::new()).collect();
    for series in series {
        let starts = series.run_starts(&clock);
        for (run, part) in of_runs.iter_mut().zip(series.in_runs(&starts)) {
            run.push(part);
        }
    }
    let (mut aligned, mut failed) = (Aligned::default(), Vec::new());
    for series in of_runs {
        match align_run(series, topic, &name) {
            Ok(run) => aligned.append(run),
            Err(fault) => failed.push(fault),
        }
    }
    let left_out = failed.len();
    if let Some(fault) = failed.into_iter().next().filter(|_| aligned.times.is_empty()) {
        return Err(fault);
    }
    aligned.notes.extend((left_out > 0).then(|| {
        format!("its clock starts anew, and {left_out} runs without a message of each topic are left out")
    }));
    Ok(aligned)
}

/// [`align`] of a run in which the clock does not start anew.
fn align_run<'a>(
    mut series: Vec<Series>,
    topic: usize,
    name: &impl Fn(usize) -> &'a str,
) -> Result<Aligned, Fault> {
    series.iter_mut().for_each(Series::sort);
    let Some(place) = series.iter().position(|series| series.topic == topic) else {
        return Ok(Aligned::default());
    };
    let clock = series.swap_remove(place);
    let own = clock.columns.into_iter().map(|column| (column.header, column.values));
    let mut columns: Vec<_> = own.collect();
    let mut start = 0;
    let mut others: Vec<&str> = Vec::new();
    let without = (clock.empty > 0).then(|| {
        let all = clock.empty + clock.times.len();
        let name = name(topic);
        format!(
            "{} of {all} messages of `{name}` have none of its values and are left out",
            clock.empty
        )
    });
    let mut notes: Vec<String> = without.into_iter().collect();
    let end = clock.times.last().copied().unwrap_or_default();
    for held in series {
        others.push(name(held.topic));
        notes.extend(held.missing(end).note(name(held.topic)));
        for column in held.columns {
            let values = hold(&held.times, &column.values, &clock.times);
            let first = values.iter().position(|value| !value.is_nan()).unwrap_or(values.len());
            start = start.max(first);
            columns.push((column.header, values));
        }
    }
    let mut times = clock.times;
    if start == times.len() && start > 0 {
        let (topic, others) = (name(topic), listed(others.into_iter()));
        let reason = format!("no message of {topic} comes after the first ones of {others}");
        return Err(Fault::new(reason, "choose topics that were recorded together"));
    }
    times.drain(..start);
    for (_, values) in &mut columns {
        values.drain(..start);
    }
    let columns = columns.into_iter().collect();
    let on_others = (!others.is_empty()).then(|| {
        let (topic, others) = (name(topic), others.join("`, `"));
        let early = match start {
            0 => String::new(),
            1 => ", of which the first comes too early and is left out".to_owned(),
            _ => format!(", of which the first {start} come too early and are left out"),
        };
        format!("`{others}` is held from its latest message at each message of `{topic}`{early}")
    });
    let notes = on_others.into_iter().chain(notes).collect();
    Ok(Aligned { times, columns, notes })
}

/// The latest value at each of `at`; NaN before the first.
fn hold(times: &[i64], values: &[f64], at: &[i64]) -> Vec<f64> {
    let mut messages = times.iter().zip(values).peekable();
    let mut latest = f64::NAN;
    let value = |time: &i64| {
        while let Some((_, value)) = messages.next_if(|(sent, _)| *sent <= time) {
            if !value.is_nan() {
                latest = *value;
            }
        }
        latest
    };
    at.iter().map(value).collect()
}

impl Aligned {
    /// Puts those of a later run behind these.
    fn append(&mut self, later: Self) {
        self.times.extend(later.times);
        for (header, values) in later.columns {
            self.columns.entry(header).or_default().extend(values);
        }
        let new = later.notes.into_iter().filter(|note| !self.notes.contains(note));
        self.notes.extend(new.collect::<Vec<_>>());
    }

    pub(super) fn rows(&self) -> usize {
        self.times.len()
    }

    /// The column of a header, handed over.
    pub(super) fn column(&mut self, header: usize) -> Column {
        Column::of(self.columns.remove(&header).unwrap_or_default())
    }

    /// Seconds from `zero` on, by the clock that the messages were collected by.
    pub(super) fn times(&self, wanted: Clock, clock: Clock, zero: i64) -> Column {
        let seconds = |time: &i64| (time - zero) as f64 / 1e9;
        Column::of(self.times.iter().filter(|_| wanted == clock).map(seconds))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_value_is_held_from_its_message_on() {
        let held = hold(&[10, 20, 20, 30], &[1.0, 2.0, 3.0, f64::NAN], &[5, 10, 19, 20, 40]);
        assert!(held[0].is_nan());
        assert_eq!(held[1..], [1.0, 1.0, 3.0, 3.0]);
    }
}
