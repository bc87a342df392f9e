//! All that topics said, at the times of one.

use std::collections::BTreeMap;

use super::notes;
use super::runs::in_runs;
use super::series::{NUMBER_SIZE, Series, interval};
use super::stream::refused;
use super::topics::Topics;
use crate::experiment::error::{ReadError, ReadErrorKind};
use crate::experiment::memory::Budget;
use crate::experiment::names::listed;
use crate::experiment::table::Wanted;

/// Time in nanoseconds by which a step may come late, and by which rows are apart then.
const LATE: i64 = 10_000_000;

/// Rows for each message, at most.
const MOST_ROWS: i64 = 10;

/// Usual intervals beyond which nothing is known between two messages, as in tables.
const LONGEST: f64 = 3.0;

/// Columns with a value for each row.
#[derive(Default)]
pub(super) struct Aligned {
    /// Nanoseconds.
    pub(super) times: Vec<i64>,
    /// By the header of each.
    pub(super) columns: BTreeMap<usize, Vec<f64>>,
    /// What was held, and what is missing from it.
    pub(super) notes: Vec<String>,
}

/// A row: a message of the topic that gives them, or a time between two.
struct Row {
    time: i64,
    /// Where it stands in the file; between two messages behind all that comes at its time.
    place: u32,
    /// The message at it or before it, and whether it is that message's own.
    message: usize,
    is_own: bool,
}

impl Topics {
    /// All series at the messages of the topic, and at times between these where it is slow: each is held
    /// from its latest message.
    /// What comes before the first message of all others is left out; what begins later is NaN up to
    /// there, so that a joint whose command comes late takes no rows from those beside it.
    pub(super) fn align(
        &self,
        series: Vec<Series>,
        wanted: &Wanted<'_>,
        budget: &Budget,
    ) -> Result<Aligned, ReadError> {
        let (mut aligned, mut failed) = (Aligned::default(), Vec::new());
        for run in in_runs(series, wanted.clock) {
            match self.align_run(run, wanted, budget) {
                Ok(run) => aligned.append(run),
                Err(error) if matches!(error.kind, ReadErrorKind::Format) => failed.push(error),
                Err(error) => return Err(error),
            }
        }
        let left_out = failed.len();
        match failed.into_iter().next() {
            Some(error) if aligned.times.is_empty() => return Err(error),
            Some(_) => aligned.notes.push(format!(
                "its clock starts anew, and {left_out} runs without a message of each topic are left out"
            )),
            None => {}
        }
        Ok(aligned)
    }

    /// [`Self::align`] of a run in which the clock does not start anew.
    fn align_run(
        &self,
        mut series: Vec<Series>,
        wanted: &Wanted<'_>,
        budget: &Budget,
    ) -> Result<Aligned, ReadError> {
        series.iter_mut().for_each(Series::sort);
        let Some(place) = series.iter().position(|series| series.topic == wanted.clock) else {
            return Ok(Aligned::default());
        };
        let clock = series.swap_remove(place);
        let held = series;
        let parts = rows_per_message(&clock.times, &held);
        let columns = held.iter().chain([&clock]).map(|series| series.columns.len()).sum();
        // A topic of one message is held at as many rows as there are.
        let most = clock.times.len().saturating_mul(usize::try_from(parts).unwrap_or(1));
        budget.take_values(most.saturating_mul(columns), NUMBER_SIZE)?;
        let rows = rows(&clock, parts);
        let mut columns = BTreeMap::new();
        let mut start = if held.is_empty() { 0 } else { rows.len() };
        for series in &held {
            for column in &series.columns {
                let values = hold(series, &column.values, &rows);
                let first = values.iter().position(|value| !value.is_nan());
                start = start.min(first.unwrap_or(rows.len()));
                columns.insert(column.header, values);
            }
        }
        if start == rows.len() && start > 0 {
            return Err(self.never_together(&clock, &held));
        }
        let notes = self.notes(&clock, &held, start);
        for column in clock.columns {
            let at_rows = if wanted.label == Some(column.header) { labels } else { own };
            columns.insert(column.header, at_rows(&column.values, &rows));
        }
        for values in columns.values_mut() {
            values.drain(..start);
        }
        let times = rows.iter().skip(start).map(|row| row.time).collect();
        Ok(Aligned { times, columns, notes })
    }

    fn never_together(&self, clock: &Series, held: &[Series]) -> ReadError {
        let topic = self.name(clock.topic);
        let others = listed(held.iter().map(|series| self.name(series.topic)));
        let reason = format!("no message of {topic} comes after the first ones of {others}");
        refused(
            reason,
            "choose topics that were recorded together, and `--time log_time` where their stamps are of \
             several clocks",
        )
    }

    /// What was held, where the first rows up to `start` are left out, and what is missing.
    fn notes(&self, clock: &Series, held: &[Series], start: usize) -> Vec<String> {
        let topic = self.name(clock.topic);
        let others: Vec<&str> = held.iter().map(|held| self.name(held.topic)).collect();
        let mut notes: Vec<String> = notes::held(topic, &others, start).into_iter().collect();
        notes.extend(notes::without_values(clock, topic));
        let end = clock.times.last().copied().unwrap_or_default();
        for (held, name) in held.iter().zip(others) {
            notes.extend(notes::missing(held, end, name));
        }
        notes
    }
}

