//! The times of a log: how its clock counts, its grids, and what is odd about them.

use super::cells::Log;
use crate::experiment::clock::is_period;
use crate::experiment::error::{ReadError, ReadErrorKind};
use crate::experiment::format::date_of_seconds;
use crate::experiment::grid::{Grid, Repair};
use crate::experiment::grids::grids;
use crate::experiment::names::shown;
use crate::experiment::origin::Counting;
use crate::experiment::table::{BadCell, Column, TrialRows};
use crate::experiment::time_column::TimeSource;
use crate::numerics::median;

impl Log<'_> {
    /// Reads the times of all rows.
    pub(in crate::experiment) fn read_times(&mut self) -> Result<(), ReadError> {
        self.check_times_agree()?;
        let (column, scale) = match self.layout.time {
            TimeSource::Times(column, scale) => (column, scale),
            TimeSource::SampleNumbers(column, period) => (column, Some(period.seconds())),
            TimeSource::Rows(period) => {
                let rows = self.table.trials.iter().flat_map(|trial| 0..trial.end - trial.start);
                self.times = rows.map(|row| row as f64 * period.seconds()).collect();
                return Ok(());
            }
        };
        let values = self.values(column);
        self.check_one_unit(column, values)?;
        let are_dates = self.column(column).is_some_and(|column| column.are_dates);
        let counting = Counting::of(column, values, scale.filter(|_| !are_dates));
        let times: Vec<f64> = values.iter().map(|value| counting.seconds_of(*value)).collect();
        self.check_times(column, &times)?;
        self.times = times;
        let is_number = matches!(self.layout.time, TimeSource::SampleNumbers(..));
        self.counting = Some(counting).filter(|_| !is_number);
        Ok(())
    }

    /// The grid of each trial over the rows that count, which are said to the reader with what is odd
    /// about their times.
    pub(in crate::experiment) fn main_grids(&mut self) -> Result<Vec<Grid>, ReadError> {
        let (grids, notes) = self.grids(self.options)?;
        self.check_periods(&grids)?;
        let (origin, rate) = (self.origin_note(), self.rate_note(&grids));
        self.notes.extend(notes.into_iter().chain(origin).chain(rate));
        Ok(grids)
    }

    /// The grid of each trial, and what was done to lay it.
    pub(super) fn grids(&self, options: Repair) -> Result<(Vec<Grid>, Vec<String>), ReadError> {
        let trials = 0..self.table.trials.len();
        let times: Vec<&[f64]> = trials.filter_map(|trial| self.times_of(trial)).collect();
        let number = |trial: usize, row: usize| {
            self.table.trials.get(trial).map_or(0, |rows| self.row(rows.start + row))
        };
        grids(&times, options, &number).map_err(|(trial, fault)| {
            let label = self.table.trials.get(trial).map_or("", |trial| &trial.label);
            fault.in_trial(label, |row| number(trial, row))
        })
    }

    /// What the clock shows where times are counted from, in seconds.
    pub(super) fn origin_s(&self) -> f64 {
        self.counting.map_or(0.0, Counting::origin_s)
    }

    /// What is said of times whose unit was inferred from their size, or that are counted anew.
    fn origin_note(&self) -> Option<String> {
        let counting = self.counting?;
        let origin_s = counting.origin_s();
        let counted = (origin_s != 0.0).then(|| match date_of_seconds(origin_s) {
            Some(date) => format!("times count from {date} ({origin_s} s of its clock)"),
            None => format!("times count from {origin_s} s of its clock"),
        });
        let header = self.header(counting.column);
        let unit = counting.inferred_unit().map(|unit| format!("`{header}` is taken for {unit}"));
        let said: Vec<String> = unit.into_iter().chain(counted).collect();
        (!said.is_empty()).then(|| said.join("; "))
    }

    /// Refuses times that are so far apart that their unit is another, named or supposed, and those whose
    /// period is none that may be given as an option.
    fn check_periods(&self, grids: &[Grid]) -> Result<(), ReadError> {
        /// No joint is logged so seldom as every quarter of an hour, and nothing that moves once a day.
        const SELDOM_S: (f64, f64) = (900.0, 86_400.0);
        let Some(column) = self.layout.time.column() else { return Ok(()) };
        let most = match self.counting {
            Some(counting) if counting.is_known() => SELDOM_S.1,
            Some(_) => SELDOM_S.0,
            None => f64::INFINITY,
        };
        for (trial, grid) in self.table.trials.iter().zip(grids) {
            let period = grid.period().seconds();
            let column = self.header(column);
            if period > most {
                let text = format!(
                    "its times would be {period} s apart, so they are probably not in seconds; \
                     name their unit in the header, as in `{column} [ms]`, `[us]` or `[ns]`"
                );
                return Err(ReadError::new(ReadErrorKind::Times, text).in_column(column));
            }
            if !is_period(period) {
                let text = format!(
                    "from here on samples come {period:e} s apart, and a sample period is one from 1e-9 \
                     to 1e8 s; write the times in seconds, or in the unit that the header names"
                );
                let error = ReadError::new(ReadErrorKind::Times, text).in_column(column);
                return Err(error.in_row(self.row(trial.start)));
            }
        }
        Ok(())
    }

    /// A question where no machine is sampled like this, or where seconds are only supposed.
    fn rate_note(&self, grids: &[Grid]) -> Option<String> {
        /// Samples in a second that are plausible at all, and where the unit is a guess: counts of
        /// milliseconds at 50 Hz or more are no more than 20 to a second. Above, `5.010` ms may be 5010.
        const PLAUSIBLE: (f64, f64) = (0.01, 2e4);
        const GUESSED_FROM: f64 = 20.5;
        /// Seconds since 1970 of the year 5138: what counts more counts in another unit.
        const LATEST_S: f64 = 1e11;
        let counting = self.counting?;
        let (name, first) = (self.header(counting.column), counting.first);
        if counting.is_named && counting.origin_s() > LATEST_S {
            return Some(format!(
                "is `{first:e}` in `{name}` really in the unit that it names? It looks like a time \
                 since 1970 in ms, µs or ns; say so with `--time '{name} [ms]'`, [us] or [ns]"
            ));
        }
        let are_dates = self.column(counting.column).is_some_and(|column| column.are_dates);
        let lowest = if counting.is_known() || are_dates { PLAUSIBLE.0 } else { GUESSED_FROM };
        let mut rates = grids.iter().map(|grid| 1.0 / grid.period().seconds());
        let odd = rates.find(|rate| !(lowest..=PLAUSIBLE.1).contains(rate))?;
        let rate = format!("{odd:.2e}").parse::<f64>().unwrap_or(odd);
        Some(format!(
            "are {rate} samples a second right? If not, say the unit of the time column: \
             `{name} [ms]`, [us], [ns] or [s]"
        ))
    }

    /// Refuses columns of one name that say other times: it is not known which are meant.
    fn check_times_agree(&self) -> Result<(), ReadError> {
        let first = self.layout.time.column().and_then(|column| self.column(column));
        let Some(first) = first else { return Ok(()) };
        let is_same = |other: &Column| {
            let mut pairs = first.values.iter().zip(&other.values);
            first.values.len() == other.values.len()
                && pairs.all(|(one, other)| one.to_bits() == other.to_bits())
        };
        let differs = |column: &&usize| !self.column(**column).is_some_and(is_same);
        let differs = self.layout.time_again.iter().find(differs);
        differs.map_or(Ok(()), |column| Err(self.head.two_columns(&self.header(*column))))
    }

    /// Refuses times whose unit changes: what is after the change would be another experiment.
    fn check_one_unit(&self, column: usize, values: &[f64]) -> Result<(), ReadError> {
        let Some(index) = unit_change(values) else { return Ok(()) };
        let [before, time] =
            [index - 1, index].map(|at| values.get(at).copied().unwrap_or(f64::NAN));
        let text = format!(
            "from here on the times are in another unit: `{time}` follows `{before}`, and the \
             steps between rows change by the same factor; write all times in one unit"
        );
        Err(self.clock_error(text, index).in_column(self.header(column)))
    }

    /// Every row needs a time.
    fn check_times(&self, column: usize, times: &[f64]) -> Result<(), ReadError> {
        let bad = self.column(column).and_then(|column| column.error.as_ref());
        if let Some((row, BadCell::Text(text))) = bad {
            let text = format!(
                "`{}` is neither a number nor a date and time of ISO 8601, as in \
                 2026-03-01T09:59:50.125; write the times so, or leave them out",
                shown(text)
            );
            let error = ReadError::new(ReadErrorKind::NotATime, text);
            return Err(error.in_row(*row).in_column(self.header(column)));
        }
        if let Some(error) = self.bad_cell(column) {
            return Err(error);
        }
        let Some(index) = times.iter().position(|time| time.is_nan()) else { return Ok(()) };
        let text = "the time is missing; remove the row or write it";
        Err(self.clock_error(text, index).in_column(self.header(column)))
    }

    /// What is wrong with the clock at a row.
    fn clock_error(&self, text: impl Into<String>, index: usize) -> ReadError {
        ReadError::content(text).in_row(self.row(index))
    }

    /// Refuses an output that has several series at each time, as in a table with a row for each joint: all
    /// groups of rows of one time are of one size, and values of one time lie far apart beside values of one
    /// series.
    pub(super) fn check_one_series(&self, output: usize) -> Result<(), ReadError> {
        /// Part of the rows in groups of one size, and how far apart values of one time must lie (chosen):
        /// of stamps that are rounded all of them follow one another.
        const ALIKE: f64 = 0.9;
        const APART: f64 = 10.0;
        let column = self.header(output);
        let times = self.layout.time.column().and_then(|column| self.column(column));
        let Some((times, output)) = times.zip(self.column(output)) else { return Ok(()) };
        let repeats = repeats(&times.values, &self.table.trials);
        let rows: usize = self.table.trials.iter().map(|trial| trial.end - trial.start).sum();
        let groups = rows - repeats.len();
        // Rounded to the nearest.
        let size = (2 * rows + groups).checked_div(2 * groups).unwrap_or(1);
        let odd = (rows as f64 - (size * groups) as f64).abs();
        if size < 2 || odd > (1.0 - ALIKE) * rows as f64 {
            return Ok(());
        }
        let usual = |before: usize| {
            let distance = |row: &usize| {
                let pair = output.values.get(*row).zip(output.values.get(row.checked_sub(before)?));
                pair.map(|(value, before)| (value - before).abs()).filter(|apart| !apart.is_nan())
            };
            median(&repeats.iter().filter_map(distance).collect::<Vec<_>>()).unwrap_or_default()
        };
        if usual(1) > APART * usual(size) {
            let text = format!(
                "each time is repeated in {size} rows with very different values in `{column}`, \
                 as in a table with a row for each joint; give each joint an input and an output \
                 column of its own"
            );
            return Err(ReadError::content(text).in_column(column));
        }
        Ok(())
    }
}

