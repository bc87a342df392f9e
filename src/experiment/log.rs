//! The numbers of a log as joints: cells checked, trials cut and put on a uniform grid.

use std::ops::Range;

use super::error::ReadError;
use super::even;
use super::format::date_of_seconds;
use super::gaps::{gap_with_all_steps_s, unlogged};
use super::joint::{Joint, Signal, Trial};
use super::layout::JointLayout;
use super::memory::Budget;
use super::origin::{Counting, origin_s};
use super::period::is_period;
use super::sampling::{Fault, Grid, Piece, Repair, Signals};
use super::table::{BadCell, Coarse, Column, Head, Table, TrialRows};
use super::time_column::TimeSource;
use super::wrap::Wrap;
use crate::numerics::to_digits_by;
use crate::units::SamplePeriod;

/// Memory of a sample of a signal: the number as it was read, on its grid and in its trial, and
/// what is made of it until its delays are known.
const SAMPLE_SIZE: usize = 8 * size_of::<f64>();

/// Memory of a trial of a joint beside its samples and its label: itself, what its vector has to
/// spare, and its allocations.
const TRIAL_SIZE: usize = 2 * size_of::<Trial>() + 128;

/// A table that was read, with what is needed to speak of its cells.
pub(super) struct Log<'a> {
    pub(super) head: &'a Head,
    pub(super) numeric: &'a [usize],
    pub(super) table: &'a Table,
    pub(super) budget: &'a Budget,
}

