//! What each topic said, and all of it at the times of one.

use std::collections::HashMap;

use re_ros_msg::deserialize::Value;

use super::clock::Clock;
use super::fault::Fault;
use super::message::Field;
use crate::experiment::memory::{Budget, TooLarge};
use crate::experiment::names::listed;
use crate::experiment::table::Column;

/// Memory of a number: itself, a copy, and what its vector has to spare.
const NUMBER_SIZE: usize = 3 * size_of::<f64>();

/// The times and values of the messages of one topic.
#[derive(Debug)]
pub(super) struct Series {
    pub(super) topic: usize,
    /// Nanoseconds.
    times: Vec<i64>,
    columns: Vec<Collected>,
}

#[derive(Debug)]
struct Collected {
    /// The header it is for.
    header: usize,
    field: Field,
    /// NaN where a message does not have it.
    values: Vec<f64>,
}

impl Series {
    pub(super) fn of(topic: usize, header: usize, field: &Field) -> Self {
        let mut series = Self { topic, times: Vec::new(), columns: Vec::new() };
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
        time: i64,
        message: &Value,
        budget: &Budget,
    ) -> Result<(), TooLarge> {
        let numbers = self.columns.iter().map(|column| column.field.number(message));
        if numbers.clone().all(|number| number.is_none()) {
            return Ok(());
        }
        budget.take_values(self.columns.len() + 1, NUMBER_SIZE)?;
        let numbers: Vec<f64> = numbers.map(|number| number.unwrap_or(f64::NAN)).collect();
        for (column, number) in self.columns.iter_mut().zip(numbers) {
            column.values.push(number);
        }
        self.times.push(time);
        Ok(())
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

/// Columns with a value for each message of one topic.
pub(super) struct Aligned {
    /// Nanoseconds.
    times: Vec<i64>,
    /// By the header of each.
    columns: HashMap<usize, Vec<f64>>,
    /// What was held.
    pub(super) note: Option<String>,
}

/// All series at the times of the one of `topic`: each is held from its latest message.
/// What comes before the first message of any of them is left out.
pub(super) fn align<'a>(
    mut series: Vec<Series>,
    topic: usize,
    name: impl Fn(usize) -> &'a str,
) -> Result<Aligned, Fault> {
    series.iter_mut().for_each(Series::sort);
    let Some(place) = series.iter().position(|series| series.topic == topic) else {
        return Ok(Aligned { times: Vec::new(), columns: HashMap::new(), note: None });
    };
    let clock = series.swap_remove(place);
    let own = clock.columns.into_iter().map(|column| (column.header, column.values));
    let mut columns: Vec<_> = own.collect();
    let mut start = 0;
    let mut others: Vec<&str> = Vec::new();
    for held in series {
        others.push(name(held.topic));
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
    let note = (!others.is_empty()).then(|| {
        let (topic, others) = (name(topic), others.join("`, `"));
        let early = match start {
            0 => String::new(),
            1 => ", of which the first comes too early and is left out".to_owned(),
            _ => format!(", of which the first {start} come too early and are left out"),
        };
        format!("`{others}` is held from its latest message at each message of `{topic}`{early}")
    });
    Ok(Aligned { times, columns, note })
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