/// The index of the first time that is in another unit than those before it: the time and the steps
/// between times are multiplied by the same power of a thousand there. A pause multiplies neither, and
/// a clock that is set, or a slower sampling, multiplies one of them.
fn unit_change(times: &[f64]) -> Option<usize> {
    /// How many times as large numbers are in another unit of time.
    const FACTORS: [f64; 6] = [1e3, 1e6, 1e9, 1e-3, 1e-6, 1e-9];
    let changes = |window: &[f64]| {
        let &[a, b, c, d, e, f] = window else { return false };
        let [before, again, after, next] = [b - a, c - b, e - d, f - e];
        let is_like = |one: f64, other: f64| (0.5..2.0).contains(&(one / other));
        let is_by = |factor: &f64| {
            // As late as within ten steps: rows may be lost where a logger is restarted.
            let late = d / factor - c;
            (0.0..=10.0 * again).contains(&late) && is_like(after, factor * again)
        };
        before > 0.0
            && is_like(again, before)
            && is_like(next, after)
            // The steps before and after tell most pairs apart at once.
            && !(0.01..100.0).contains(&(after / again))
            && FACTORS.iter().any(is_by)
    };
    Some(times.windows(6).position(changes)? + 3)
}

/// The rows at the time of the row before in their trial.
pub(in crate::experiment) fn repeats(times: &[f64], trials: &[TrialRows]) -> Vec<usize> {
    let rows = trials.iter().flat_map(|trial| trial.start + 1..trial.end);
    rows.filter(|row| times.get(*row) == times.get(row - 1)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Times that are `factor` times as large from the index `change` on.
    fn times(origin: f64, period: f64, change: usize, factor: f64) -> Vec<f64> {
        let time = |k: u32| origin + f64::from(k) * period;
        let scaled = |k: u32| if k as usize >= change { factor * time(k) } else { time(k) };
        (0..60).map(scaled).collect()
    }

    #[test]
    fn a_unit_that_changes_is_found_where_it_does() {
        for origin in [0.0, 7.3, 1_761_350_390.0] {
            for factor in [1e3, 1e6, 1e-3] {
                assert_eq!(unit_change(&times(origin, 0.01, 31, factor)), Some(31), "{origin}");
            }
        }
    }

    #[test]
    fn pauses_slower_sampling_and_a_clock_that_is_set_change_no_unit() {
        let mut paused = times(0.0, 0.01, 60, 1.0);
        paused[30..].iter_mut().for_each(|time| *time += 5000.0);
        let slower: Vec<f64> = (0..60)
            .map(|k| 0.01 * f64::from(k.min(30)) + 10.0 * f64::from(k.max(30) - 30))
            .collect();
        let mut set = times(3.0, 0.01, 60, 1.0);
        set[30..].iter_mut().for_each(|time| *time += 1_761_350_390.0);
        for times in [paused, slower, set] {
            assert_eq!(unit_change(&times), None);
        }
    }
}
