//! What each topic said, and all of it at the times of one.

use std::collections::BTreeMap;
use std::ops::Range;

use re_ros_msg::deserialize::Value;

use super::clock::Clock;
use super::fault::Fault;
use super::message::Field;
use super::pauses::{Missing, missing};
use super::restarts::{BACK, interval, run_starts, runs};
use crate::experiment::memory::{Budget, TooLarge};
use crate::experiment::names::listed;
use crate::experiment::table::Column;
use crate::numerics::median;

/// Memory of a number: itself, a copy, and what its vector has to spare.
const NUMBER_SIZE: usize = 3 * size_of::<f64>();

/// The times and values of the messages of one topic.
#[derive(Debug)]
pub(super) struct Series {
    pub(super) topic: usize,
    /// Nanoseconds.
    times: Vec<i64>,
    columns: Vec<Collected>,
    /// Messages that have none of the values.
    empty: usize,
    /// Where each message stands among all in the file.
    places: Vec<u32>,
}

#[derive(Debug)]
struct Collected {
    /// The header it is for.
    header: usize,
    field: Field,
    /// NaN where a message does not have it.
    values: Vec<f64>,
}

impl Collected {
    fn part(&self, run: Range<usize>) -> Self {
        let (field, values) = (self.field.clone(), self.values[run].to_vec());
        Self { header: self.header, field, values }
    }
}

impl Series {
    pub(super) fn of(topic: usize, header: usize, field: &Field) -> Self {
        let mut series =
            Self { topic, times: Vec::new(), columns: Vec::new(), empty: 0, places: Vec::new() };
        series.add(header, field);
        series
    }

    pub(super) fn add(&mut self, header: usize, field: &Field) {
        let (field, values) = (field.clone(), Vec::new());
        self.columns.push(Collected { header, field, values });
    }

    /// Takes the numbers of a message, if it has any of those that are wanted.
    pub(super) fn push(
        &mut self,
        (time, place): (i64, u32),
        message: &Value,
        budget: &Budget,
    ) -> Result<(), TooLarge> {
        let numbers = self.columns.iter().map(|column| column.field.number(message));
        if numbers.clone().all(|number| number.is_none()) {
            self.empty += 1;
            return Ok(());
        }
        budget.take_values(self.columns.len() + 1, NUMBER_SIZE)?;
        let numbers: Vec<f64> = numbers.map(|number| number.unwrap_or(f64::NAN)).collect();
        for (column, number) in self.columns.iter_mut().zip(numbers) {
            column.values.push(number);
        }
        self.times.push(time);
        self.places.push(place);
        Ok(())
    }

    /// Where its runs begin, given those of the `clock`.
    ///
    /// What is sent at changes alone does not show by itself where its clock starts anew: its runs
    /// begin where those of the clock do in the file, and with the messages before it that are behind
    /// the clock already.
    fn run_starts(&self, clock: &Clocked) -> Vec<usize> {
        let own = if clock.starts.len() > 1 { run_starts(&self.times) } else { vec![0] };
        if own.len() == clock.starts.len() {
            return own;
        }
        let behind: Vec<f64> = self
            .places
            .iter()
            .zip(&self.times)
            .map(|(place, time)| clock.behind(*place, *time))
            .collect();
        let usual = median(&behind).unwrap_or_default();
        let begin = |start: &usize| {
            let place = clock.places.get(*start);
            let begin = self.places.partition_point(|own| Some(own) < place);
            let early = behind.iter().take(begin).rev();
            begin - early.take_while(|behind| **behind > usual + BACK).count()
        };
        std::iter::once(0).chain(clock.starts.iter().skip(1).map(begin)).collect()
    }

    /// Its messages in runs that begin so.
    fn in_runs(self, starts: &[usize]) -> Vec<Self> {
        let part = |(number, run): (usize, Range<usize>)| Self {
            topic: self.topic,
            times: self.times[run.clone()].to_vec(),
            columns: self.columns.iter().map(|column| column.part(run.clone())).collect(),
            empty: if number == 0 { self.empty } else { 0 },
            places: self.places[run].to_vec(),
        };
        if starts.len() == 1 {
            return vec![self];
        }
        runs(starts, self.times.len()).into_iter().enumerate().map(part).collect()
    }

    /// What is missing from it up to the `end` of the record, once its messages are in order.
    fn missing(&self, end: i64) -> Missing {
        /// Messages to one without the values, at least (chosen).
        const SELDOM: usize = 10;
        let rows = 0..self.times.len();
        let lacks = |row: &usize| self.columns.iter().any(|column| column.values[*row].is_nan());
        // More are the messages of another node, which says nothing of these joints.
        let empty = if SELDOM * self.empty < self.times.len() { self.empty } else { 0 };
        missing(&self.times, end, empty + rows.filter(lacks).count())
    }

    /// Puts the messages in the order of their times: files need not have them so.
    fn sort(&mut self) {
        if self.times.is_sorted() {
            return;
        }
        let mut order: Vec<usize> = (0..self.times.len()).collect();
        order.sort_by_key(|index| self.times.get(*index));
        for column in &mut self.columns {
            let value = |index: &usize| column.values.get(*index).copied();
            column.values = order.iter().filter_map(value).collect();
        }
        self.times.sort_unstable();
    }
}

/// The messages of the topic that gives the times, in the order of the file.
struct Clocked {
    places: Vec<u32>,
    times: Vec<i64>,
    /// Where its runs begin.
    starts: Vec<usize>,
    /// The usual interval, nanoseconds.
    interval: f64,
}

impl Clocked {
    fn of(series: &Series) -> Self {
        let starts = run_starts(&series.times);
        let is_one = starts.len() == 1;
        // Where it does not start anew, nothing more is asked.
        let (places, times) = if is_one {
            (Vec::new(), Vec::new())
        } else {
            (series.places.clone(), series.times.clone())
        };
        let interval = interval(&times).unwrap_or(1.0);
        Self { places, times, starts, interval }
    }

    /// How many intervals a message at this `place` with this `time` is behind the last one before.
    fn behind(&self, place: u32, time: i64) -> f64 {
        let before = self.places.partition_point(|own| *own < place).checked_sub(1);
        let last = before.and_then(|before| self.times.get(before));
        last.map_or(0.0, |last| last.saturating_sub(time) as f64 / self.interval)
    }
}

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
    let clock = Clocked::of(clock);
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
