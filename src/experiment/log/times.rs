//! The times of a log: how its clock counts, its grids, and what is odd about them.

use super::cells::Log;
use super::unit_change::unit_change;
use crate::experiment::error::ReadError;
use crate::experiment::even;
use crate::experiment::format::date_of_seconds;
use crate::experiment::origin::{Counting, origin_s};
use crate::experiment::period::is_period;
use crate::experiment::sampling::{Fault, Grid, Repair};
use crate::experiment::table::{Column, TrialRows};
use crate::experiment::time_column::TimeSource;
use crate::experiment::wrap::Wrap;
use crate::units::SamplePeriod;

/// Times of the rows in seconds, or the period between rows that have none.
pub(super) enum Clock {
    Stamps(Vec<f64>),
    Rows(SamplePeriod),
}

impl Log<'_> {
    /// The grid of each trial, and what should be known of the clock.
    pub(in crate::experiment) fn grids(
        &self,
        time: TimeSource,
        trials: &[TrialRows],
        repair: Repair,
    ) -> Result<(Vec<Grid>, Vec<String>), ReadError> {
        let times = match self.times(time)? {
            Clock::Stamps(times) => times,
            Clock::Rows(period) => {
                let grid =
                    |trial: &TrialRows| Grid::of_rows(trial.end - trial.start, period, repair);
                return Ok((trials.iter().map(grid).collect(), Vec::new()));
            }
        };
        let kept = if repair.as_it_stands { None } else { self.without_copies(&times, trials) };
        let all = |trial: &TrialRows| (trial.start..trial.end).collect();
        let rows = kept.clone().unwrap_or_else(|| trials.iter().map(all).collect());
        let (mut grids, mut notes) = self.grids_of(&times, &rows, trials, repair)?;
        if let Some(kept) = kept {
            let count = times.len() - kept.iter().map(Vec::len).sum::<usize>();
            notes.push(format!("{count} rows are copies of the row before, and left out"));
            let in_trial = |(rows, trial): (Vec<usize>, &TrialRows)| {
                rows.into_iter().map(|row| row - trial.start).collect()
            };
            let kept = kept.into_iter().zip(trials).map(in_trial);
            grids = grids.into_iter().zip(kept).map(|(grid, rows)| grid.of_some(rows)).collect();
        }
        self.check_unit(time, &grids)?;
        self.check_periods(time, trials, &grids)?;
        notes.extend(self.origin_note(time));
        notes.extend(self.rate_note(time, &grids));
        Ok((grids, notes))
    }

    /// The first time, as it stands in the log.
    fn first_time(&self, column: usize) -> Option<f64> {
        self.column(column)?.values.iter().copied().find(|value| !value.is_nan())
    }

    /// What the clock shows where times are counted from, in seconds.
    pub(super) fn origin_s(&self, time: TimeSource) -> f64 {
        let TimeSource::Times(column, scale) = time else { return 0.0 };
        let first = self.first_time(column).unwrap_or_default();
        origin_s(self.counting(column, scale).seconds_of(first))
    }

    /// How times count: dates in seconds, numbers in the unit of `scale` seconds that is named, else as
    /// their size says.
    fn counting(&self, column: usize, scale: Option<f64>) -> Counting {
        let scale = scale.filter(|_| !self.are_dates(column));
        scale.map_or_else(|| self.counting_by_size(column), Counting::in_unit)
    }

    /// Whether times are written in words.
    fn are_dates(&self, column: usize) -> bool {
        self.column(column).is_some_and(|column| column.are_dates)
    }

    fn counting_by_size(&self, column: usize) -> Counting {
        let values = self.column(column).map_or(&[][..], |column| &column.values);
        let mut known = values.iter().copied().filter(|value| !value.is_nan());
        let first = known.next().unwrap_or(f64::NAN);
        let later = known.find(|value| *value > first).unwrap_or(f64::NAN);
        Counting::of(first, later - first)
    }

    /// What is said of times whose unit was inferred from their size, or that are counted anew.
    fn origin_note(&self, time: TimeSource) -> Option<String> {
        let TimeSource::Times(column, scale) = time else { return None };
        let origin_s = self.origin_s(time);
        let counted = (origin_s != 0.0).then(|| match date_of_seconds(origin_s) {
            Some(date) => format!("times count from {date} ({origin_s} s of its clock)"),
            None => format!("times count from {origin_s} s of its clock"),
        });
        let unit = self.counting(column, scale).inferred_unit();
        let name = self.header(column);
        let unit = unit.map(|unit| format!("`{name}` is taken for {unit}"));
        let said: Vec<String> = unit.into_iter().chain(counted).collect();
        (!said.is_empty()).then(|| said.join("; "))
    }

    /// Refuses times that are so far apart that their unit is another, named or supposed.
    fn check_unit(&self, time: TimeSource, grids: &[Grid]) -> Result<(), ReadError> {
        /// No joint is logged so seldom as every quarter of an hour, and nothing that moves once a day.
        const SELDOM_S: (f64, f64) = (900.0, 86_400.0);
        let TimeSource::Times(column, scale) = time else { return Ok(()) };
        // The size of times since 1970 shows their unit, and so does a date.
        let is_known = scale.is_some() || self.counting(column, scale).is_recognized();
        let most = if is_known { SELDOM_S.1 } else { SELDOM_S.0 };
        let mut periods = grids.iter().map(|grid| grid.period().seconds());
        match periods.find(|period| *period > most) {
            Some(period) => Err(ReadError::WrongTimeUnit {
                path: self.head.path.clone(),
                column: self.header(column),
                period,
            }),
            None => Ok(()),
        }
    }

    /// Refuses times whose period is none that may be given as an option.
    fn check_periods(
        &self,
        time: TimeSource,
        trials: &[TrialRows],
        grids: &[Grid],
    ) -> Result<(), ReadError> {
        let Some(column) = time.column() else { return Ok(()) };
        let periods = grids.iter().map(|grid| grid.period().seconds());
        match trials.iter().zip(periods).find(|(_, period)| !is_period(*period)) {
            Some((trial, period)) => Err(ReadError::NoPeriod {
                path: self.head.path.clone(),
                row: self.row(trial.start),
                column: self.header(column),
                period,
            }),
            None => Ok(()),
        }
    }

    /// A question where no machine is sampled like this, or where seconds are only supposed.
    fn rate_note(&self, time: TimeSource, grids: &[Grid]) -> Option<String> {
        /// Samples in a second that are plausible at all, and where the unit is a guess: counts of
        /// milliseconds at 50 Hz or more are no more than 20 to a second. Above, `5.010` ms may be 5010.
        const PLAUSIBLE: (f64, f64) = (0.01, 2e4);
        const GUESSED_FROM: f64 = 20.5;
        /// Seconds since 1970 of the year 5138: what counts more counts in another unit.
        const LATEST_S: f64 = 1e11;
        let TimeSource::Times(column, scale) = time else { return None };
        let is_known = scale.is_some() || self.counting(column, scale).is_recognized();
        let lowest = if is_known || self.are_dates(column) { PLAUSIBLE.0 } else { GUESSED_FROM };
        if scale.is_some() && self.origin_s(time) > LATEST_S {
            let (name, first) = (self.header(column), self.first_time(column).unwrap_or_default());
            return Some(format!(
                "is `{first:e}` in `{name}` really in the unit that it names? It looks like a time \
                 since 1970 in ms, µs or ns; say so with `--time '{name} [ms]'`, [us] or [ns]"
            ));
        }
        let rates = grids.iter().map(|grid| 1.0 / grid.period().seconds());
        let odd = rates.into_iter().find(|rate| !(lowest..=PLAUSIBLE.1).contains(rate))?;
        let (name, digits) = (self.header(column), format!("{odd:.2e}"));
        let rate = digits.parse::<f64>().unwrap_or(odd);
        Some(format!(
            "are {rate} samples a second right? If not, say the unit of the time column: \
             `{name} [ms]`, [us], [ns] or [s]"
        ))
    }

    /// The grids of `rows` of each trial, which are some of its rows or all.
    pub(super) fn grids_of(
        &self,
        times: &[f64],
        rows: &[Vec<usize>],
        trials: &[TrialRows],
        repair: Repair,
    ) -> Result<(Vec<Grid>, Vec<String>), ReadError> {
        let of = |rows: &Vec<usize>| {
            rows.iter().map(|&row| times.get(row).copied().unwrap_or(f64::NAN)).collect()
        };
        let of_trials: Vec<Vec<f64>> = rows.iter().map(of).collect();
        let error = |index: usize, fault: Fault| {
            let rows = rows.get(index).map_or(&[][..], Vec::as_slice);
            let times = of_trials.get(index).map_or(&[][..], Vec::as_slice);
            let label = trials.get(index).map_or("", |trial| &trial.label);
            self.time_error(fault, label, rows, times)
        };
        let lay = |(index, times): (usize, &Vec<f64>)| {
            Grid::lay(times, repair).map_err(|fault| (index, fault))
        };
        match of_trials.iter().enumerate().map(lay).collect::<Result<Vec<_>, _>>() {
            Ok(grids) => return Ok((grids, Vec::new())),
            Err((index, fault)) if repair.as_it_stands || !fault.is_mended() => {
                return Err(error(index, fault));
            }
            Err(_) => {}
        }
        let number = |trial: usize, row: usize| {
            rows.get(trial).and_then(|rows| rows.get(row)).map_or(0, |&row| self.row(row))
        };
        let times: Vec<&[f64]> = of_trials.iter().map(Vec::as_slice).collect();
        even::grids(&times, repair, &number).map_err(|(index, fault)| error(index, fault))
    }

    /// The times of all rows, in seconds; or how far apart they are, where nothing says when.
    pub(super) fn times(&self, time: TimeSource) -> Result<Clock, ReadError> {
        let (column, scale) = match time {
            TimeSource::Times(column, scale) => (column, scale),
            TimeSource::SampleNumbers(column, period) => (column, Some(period.seconds())),
            TimeSource::Rows(period) => return Ok(Clock::Rows(period)),
        };
        let values = self.column(column).map_or(&[][..], |column| &column.values);
        self.check_one_unit(column, values)?;
        let counting = self.counting(column, scale);
        let mut times: Vec<f64> = values.iter().map(|value| counting.seconds_of(*value)).collect();
        self.check_times(column, &times)?;
        if self.column(column).is_some_and(|column| column.are_dates || column.are_of_day) {
            count_over_midnight(&mut times);
        }
        Ok(Clock::Stamps(times))
    }

    /// Refuses columns of one name that say other times: it is not known which are meant.
    pub(in crate::experiment) fn check_times_agree(
        &self,
        time: TimeSource,
        again: &[usize],
    ) -> Result<(), ReadError> {
        let Some(first) = time.column().and_then(|column| self.column(column)) else {
            return Ok(());
        };
        let is_same = |other: &Column| {
            let mut pairs = first.values.iter().zip(&other.values);
            first.values.len() == other.values.len()
                && pairs.all(|(one, other)| one.to_bits() == other.to_bits())
        };
        let differs = |column: &&usize| !self.column(**column).is_some_and(is_same);
        match again.iter().find(differs) {
            Some(column) => Err(ReadError::DuplicateColumn {
                path: self.head.path.clone(),
                row: self.head.header_row,
                column: self.header(*column),
            }),
            None => Ok(()),
        }
    }

    /// Refuses times whose unit changes: what is behind the change would be another experiment.
    fn check_one_unit(&self, column: usize, values: &[f64]) -> Result<(), ReadError> {
        match unit_change(values) {
            Some(index) => Err(ReadError::TimeUnitChanges {
                path: self.head.path.clone(),
                row: self.row(index),
                column: self.header(column),
                before: values.get(index - 1).copied().unwrap_or(f64::NAN),
                time: values.get(index).copied().unwrap_or(f64::NAN),
            }),
            None => Ok(()),
        }
    }

    /// Every row needs a time.
    fn check_times(&self, column: usize, times: &[f64]) -> Result<(), ReadError> {
        if let Some(error) = self.bad_cell(column) {
            return Err(match error {
                ReadError::NotANumber { path, row, column, text } => {
                    ReadError::NotATime { path, row, column, text }
                }
                error => error,
            });
        }
        match times.iter().position(|time| time.is_nan()) {
            Some(index) => Err(ReadError::NoTimeInRow {
                path: self.head.path.clone(),
                row: self.row(index),
                column: self.header(column),
            }),
            None => Ok(()),
        }
    }

    /// `fault` in the clock of the trial `label`, of whose `rows` these are the `times`.
    fn time_error(&self, fault: Fault, label: &str, rows: &[usize], times: &[f64]) -> ReadError {
        let path = self.head.path.clone();
        let at = |row: usize| times.get(row).copied().unwrap_or(f64::NAN);
        let number = |row: usize| rows.get(row).map_or(0, |&row| self.row(row));
        let trial = label.to_owned();
        match fault {
            Fault::NotIncreasing { row } => ReadError::TimeNotIncreasing {
                path,
                row: number(row),
                previous: row.checked_sub(1).map_or(f64::NAN, at),
                time: at(row),
            },
            Fault::NotUniform { row, step, period } => {
                ReadError::NotUniform { path, row: number(row), step, period }
            }
            Fault::FewStamps { stamps, grain_s } => {
                ReadError::FewTimes { path, row: number(0), rows: rows.len(), stamps, grain_s }
            }
            Fault::Coarse { row, grain_s, period } => {
                ReadError::CoarseTimes { path, row: number(row), grain_s, period }
            }
            Fault::TooMany { samples, period } => {
                ReadError::TooManySamples { path, trial, samples, period }
            }
            Fault::SingleRow => ReadError::SingleRow { path, row: number(0), trial },
        }
    }
}

