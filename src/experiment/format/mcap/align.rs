//! All that topics said, at the times of one.

use std::collections::BTreeMap;

use super::between::Between;
use super::clock::Clock;
use super::fault::Fault;
use super::series::{ClockMessages, NUMBER_SIZE, Series};
use crate::experiment::memory::Budget;
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

/// All series at the times of the one of `topic`, and of some between where that is slow: each is held
/// from its latest message, and so is the column of `labels`.
/// What comes before the first message of all others is left out; what begins later is NaN up to
/// there, so that a joint whose command comes late takes no rows from those beside it. Where the
/// clock starts anew, each run is aligned by itself.
pub(super) fn align<'a>(
    series: Vec<Series>,
    (topic, labels): (usize, Option<usize>),
    budget: &Budget,
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
        match align_run(series, (topic, labels), budget, &name) {
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
    (topic, labels): (usize, Option<usize>),
    budget: &Budget,
    name: &impl Fn(usize) -> &'a str,
) -> Result<Aligned, Fault> {
    series.iter_mut().for_each(Series::sort);
    let Some(place) = series.iter().position(|series| series.topic == topic) else {
        return Ok(Aligned::default());
    };
    let mut clock = series.swap_remove(place);
    let mut notes: Vec<String> = without_values(&clock, name(topic)).into_iter().collect();
    let held: usize = series.iter().map(|series| series.columns.len()).sum();
    if let Some(rows) = Between::of(&clock.times, &series) {
        budget.take_values(rows.times.len().saturating_mul(clock.columns.len()), NUMBER_SIZE)?;
        fill(&mut clock, rows, labels);
    }
    // A topic of one message is held at as many rows as there are.
    budget.take_values(clock.times.len().saturating_mul(held), NUMBER_SIZE)?;
    let own = clock.columns.into_iter().map(|column| (column.header, column.values));
    let mut columns: Vec<_> = own.collect();
    let mut start = clock.times.len();
    let mut others: Vec<&str> = Vec::new();
    let end = clock.times.last().copied().unwrap_or_default();
    for held in series {
        others.push(name(held.topic));
        notes.extend(held.missing(end).note(name(held.topic)));
        for column in held.columns {
            let messages = held.times.iter().copied().zip(held.places.iter().copied());
            let rows = clock.times.iter().copied().zip(clock.places.iter().copied());
            let values = hold(messages.zip(column.values), rows);
            let first = values.iter().position(|value| !value.is_nan()).unwrap_or(values.len());
            start = start.min(first);
            columns.push((column.header, values));
        }
    }
    let mut times = clock.times;
    if others.is_empty() {
        start = 0;
    }
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
        let (topic, count, others) = (name(topic), others.len(), others.join("`, `"));
        let early = match start {
            0 => String::new(),
            1 => ", of which the first comes too early and is left out".to_owned(),
            _ => format!(", of which the first {start} come too early and are left out"),
        };
        let are = if count > 1 { "are held from their" } else { "is held from its" };
        format!("`{others}` {are} latest message at each message of `{topic}`{early}")
    });
    let notes = on_others.into_iter().chain(notes).collect();
    Ok(Aligned { times, columns, notes })
}

/// A line on topics whose messages are timed by clocks that differ, as those of two computers do: by the
/// time from the stamp of a message to its recording, at least.
pub(super) fn clocks_differ<'a>(
    series: &[Series],
    name: impl Fn(usize) -> &'a str,
    clock: &str,
) -> Option<String> {
    /// Nanoseconds that messages may take to their recording.
    const USUAL: i64 = 50_000_000;
    let lags = || series.iter().filter_map(|series| Some((series.least_lag?, series.topic)));
    let ((least, of_least), (most, of_most)) = lags().min().zip(lags().max())?;
    let apart = most.saturating_sub(least);
    (apart > USUAL).then(|| {
        format!(
            "the {clock} of `{}` is {:.3} s behind that of `{}`, by the time of recording: if these are \
             the clocks of two computers, delays are off by that; `--time log_time` has one clock",
            name(of_most),
            apart as f64 * 1e-9,
            name(of_least)
        )
    })
}

/// A line on messages of the topic of the times that have none of its values.
fn without_values(clock: &Series, name: &str) -> Option<String> {
    let all = clock.empty + clock.times.len();
    (clock.empty > 0).then(|| {
        format!(
            "{} of {all} messages of `{name}` have none of its values and are left out",
            clock.empty
        )
    })
}

/// Puts `rows` between the messages of the topic of the times.
fn fill(clock: &mut Series, rows: Between, labels: Option<usize>) {
    for column in &mut clock.columns {
        let is_label = Some(column.header) == labels;
        let at_rows = if is_label { Between::held } else { Between::sparse };
        column.values = at_rows(&rows, &column.values);
    }
    clock.places = rows.in_file(&clock.places);
    clock.times = rows.times;
}

/// The latest value of `messages` at each of `rows`, both by their times and places in the file, which says
/// what came first at one time, as where a clock is coarse; NaN before the first.
fn hold(
    messages: impl Iterator<Item = ((i64, u32), f64)>,
    rows: impl Iterator<Item = (i64, u32)>,
) -> Vec<f64> {
    let mut messages = messages.peekable();
    let mut latest = f64::NAN;
    let value = |row: (i64, u32)| {
        while let Some((_, value)) = messages.next_if(|(sent, _)| *sent <= row) {
            if !value.is_nan() {
                latest = value;
            }
        }
        latest
    };
    rows.map(value).collect()
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
        let messages = [((10, 0), 1.0), ((20, 3), 2.0), ((20, 5), 3.0), ((30, 6), f64::NAN)];
        let rows = [(5, 1), (10, 2), (19, 2), (20, 4), (20, 7), (40, 8)];
        let held = hold(messages.into_iter(), rows.into_iter());
        assert!(held[0].is_nan());
        assert_eq!(held[1..], [1.0, 1.0, 2.0, 3.0, 3.0]);
    }
}