impl Log<'_> {
    /// The trials' rows, named: the whole file is trial `1` unless it says otherwise.
    pub(super) fn trials(&self, stem: Option<&str>) -> Vec<TrialRows> {
        let mut trials = self.table.trials.clone();
        if trials.is_empty() {
            let label = stem.unwrap_or("1").to_owned();
            return vec![TrialRows { label, start: 0, end: self.table.rows.len() }];
        }
        for trial in &mut trials {
            if let Some(stem) = stem {
                trial.label = format!("{stem}/{}", trial.label);
            }
        }
        trials
    }

    /// The grid of each trial, and what should be known of the clock.
    pub(super) fn grids(
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
        let rows = |trial: &TrialRows| (trial.start..trial.end).collect();
        let rows: Vec<Vec<usize>> = trials.iter().map(rows).collect();
        let (grids, mut notes) = self.grids_of(&times, &rows, trials, repair)?;
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
    fn origin_s(&self, time: TimeSource) -> f64 {
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
        /// milliseconds at 50 Hz or more are no more than 20 to a second.
        const PLAUSIBLE: (f64, f64) = (0.01, 1e5);
        const GUESSED_FROM: f64 = 20.5;
        let TimeSource::Times(column, scale) = time else { return None };
        let is_known = scale.is_some() || self.counting(column, scale).is_recognized();
        let lowest = if is_known || self.are_dates(column) { PLAUSIBLE.0 } else { GUESSED_FROM };
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
    fn grids_of(
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
    fn times(&self, time: TimeSource) -> Result<Clock, ReadError> {
        let (column, scale) = match time {
            TimeSource::Times(column, scale) => (column, scale),
            TimeSource::SampleNumbers(column, period) => (column, Some(period.seconds())),
            TimeSource::Rows(period) => return Ok(Clock::Rows(period)),
        };
        let values = self.column(column).map_or(&[][..], |column| &column.values);
        let counting = self.counting(column, scale);
        let times: Vec<f64> = values.iter().map(|value| counting.seconds_of(*value)).collect();
        self.check_times(column, &times)?;
        Ok(Clock::Stamps(times))
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

    /// A joint, and what should be known of how it was read.
    pub(super) fn joint(
        &self,
        layout: &JointLayout,
        trials: &[TrialRows],
        grids: &[Grid],
        time: TimeSource,
        repair: Repair,
    ) -> Result<(Joint, Vec<String>), ReadError> {
        self.check_joint(layout, repair)?;
        let (own, mut notes) = match self.sparse_rows(layout, trials, repair) {
            Some(rows) => self.sparse_grids(layout, trials, rows, time)?,
            None => (None, self.missing_notes(layout)),
        };
        notes.extend(self.coarse_notes(layout));
        let grids = own.as_deref().unwrap_or(grids);
        let origin_s = self.origin_s(time);
        let mut joint = Joint {
            name: layout.name.clone(),
            input_unit: layout.input.signal.unit.clone(),
            output_unit: layout.output.signal.unit.clone(),
            covariates: layout.covariates.iter().map(|c| c.signal.clone()).collect::<Vec<Signal>>(),
            trials: Vec::new(),
        };
        let wrap = self.wrap(layout, trials, repair);
        let mut turns = 0;
        let mut split: Vec<(&TrialRows, Range<usize>)> = Vec::new();
        let size = (2 + joint.covariates.len()) * SAMPLE_SIZE;
        for (rows, grid) in trials.iter().zip(grids) {
            self.take(grid.samples(), size)?;
            let mut signals = self.signals(layout, rows);
            turns += wrap.map_or(0, |wrap| wrap.unwrap(&mut signals.output));
            let pieces = grid.pieces(signals);
            if pieces.len() > 1 {
                let first = joint.trials.len();
                split.push((rows, first..first + pieces.len()));
            }
            self.take(pieces.len(), TRIAL_SIZE + rows.label.len())?;
            let labels = part_labels(&rows.label, pieces.len(), trials);
            for (label, piece) in labels.into_iter().zip(pieces) {
                joint.trials.push(self.trial(layout, label, grid, piece, origin_s)?);
            }
        }
        if joint.trials.is_empty() {
            let (path, joint) = (self.head.path.clone(), layout.name.clone());
            return Err(ReadError::NoSamples { path, joint });
        }
        notes.extend(self.split_notes(&joint, layout, &split, time));
        let note = |wrap: Wrap| {
            format!("joint `{}`: {}", joint.name, wrap.note(turns, joint.output_unit.as_deref()))
        };
        notes.extend(wrap.filter(|_| turns > 0).map(note));
        Ok((joint, notes))
    }

    /// Takes the memory of `count` values of `size` bytes each.
    fn take(&self, count: usize, size: usize) -> Result<(), ReadError> {
        let taken = self.budget.take_values(count, size);
        taken.map_err(|error| error.refuse(&self.head.path))
    }

    /// The turn after which the output of a joint wraps. Of a log that still grows it is
    /// not known.
    fn wrap(&self, layout: &JointLayout, trials: &[TrialRows], repair: Repair) -> Option<Wrap> {
        let output = self.column(layout.output.column).filter(|_| !repair.as_it_stands)?;
        let values = |rows: &TrialRows| output.values.get(rows.start..rows.end);
        let trials: Vec<&[f64]> = trials.iter().filter_map(values).collect();
        Wrap::of(&trials, layout.output.signal.unit.as_deref())
    }

    /// The joint once more, where its input changes in gaps alone: these are filled, so that its
    /// steps are those at their ends. `None` where it does not, or where the user says what is to
    /// be filled.
    pub(super) fn joint_with_gaps(
        &self,
        read: &Joint,
        layout: &JointLayout,
        trials: &[TrialRows],
        time: TimeSource,
        repair: Repair,
    ) -> Option<(Joint, Vec<String>)> {
        let output = &self.column(layout.output.column)?.values;
        // Where outputs are missing, the reaction may be among them.
        let is_whole = !output.iter().any(|value| value.is_nan());
        if !repair.joins_steps || repair.fill_s.is_some() || !is_whole {
            return None;
        }
        let gap_s = gap_with_all_steps_s(read)?;
        let repair = Repair { fill_s: Some(gap_s), ..repair };
        let (grids, _) = self.grids(time, trials, repair).ok()?;
        let (mut joint, mut notes) = self.joint(layout, trials, &grids, time, repair).ok()?;
        let marked = joint.trials.into_iter().map(|whole| {
            let gaps = unlogged(&whole, &read.trials);
            whole.with_unlogged(gaps)
        });
        joint.trials = marked.collect();
        notes.push(format!(
            "joint `{}`: its input changes only in gaps (of up to {gap_s} s): they are filled, the \
             output interpolated and the input held, and delays count from their ends",
            joint.name
        ));
        Some((joint, notes))
    }

    fn trial(
        &self,
        layout: &JointLayout,
        label: String,
        grid: &Grid,
        piece: Piece,
        origin_s: f64,
    ) -> Result<Trial, ReadError> {
        let Signals { input, output, covariates } = piece.signals;
        let trial = Trial::new(label, piece.start_s, grid.period(), input, output)
            .and_then(|trial| trial.with_covariates(covariates))
            .map(|trial| trial.counted_from(origin_s));
        trial.map_err(|source| ReadError::Trial {
            path: self.head.path.clone(),
            joint: layout.name.clone(),
            source,
        })
    }

    /// The rows of each trial that hold the joint's output, where that is so seldom that the
    /// table must be one of several clocks.
    fn sparse_rows(
        &self,
        layout: &JointLayout,
        trials: &[TrialRows],
        repair: Repair,
    ) -> Option<Vec<Vec<usize>>> {
        /// Part of the rows without an output above which it has a clock of its own.
        const SPARSE: f64 = 0.3;
        let output = &self.column(layout.output.column)?.values;
        let missing = output.iter().filter(|value| value.is_nan()).count() as f64;
        let measured = |trial: &TrialRows| {
            let rows = trial.start..trial.end;
            rows.filter(|&row| output.get(row).is_some_and(|value| !value.is_nan())).collect()
        };
        let is_sparse = repair.is_free() && missing > SPARSE * output.len() as f64;
        is_sparse.then(|| trials.iter().map(measured).collect())
    }

    /// Grids of the rows with an output, each trial's own.
    fn sparse_grids(
        &self,
        layout: &JointLayout,
        trials: &[TrialRows],
        rows: Vec<Vec<usize>>,
        time: TimeSource,
    ) -> Result<(Option<Vec<Grid>>, Vec<String>), ReadError> {
        let Clock::Stamps(times) = self.times(time)? else {
            return Ok((None, self.missing_notes(layout)));
        };
        let name = &layout.name;
        let (grids, clock) = self.grids_of(&times, &rows, trials, Repair::default())?;
        let count: usize = rows.iter().map(Vec::len).sum();
        let mut notes = vec![format!(
            "joint `{name}`: {count} of {} rows have an output, and are taken as its samples; the \
             input is held",
            self.table.rows.len()
        )];
        notes.extend(clock.into_iter().map(|note| format!("joint `{name}`: {note}")));
        let in_trial = |(rows, trial): (Vec<usize>, &TrialRows)| {
            rows.into_iter().map(|row| row - trial.start).collect()
        };
        let rows = rows.into_iter().zip(trials).map(in_trial);
        let grids = grids.into_iter().zip(rows).map(|(grid, rows)| grid.of_some(rows));
        Ok((Some(grids.collect()), notes))
    }

    /// A line on cells that are missing in the input and the output of a joint.
    fn missing_notes(&self, layout: &JointLayout) -> Vec<String> {
        let kinds = [
            (layout.output.column, "short gaps are filled in a line, longer ones part the trial"),
            (layout.input.column, "the last value is held"),
        ];
        let note = |(column, what): (usize, &str)| {
            let values = &self.column(column)?.values;
            let missing = values.iter().filter(|value| value.is_nan()).count();
            let first = values.iter().position(|value| value.is_nan())?;
            let (name, column, row) = (&layout.name, self.header(column), self.row(first));
            let cells = if missing == 1 { "cell is" } else { "cells are" };
            Some(format!(
                "joint `{name}`: {missing} {cells} empty or NaN in `{column}` (first at row \
                 {row}): {what}"
            ))
        };
        kinds.into_iter().filter_map(note).collect()
    }

    /// A line on each trial of `joint` that was `split` at gaps, with the places of its parts.
    fn split_notes(
        &self,
        joint: &Joint,
        layout: &JointLayout,
        split: &[(&TrialRows, Range<usize>)],
        time: TimeSource,
    ) -> Vec<String> {
        /// Notes of one kind that are all shown.
        const SHOWN: usize = 3;
        let name = &joint.name;
        let times = if split.is_empty() { None } else { self.times(time).ok() };
        let note = |(trial, places): &(&TrialRows, Range<usize>)| {
            let parts = joint.trials.get(places.clone()).unwrap_or_default();
            let gap = times.as_ref().and_then(|it| self.longest_gap(parts, layout, trial, it));
            let gap = gap.map_or_else(String::new, |(seconds, row)| {
                let one = if parts.len() == 2 { "of" } else { "the longest of" };
                format!(" ({one} {} s, before row {row})", to_three_digits(seconds))
            });
            let (label, count) = (&trial.label, places.len());
            format!("joint `{name}`: trial `{label}` is split in {count} at long gaps{gap}")
        };
        let mut notes: Vec<String> = split.iter().take(SHOWN).map(note).collect();
        if let Some(more) = split.len().checked_sub(SHOWN).filter(|more| *more > 0) {
            notes.push(format!("joint `{name}`: {more} more trials are split at long gaps"));
        }
        notes
    }

    /// The longest time between two `parts` of a trial, and the row behind it.
    fn longest_gap(
        &self,
        parts: &[Trial],
        layout: &JointLayout,
        trial: &TrialRows,
        times: &Clock,
    ) -> Option<(f64, u64)> {
        let end = |part: &Trial| part.time_s(part.len());
        let gaps = parts.windows(2).map(|pair| (pair[1].time_s(1) - end(&pair[0]), &pair[1]));
        let (gap, behind) =
            gaps.max_by(|a, b| a.0.total_cmp(&b.0)).filter(|(gap, _)| *gap > 0.0)?;
        let half = 0.5 * behind.period().seconds();
        let output = &self.column(layout.output.column)?.values;
        let time = |row: usize| match times {
            Clock::Stamps(times) => times.get(row).copied(),
            Clock::Rows(period) => Some((row - trial.start) as f64 * period.seconds()),
        };
        let begins = |row: &usize| {
            let is_measured = output.get(*row).is_some_and(|value| !value.is_nan());
            is_measured
                && time(*row).is_some_and(|time| (time - behind.logged_time_s(1)).abs() <= half)
        };
        let row = (trial.start..trial.end).find(begins)?;
        Some((gap, self.row(row)))
    }

    /// The signals whose offset is so large that double precision does not hold their motion.
    fn coarse_notes(&self, layout: &JointLayout) -> Vec<String> {
        let note = |column: usize| {
            let Coarse { largest, apart, range } = self.column(column)?.coarse()?;
            let (name, column) = (&layout.name, self.header(column));
            Some(format!(
                "joint `{name}`: numbers near {largest:.1e} as in `{column}` are {apart} apart, and \
                 these differ by {range} at most: how the signal moves is beyond double precision; \
                 log it without the offset"
            ))
        };
        [layout.input.column, layout.output.column].into_iter().filter_map(note).collect()
    }

    /// Refuses bad cells, and missing ones where they may not be filled.
    fn check_joint(&self, layout: &JointLayout, repair: Repair) -> Result<(), ReadError> {
        let needed = [layout.input.column, layout.output.column];
        let further = layout.covariates.iter().map(|covariate| covariate.column);
        if let Some(error) = needed.into_iter().chain(further).find_map(|c| self.bad_cell(c)) {
            return Err(error);
        }
        let empty = |column: &usize| {
            self.column(*column).is_some_and(|c| c.values.iter().all(|value| value.is_nan()))
        };
        if let Some(column) = needed.into_iter().find(empty) {
            let (path, column) = (self.head.path.clone(), self.header(column));
            return Err(ReadError::NeverMeasured { path, column });
        }
        let too_small = |column: usize| Some((column, self.column(column)?.too_small()?));
        if let Some((column, largest)) = needed.into_iter().find_map(too_small) {
            let (path, column) = (self.head.path.clone(), self.header(column));
            return Err(ReadError::BelowPrecision { path, column, largest });
        }
        if !repair.as_it_stands || repair.fill_s.is_some() {
            return Ok(());
        }
        let first_missing = |column: usize| {
            let values = &self.column(column)?.values;
            values.iter().position(|value| value.is_nan()).map(|index| (index, column))
        };
        match needed.into_iter().filter_map(first_missing).min() {
            Some((index, column)) => Err(ReadError::Missing {
                path: self.head.path.clone(),
                row: self.row(index),
                column: self.header(column),
            }),
            None => Ok(()),
        }
    }

    fn signals(&self, layout: &JointLayout, rows: &TrialRows) -> Signals {
        let cut = |column: usize| {
            let values = self.column(column).map_or(&[][..], |column| &column.values);
            values.get(rows.start..rows.end).unwrap_or_default().to_vec()
        };
        Signals {
            input: cut(layout.input.column),
            output: cut(layout.output.column),
            covariates: layout.covariates.iter().map(|c| cut(c.column)).collect(),
        }
    }

    fn column(&self, index: usize) -> Option<&Column> {
        let place = self.numeric.binary_search(&index).ok()?;
        self.table.columns.get(place)
    }

    fn header(&self, column: usize) -> String {
        self.head.headers.get(column).map(|header| header.name.clone()).unwrap_or_default()
    }

    fn row(&self, index: usize) -> u64 {
        self.table.rows.number(index)
    }

    /// The first bad cell of a column.
    fn bad_cell(&self, column: usize) -> Option<ReadError> {
        let (row, bad) = self.column(column)?.error.clone()?;
        let (path, column) = (self.head.path.clone(), self.header(column));
        Some(match bad {
            BadCell::Kind(found) => ReadError::NotNumbers { path, column, found },
            BadCell::Text(text) => ReadError::NotANumber { path, row, column, text },
            BadCell::Thousands(text) => ReadError::Thousands { path, row, column, text },
            BadCell::DecimalMark(text) => ReadError::DecimalMarks { path, row, column, text },
            BadCell::Infinite => ReadError::Infinite { path, row, column },
            BadCell::TooLarge(value) => ReadError::BeyondPrecision { path, row, column, value },
        })
    }
}

/// Times of the rows in seconds, or the period between rows that have none.
enum Clock {
    Stamps(Vec<f64>),
    Rows(SamplePeriod),
}

/// A length of time to three digits, no longer one shorter: who fills gaps up to it fills this one.
fn to_three_digits(seconds: f64) -> f64 {
    to_digits_by(seconds, 3, |digits| (digits * (1.0 - 1e-9)).ceil())
}

/// Names of the parts of a trial that was split: `a#1`, `a#2`, with as many marks as it
/// takes to meet no other trial.
fn part_labels(label: &str, parts: usize, trials: &[TrialRows]) -> Vec<String> {
    if parts == 1 {
        return vec![label.to_owned()];
    }
    let mut stem = format!("{label}#");
    while trials.iter().any(|trial| trial.label.starts_with(&stem)) {
        stem.push('#');
    }
    (1..=parts).map(|part| format!("{stem}{part}")).collect()
}