/// Counts times of day on over midnight.
fn count_over_midnight(times: &mut [f64]) {
    if times.iter().all(|time| (0.0..Wrap::DAY_S).contains(time)) {
        Wrap::OF_CLOCK.unwrap(times);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_of_day_count_on_over_midnight() {
        let mut times = [86_399.98, 86_399.99, 0.0, 0.01];
        count_over_midnight(&mut times);
        let in_ms = times.map(|time| (1e3 * time).round());
        assert_eq!(
            in_ms.map(|ms| format!("{ms}")),
            ["86399980", "86399990", "86400000", "86400010"]
        );
        let mut unsorted = [86_399.98, 0.0, 86_399.99, 0.01];
        count_over_midnight(&mut unsorted);
        let in_ms = unsorted.map(|time| format!("{}", (1e3 * time).round()));
        assert_eq!(in_ms, ["86399980", "86400000", "86399990", "86400010"]);
        // A log that begins anew, and a time that has passed, of which hours are more than 24.
        for times in [[50.0, 60.0, 40.0, 50.0], [86_399.0, 86_400.0, 0.0, 1.0]] {
            let mut counted = times;
            count_over_midnight(&mut counted);
            assert_eq!(counted.map(f64::to_bits), times.map(f64::to_bits));
        }
    }
}
