//! What each topic said.

use std::ops::Range;

use re_ros_msg::deserialize::Value;

use super::message::Field;
use super::pauses::{Missing, missing};
use super::restarts::{BACK, interval, run_starts, runs};
use crate::experiment::memory::{Budget, TooLarge};
use crate::numerics::median;

/// Memory of a number: itself, a copy, and what its vector has to spare.
pub(super) const NUMBER_SIZE: usize = 3 * size_of::<f64>();

/// The times and values of the messages of one topic.
#[derive(Debug)]
pub(super) struct Series {
    pub(super) topic: usize,
    /// Nanoseconds.
    pub(super) times: Vec<i64>,
    pub(super) columns: Vec<Collected>,
    /// Messages that have none of the values.
    pub(super) empty: usize,
    /// How long before their recording the messages are timed, at least, nanoseconds.
    pub(super) least_lag: Option<i64>,
    /// Where each message stands among all in the file.
    pub(super) places: Vec<u32>,
}

/// The values of a field of the messages.
#[derive(Debug)]
pub(super) struct Collected {
    /// The header it is for.
    pub(super) header: usize,
    field: Field,
    /// NaN where a message does not have it.
    pub(super) values: Vec<f64>,
}

impl Collected {
    fn part(&self, run: Range<usize>) -> Self {
        let (field, values) = (self.field.clone(), self.values[run].to_vec());
        Self { header: self.header, field, values }
    }
}

impl Series {
    pub(super) fn of(topic: usize, header: usize, field: &Field) -> Self {
        let (times, columns, places) = (Vec::new(), Vec::new(), Vec::new());
        let mut series = Self { topic, times, columns, empty: 0, least_lag: None, places };
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
    pub(super) fn run_starts(&self, clock: &ClockMessages) -> Vec<usize> {
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
        let later = clock.starts.iter().skip(1).map(begin).scan(0, |latest, begin| {
            *latest = begin.max(*latest);
            Some(*latest)
        });
        std::iter::once(0).chain(later).collect()
    }

    /// Its messages in runs that begin so.
    pub(super) fn in_runs(self, starts: &[usize]) -> Vec<Self> {
        let part = |(number, run): (usize, Range<usize>)| Self {
            topic: self.topic,
            times: self.times[run.clone()].to_vec(),
            columns: self.columns.iter().map(|column| column.part(run.clone())).collect(),
            empty: if number == 0 { self.empty } else { 0 },
            least_lag: self.least_lag,
            places: self.places[run].to_vec(),
        };
        if starts.len() == 1 {
            return vec![self];
        }
        runs(starts, self.times.len()).into_iter().enumerate().map(part).collect()
    }

    /// What is missing from it up to the `end` of the record, once its messages are in order.
    pub(super) fn missing(&self, end: i64) -> Missing {
        /// Messages to one without the values, at least (chosen).
        const SELDOM: usize = 10;
        let rows = 0..self.times.len();
        let lacks = |row: &usize| self.columns.iter().any(|column| column.values[*row].is_nan());
        // More are the messages of another node, which says nothing of these joints.
        let empty = if SELDOM * self.empty < self.times.len() { self.empty } else { 0 };
        missing(&self.times, end, empty + rows.filter(lacks).count())
    }

    /// Puts the messages in the order of their times: files need not have them so.
    pub(super) fn sort(&mut self) {
        if self.times.is_sorted() {
            return;
        }
        let mut order: Vec<usize> = (0..self.times.len()).collect();
        order.sort_by_key(|index| self.times.get(*index));
        for column in &mut self.columns {
            let value = |index: &usize| column.values.get(*index).copied();
            column.values = order.iter().filter_map(value).collect();
        }
        self.places = order.iter().filter_map(|index| self.places.get(*index).copied()).collect();
        self.times.sort_unstable();
    }
}

/// The messages of the topic that gives the times, in the order of the file.
pub(super) struct ClockMessages {
    places: Vec<u32>,
    times: Vec<i64>,
    /// Where its runs begin.
    pub(super) starts: Vec<usize>,
    /// The usual interval, nanoseconds.
    interval: f64,
}

impl ClockMessages {
    pub(super) fn of(series: &Series) -> Self {
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