/// Rows for each message at these `times`: more than one where messages are far apart and a value that is
/// `held` would come later than by [`LATE`] without them.
fn rows_per_message(times: &[i64], held: &[Series]) -> i64 {
    let Some(usual) = interval(times) else { return 1 };
    if !held.iter().any(|held| comes_late(held, times)) {
        return 1;
    }
    let is_enough = |parts: &i64| (parts * LATE) as f64 >= usual;
    (1..MOST_ROWS).find(is_enough).unwrap_or(MOST_ROWS)
}

/// Whether a new value of a topic comes more than [`LATE`] before the first of `times` that has it.
fn comes_late(held: &Series, times: &[i64]) -> bool {
    let is_new = |index: usize| {
        held.columns.iter().any(|column| match column.values.get(index - 1..=index) {
            Some([before, value]) => (value - before).abs() > 0.0,
            _ => false,
        })
    };
    held.times.iter().enumerate().skip(1).any(|(index, sent)| {
        let row = times.partition_point(|row| row < sent);
        row > 0 && times.get(row).is_some_and(|row| row - sent > LATE) && is_new(index)
    })
}

/// The messages, and times between those that follow one another, up to so many `parts` of each interval.
fn rows(clock: &Series, parts: i64) -> Vec<Row> {
    let usual = interval(&clock.times).unwrap_or_default();
    let mut rows = Vec::new();
    for (message, (&time, &place)) in clock.times.iter().zip(&clock.places).enumerate() {
        rows.push(Row { time, place, message, is_own: true });
        let Some(next) = clock.times.get(message + 1) else { break };
        let step = next.saturating_sub(time);
        let parts = if step as f64 <= LONGEST * usual { parts } else { 1 };
        for part in 1..parts {
            let time = time.saturating_add(step / parts * part);
            rows.push(Row { time, place: u32::MAX, message, is_own: false });
        }
    }
    rows
}

/// The `values` of the messages at their rows, and NaN between them: what is missing there is filled
/// where it is an output.
fn own(values: &[f64], rows: &[Row]) -> Vec<f64> {
    let mut own = labels(values, rows);
    for (value, _) in own.iter_mut().zip(rows).filter(|(_, row)| !row.is_own) {
        *value = f64::NAN;
    }
    own
}

/// The `values` of the messages at the rows, each held up to the next.
fn labels(values: &[f64], rows: &[Row]) -> Vec<f64> {
    rows.iter().filter_map(|row| values.get(row.message).copied()).collect()
}

/// The latest of the `values` of a series at each of `rows`, by their times and places in the file, which
/// say what came first at one time, as where a clock is coarse; NaN before the first.
fn hold(series: &Series, values: &[f64], rows: &[Row]) -> Vec<f64> {
    let sent = series.times.iter().zip(&series.places);
    let mut messages = sent.zip(values).peekable();
    let mut latest = f64::NAN;
    let mut held = Vec::with_capacity(rows.len());
    for row in rows {
        let is_before =
            |((time, place), _): &((&i64, &u32), &f64)| (**time, **place) <= (row.time, row.place);
        while let Some((_, value)) = messages.next_if(is_before) {
            latest = if value.is_nan() { latest } else { *value };
        }
        held.push(latest);
    }
    held
}

impl Aligned {
    /// Puts those of a later run behind these.
    fn append(&mut self, later: Self) {
        self.times.extend(later.times);
        for (header, values) in later.columns {
            self.columns.entry(header).or_default().extend(values);
        }
        for note in later.notes {
            if !self.notes.contains(&note) {
                self.notes.push(note);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn series(times: &[i64], places: &[u32]) -> Series {
        let mut series = Series::of(0);
        (series.times, series.places) = (times.to_vec(), places.to_vec());
        series
    }

    #[test]
    fn a_value_is_held_from_its_message_on() {
        let messages = series(&[10, 20, 20, 30], &[0, 3, 5, 6]);
        let clock = series(&[5, 10, 19, 20, 20, 40], &[1, 2, 2, 4, 7, 8]);
        let held = hold(&messages, &[1.0, 2.0, 3.0, f64::NAN], &rows(&clock, 1));
        assert!(held[0].is_nan());
        assert_eq!(held[1..], [1.0, 1.0, 2.0, 3.0, 3.0]);
    }

    #[test]
    fn rows_between_messages_hold_no_number_of_theirs() {
        let clock = series(&[0, 40, 80, 400, 440], &[0, 1, 2, 3, 4]);
        let rows = rows(&clock, 2);
        let times: Vec<i64> = rows.iter().map(|row| row.time).collect();
        assert_eq!(times, [0, 20, 40, 60, 80, 400, 420, 440], "none in the pause");
        let values = [1.0, 2.0, 3.0, 4.0, 5.0];
        assert_eq!(labels(&values, &rows), [1.0, 1.0, 2.0, 2.0, 3.0, 4.0, 4.0, 5.0]);
        let numbers = own(&values, &rows);
        assert!(rows.iter().zip(numbers).all(|(row, number)| row.is_own != number.is_nan()));
    }
}
