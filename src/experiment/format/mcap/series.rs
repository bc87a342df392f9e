//! What each topic said: the times and values of its messages.

use std::collections::{HashMap, HashSet};

use super::fields::{each_number, first_field};
use super::message::Value;
use crate::experiment::error::ReadError;
use crate::experiment::memory::Budget;
use crate::numerics::median;

/// Memory of a number: itself, a copy, and what its vector has to spare.
pub(super) const NUMBER_SIZE: usize = 3 * size_of::<f64>();

/// The times and values of the messages of one topic, in the order of the file until they are sorted.
#[derive(Debug, Default)]
pub(super) struct Series {
    pub(super) topic: usize,
    /// Nanoseconds.
    pub(super) times: Vec<i64>,
    /// Where each message stands among all in the file.
    pub(super) places: Vec<u32>,
    pub(super) columns: Vec<Collected>,
    /// Columns by the names of their numbers.
    by_name: HashMap<String, usize>,
    /// The fields of the messages in which these lie.
    fields: HashSet<String>,
    /// Messages that have none of the values.
    pub(super) empty: usize,
    /// How long before their recording the messages are timed, at least, nanoseconds.
    pub(super) least_lag: Option<i64>,
}

/// The values of a number of the messages.
#[derive(Debug)]
pub(super) struct Collected {
    /// The header it is for.
    pub(super) header: usize,
    /// NaN where a message does not have it.
    pub(super) values: Vec<f64>,
}

impl Series {
    pub(super) fn of(topic: usize) -> Self {
        Self { topic, ..Self::default() }
    }

    /// Collects the number of this name, too.
    pub(super) fn add(&mut self, header: usize, name: &str) {
        self.fields.insert(first_field(name).to_owned());
        self.by_name.entry(name.to_owned()).or_insert_with(|| {
            self.columns.push(Collected { header, values: Vec::new() });
            self.columns.len() - 1
        });
    }

    /// Takes the numbers of a message, if it has any of those that are wanted.
    pub(super) fn push(
        &mut self,
        (time, place): (i64, u32),
        message: &Value<'_>,
        budget: &Budget,
    ) -> Result<(), ReadError> {
        let mut numbers = vec![None; self.columns.len()];
        each_number(
            message,
            |field| self.fields.contains(field),
            |name, number| {
                let column = self.by_name.get(name).and_then(|column| numbers.get_mut(*column));
                column.map(|column| column.get_or_insert(number));
                Ok(())
            },
        )?;
        if numbers.iter().all(Option::is_none) {
            self.empty += 1;
            return Ok(());
        }
        budget.take_values(self.columns.len() + 1, NUMBER_SIZE)?;
        for (column, number) in self.columns.iter_mut().zip(numbers) {
            column.values.push(number.unwrap_or(f64::NAN));
        }
        self.times.push(time);
        self.places.push(place);
        Ok(())
    }

    /// Its messages up to the first one of each of `starts`, and those from the last one on.
    pub(super) fn split(mut self, starts: &[usize]) -> Vec<Self> {
        let mut parts = Vec::new();
        for start in starts.iter().rev() {
            let columns = self.columns.iter_mut();
            let part = |column: &mut Collected| Collected {
                header: column.header,
                values: column.values.split_off(*start),
            };
            parts.push(Self {
                topic: self.topic,
                columns: columns.map(part).collect(),
                times: self.times.split_off(*start),
                places: self.places.split_off(*start),
                ..Self::default()
            });
        }
        parts.push(self);
        parts.reverse();
        parts
    }

    /// Puts the messages in the order of their times: files need not have them so.
    pub(super) fn sort(&mut self) {
        if self.times.is_sorted() {
            return;
        }
        let mut order: Vec<usize> = (0..self.times.len()).collect();
        order.sort_by_key(|index| self.times.get(*index));
        for column in &mut self.columns {
            column.values = ordered(&column.values, &order);
        }
        self.places = ordered(&self.places, &order);
        self.times.sort_unstable();
    }

    /// Messages without one of the values. Where many have none of them, these are the messages of another
    /// node, which says nothing of these joints.
    pub(super) fn lacking(&self) -> usize {
        /// Messages to one without the values, at least (chosen).
        const SELDOM: usize = 10;
        let empty = if SELDOM * self.empty < self.times.len() { self.empty } else { 0 };
        let lacks = |row: &usize| self.columns.iter().any(|column| column.values[*row].is_nan());
        empty + (0..self.times.len()).filter(lacks).count()
    }
}

fn ordered<T: Copy>(values: &[T], order: &[usize]) -> Vec<T> {
    order.iter().filter_map(|index| values.get(*index).copied()).collect()
}

/// The usual interval between `times` that follow one another.
pub(super) fn interval(times: &[i64]) -> Option<f64> {
    let steps = times.windows(2).map(|pair| pair[1].saturating_sub(pair[0]) as f64);
    median(&steps.filter(|step| *step > 0.0).collect::<Vec<_>>())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn messages_are_taken_by_the_names_of_their_numbers_and_put_in_order() {
        let budget = Budget::new(crate::experiment::MemoryLimit::of_bytes(1000));
        let mut series = Series::of(0);
        series.add(3, "boom");
        series.add(4, "arm");
        let message = |name, angle| Value::Message(vec![(name, Value::Number(angle))]);
        for (time, name, angle) in [(20, "boom", 1.0), (10, "arm", 2.0), (15, "other", 3.0)] {
            series.push((time, 0), &message(name, angle), &budget).unwrap();
        }
        series.sort();
        assert_eq!((series.times.as_slice(), series.empty), (&[10, 20][..], 1));
        assert!(series.columns[0].values[0].is_nan());
        assert_eq!((series.columns[0].values[1], series.columns[1].values[0]), (1.0, 2.0));
        let twice =
            Value::Message(vec![("boom", Value::Number(5.0)), ("boom", Value::Number(6.0))]);
        series.push((30, 3), &twice, &budget).unwrap();
        assert_eq!(series.columns[0].values.last(), Some(&5.0), "the first of two of one name");
    }
}
