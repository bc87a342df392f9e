//! The joints of a log: cells checked, trials cut and put on a uniform grid.

use std::ops::Range;

use super::cells::Log;
use super::times::Clock;
use crate::experiment::error::ReadError;
use crate::experiment::gaps::{gap_with_all_steps_s, unlogged};
use crate::experiment::joint::{Joint, Signal, Trial};
use crate::experiment::layout::JointLayout;
use crate::experiment::sampling::{Grid, Piece, Repair, Signals};
use crate::experiment::table::{Coarse, TrialRows};
use crate::experiment::time_column::TimeSource;
use crate::numerics::{median, to_digits_by};

/// Memory of a sample of a signal: the number as it was read, on its grid and in its trial, and
/// what is made of it until its delays are known.
const SAMPLE_SIZE: usize = 8 * size_of::<f64>();

/// Memory of a trial of a joint beside its samples and its label: itself, what its vector has to
/// spare, its allocations, and what is kept of its delays.
const TRIAL_SIZE: usize = 2 * size_of::<Trial>() + 640;

/// Grids of a joint, where they are not those of its log, and what should be known of them.
type OwnGrids = (Option<Vec<Grid>>, Vec<String>);

impl Log<'_> {
    /// A joint, and what should be known of how it was read.
    pub(in crate::experiment) fn joint(
        &self,
        layout: &JointLayout,
        trials: &[TrialRows],
        grids: &[Grid],
        time: TimeSource,
        repair: Repair,
    ) -> Result<(Joint, Vec<String>), ReadError> {
        self.check_joint(layout, repair)?;
        let (layout, unread) = self.with_readable_covariates(layout);
        let layout = &layout;
        self.check_one_series(layout, trials, time)?;
        let mut is_interpolated = false;
        let (own, mut notes) = match self.sparse_rows(layout, trials, repair) {
            Some(rows) => match self.filled_grids(layout, trials, &rows, time, repair)? {
                Some(own) => {
                    is_interpolated = true;
                    own
                }
                None => self.sparse_grids(layout, trials, rows, time)?,
            },
            None => (None, self.missing_notes(layout)),
        };
        notes.extend(self.coarse_notes(layout));
        notes.extend(unread);
        let grids = own.as_deref().unwrap_or(grids);
        let origin_s = self.origin_s(time);
        let covariates: Vec<Signal> = layout.covariates.iter().map(|c| c.signal.clone()).collect();
        let mut made: Vec<Trial> = Vec::new();
        let mut continuous = self.continuous(layout, trials, time, repair);
        let mut split: Vec<(&TrialRows, Range<usize>)> = Vec::new();
        let size = (2 + covariates.len()) * SAMPLE_SIZE;
        for (rows, grid) in trials.iter().zip(grids) {
            self.take(grid.samples(), size)?;
            let mut signals = self.signals(layout, rows);
            continuous.make(rows, &mut signals.output);
            // What was measured is what is there on the grid without being filled.
            signals.covariates.extend(is_interpolated.then(|| signals.output.clone()));
            let pieces = grid.pieces(signals);
            if pieces.len() > 1 {
                let first = made.len();
                split.push((rows, first..first + pieces.len()));
            }
            self.take(pieces.len(), TRIAL_SIZE + rows.label.len())?;
            let labels = part_labels(&rows.label, pieces.len(), trials);
            for (label, piece) in labels.into_iter().zip(pieces) {
                let mut piece = piece;
                let measured = if is_interpolated { piece.signals.covariates.pop() } else { None };
                let trial = self.trial(layout, label, grid, piece, origin_s)?;
                made.push(match measured {
                    Some(measured) => trial.with_interpolated(missing_ranges(&measured)),
                    None => trial,
                });
            }
        }
        if made.is_empty() {
            let (path, joint) = (self.head.path.clone(), layout.name.clone());
            return Err(ReadError::NoSamples { path, joint });
        }
        let joint = Joint {
            name: layout.name.clone(),
            input_unit: layout.input.signal.unit.clone(),
            output_unit: layout.output.signal.unit.clone(),
            covariates,
            trials: made.into(),
        };
        notes.extend(self.split_notes(&joint, layout, &split, time));
        notes.extend(continuous.note(&joint, |row| self.row(row)));
        Ok((joint, notes))
    }

    /// The joint once more, where its input changes in gaps alone: these are filled, so that its
    /// steps are those at their ends. `None` where it does not, or where the user says what is to
    /// be filled.
    pub(in crate::experiment) fn joint_with_gaps(
        &self,
        read: &Joint,
        layout: &JointLayout,
        trials: &[TrialRows],
        time: TimeSource,
        repair: Repair,
    ) -> Option<(Joint, Vec<String>)> {
        /// Samples to a row, at most: beyond it gaps are not what is missing from a record.
        const LONGEST: usize = 100;
        let output = &self.column(layout.output.column)?.values;
        // Where outputs are missing, the reaction may be among them.
        let is_whole = !output.iter().any(|value| value.is_nan());
        if !repair.joins_steps || repair.fill_s.is_some() || !is_whole {
            return None;
        }
        let gap_s = gap_with_all_steps_s(read)?;
        let repair = Repair { fill_s: Some(gap_s), ..repair };
        let (grids, _) = self.grids(time, trials, repair).ok()?;
        let samples: usize = grids.iter().map(Grid::samples).sum();
        if samples > LONGEST * output.len() {
            return None;
        }
        let (mut joint, mut notes) = self.joint(layout, trials, &grids, time, repair).ok()?;
        let marked = joint.trials.into_iter().map(|whole| {
            let gaps = unlogged(&whole, &read.trials);
            whole.with_unlogged(gaps)
        });
        joint.trials = marked.collect();
        notes.push(format!(
            "joint `{}`: its input changes only in gaps (of up to {gap_s} s): they are filled, the \
             output interpolated and the input held, and delays count from their ends; a reaction within a \
             gap is not seen, and what is accepted behind it then is none",
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

    /// Grids of all rows, between which an output that only `rows` have is interpolated, so that steps
    /// of the input keep their times. `None` where rows of one time complete one another.
    fn filled_grids(
        &self,
        layout: &JointLayout,
        trials: &[TrialRows],
        rows: &[Vec<usize>],
        time: TimeSource,
        repair: Repair,
    ) -> Result<Option<OwnGrids>, ReadError> {
        /// Times the usual distance of two outputs beyond which nothing is known between them (chosen).
        const LONGEST: f64 = 3.0;
        let Clock::Stamps(times) = self.times(time)? else { return Ok(None) };
        let of_trials = trials.iter().filter_map(|trial| times.get(trial.start..trial.end));
        let increase = |times: &[f64]| times.windows(2).all(|pair| pair[0] < pair[1]);
        if !of_trials.into_iter().all(increase) {
            return Ok(None);
        }
        let apart = |pair: &[usize]| Some(times.get(pair[1])? - times.get(pair[0])?);
        let apart: Vec<f64> =
            rows.iter().flat_map(|rows| rows.windows(2).filter_map(apart)).collect();
        let Some(usual_s) = median(&apart) else { return Ok(None) };
        let repair = Repair { fill_s: Some(LONGEST * usual_s), ..repair };
        let (grids, _) = self.grids(time, trials, repair)?;
        let count: usize = rows.iter().map(Vec::len).sum();
        let note = format!(
            "joint `{}`: {count} of {} rows have an output, which is interpolated between them, so that \
             steps of the input keep their times; what follows from its noise, as intervals, takes all \
             samples for measured, and `lag-aware` the lines between them for a lag; models are held \
             against those that are measured",
            layout.name,
            self.table.rows.len()
        );
        Ok(Some((Some(grids), vec![note])))
    }

    /// Grids of the rows with an output, each trial's own.
    fn sparse_grids(
        &self,
        layout: &JointLayout,
        trials: &[TrialRows],
        rows: Vec<Vec<usize>>,
        time: TimeSource,
    ) -> Result<OwnGrids, ReadError> {
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
        let input = self.column(layout.input.column).map_or(&[][..], |column| &column.values);
        let is_late = input.first().is_some_and(|value| value.is_nan());
        let kinds = [
            (layout.output.column, "short gaps are filled in a line, longer ones part the trial"),
            (
                layout.input.column,
                if is_late {
                    "the last value is held, and the first one is taken before it: what the input was \
                     there is not known, nor a step to it"
                } else {
                    "the last value is held"
                },
            ),
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

    /// The joint without the further signals that have bad cells, and a line on each of these: what drives
    /// and what it does are there without them.
    fn with_readable_covariates(&self, layout: &JointLayout) -> (JointLayout, Vec<String>) {
        let mut readable = layout.clone();
        let mut notes = Vec::new();
        readable.covariates.retain(|covariate| match self.bad_cell(covariate.column) {
            Some(error) => {
                let (joint, signal) = (&layout.name, &covariate.signal.name);
                notes.push(format!("joint `{joint}`: the signal `{signal}` is left out: {error}"));
                false
            }
            None => true,
        });
        (readable, notes)
    }

    /// Refuses bad cells, and missing ones where they may not be filled.
    fn check_joint(&self, layout: &JointLayout, repair: Repair) -> Result<(), ReadError> {
        let needed = [layout.input.column, layout.output.column];
        if let Some(error) = needed.into_iter().find_map(|column| self.bad_cell(column)) {
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
        // A logger that notes an input when it changes does not note it anew where a trial begins.
        let mut input = cut(layout.input.column);
        if let Some(first) = input.first_mut().filter(|first| first.is_nan()) {
            let column = self.column(layout.input.column).map_or(&[][..], |column| &column.values);
            let mut before = column.get(..rows.start).unwrap_or_default().iter().rev();
            *first = before.find(|value| !value.is_nan()).copied().unwrap_or(f64::NAN);
        }
        Signals {
            input,
            output: cut(layout.output.column),
            covariates: layout.covariates.iter().map(|c| cut(c.column)).collect(),
        }
    }
}

/// The samples that are not there.
fn missing_ranges(values: &[f64]) -> Vec<Range<usize>> {
    let mut ranges: Vec<Range<usize>> = Vec::new();
    for (index, _) in values.iter().enumerate().filter(|(_, value)| value.is_nan()) {
        match ranges.last_mut().filter(|range| range.end == index) {
            Some(range) => range.end = index + 1,
            None => ranges.push(index..index + 1),
        }
    }
    ranges
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
