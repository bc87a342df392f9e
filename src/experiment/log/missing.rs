//! What a missing cell is, and what becomes of it: all of it is decided here.
//!
//! A cell is missing where it is empty or NaN, as it was read or as a repair left it. A missing input is
//! the one before it, since a logger may note it where it changes. A missing output lies on the line
//! between those around it, where these are near one another: how near depends on whether most rows have
//! one, or the sensor has a clock of its own. A grid fills them so. A further signal stays missing.

use std::ops::Range;

use super::cells::Log;
use crate::experiment::error::{ReadError, ReadErrorKind};
use crate::experiment::grid::{Grid, Repair, filled_s, hold};
use crate::experiment::layout::JointLayout;
use crate::experiment::trial::{Trial, no_shorter};
use crate::numerics::median;
use crate::units::floor_to_index;

/// What of an output is filled with lines, beside the gaps that are filled in the clock.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Filled {
    /// What lies between the readings of a sensor that is slower than the log.
    Readings,
    /// The pauses of a logger in which the input changes, and nowhere else.
    Pauses,
}

/// What is filled, and up to how many seconds outputs are joined then.
type FilledFor = Option<(Filled, f64)>;

impl Log<'_> {
    /// What of the output of a joint is filled, whose clock is that of `grids`, and what is said of it.
    ///
    /// # Errors
    /// [`ReadErrorKind::Missing`] where nothing may be filled.
    pub(super) fn missing(
        &self,
        layout: &JointLayout,
        grids: &[Grid],
    ) -> Result<(FilledFor, Vec<String>), ReadError> {
        let Repair { as_it_stands, fill_s, .. } = self.options;
        if as_it_stands && fill_s.is_none() {
            self.check_whole(layout)?;
        }
        if let Some((longest_s, note)) = self.slow_sensor(layout).filter(|_| self.options.is_free())
        {
            return Ok((Some((Filled::Readings, longest_s)), vec![note]));
        }
        let mut notes = self.filled_notes(layout);
        let may_fill = !as_it_stands && fill_s.is_none();
        let Some(longest_s) = self.pause_with_steps_s(layout, grids).filter(|_| may_fill) else {
            return Ok((None, notes));
        };
        notes.push(format!(
            "its input changes only in gaps of the log (of up to {longest_s} s). They are filled, \
             the output interpolated and the input held, so delays count from the end of a gap. A \
             reaction inside a gap cannot be seen; a delay accepted for such a step is wrong"
        ));
        Ok((Some((Filled::Pauses, longest_s)), notes))
    }

    /// The longest pause of a logger, with two periods to spare, to three digits, where the input of a joint
    /// changes in pauses and nowhere else, as where it pauses while the valve is switched: cut there, no
    /// trial has a step. None where a pause is longer than that of one stroke.
    fn pause_with_steps_s(&self, layout: &JointLayout, grids: &[Grid]) -> Option<f64> {
        /// Chosen: a gap that is longer parts two experiments; and samples to a row, at most: beyond it gaps
        /// are not what is missing from a record.
        const LONGEST_S: f64 = 2.0;
        const SAMPLES: f64 = 100.0;
        let mut input = self.column(layout.input.column)?.values.clone();
        hold(&mut input);
        // Where outputs are missing, the reaction may be among them.
        let output = &self.column(layout.output.column)?.values;
        if output.iter().any(|value| value.is_nan()) {
            return None;
        }
        let (mut longest_s, mut samples, mut any_step) = (0.0_f64, 0.0, false);
        for (trial, (rows, grid)) in self.spans().into_iter().zip(grids).enumerate() {
            let (period, input) = (grid.period().seconds(), input.get(rows)?);
            for (times, input) in self.times_of(trial)?.windows(2).zip(input.windows(2)) {
                let (seconds, is_pause) = (times[1] - times[0], is_pause(times, period));
                let is_step = (input[1] - input[0]).abs() > 0.0;
                if is_step && !is_pause {
                    return None;
                }
                any_step |= is_step;
                samples += seconds / period;
                if is_pause {
                    longest_s = longest_s.max(seconds + 2.0 * period);
                }
            }
        }
        let is_short = longest_s <= LONGEST_S && samples <= SAMPLES * output.len() as f64;
        (any_step && is_short).then(|| no_shorter(longest_s))
    }

    /// The samples of `whole`, of the trial with this index, in the pauses of its logger.
    pub(super) fn pauses(&self, trial: usize, whole: &Trial) -> Vec<Range<usize>> {
        let period = whole.period().seconds();
        let sample = |time_s: f64| floor_to_index(((time_s - whole.time_s(1)) / period).round());
        let pauses = self.times_of(trial).unwrap_or_default().windows(2);
        let pauses = pauses.filter(|times| is_pause(times, period));
        let samples = pauses.map(|times| sample(times[0]) + 1..sample(times[1]).min(whole.len()));
        samples.filter(|samples| !samples.is_empty()).collect()
    }

    /// Refuses the first missing cell.
    fn check_whole(&self, layout: &JointLayout) -> Result<(), ReadError> {
        let first_missing = |column: usize| {
            let values = &self.column(column)?.values;
            values.iter().position(|value| value.is_nan()).map(|index| (index, column))
        };
        let needed = [layout.input.column, layout.output.column];
        let Some((index, column)) = needed.into_iter().filter_map(first_missing).min() else {
            return Ok(());
        };
        let error = ReadError::new(ReadErrorKind::Missing, "the cell is empty or NaN");
        Err(error.in_row(self.row(index)).in_column(self.header(column)))
    }

    /// How far apart outputs may be that are joined by a line, where so many rows have none that the sensor
    /// must have a clock of its own: steps of the input keep their times.
    fn slow_sensor(&self, layout: &JointLayout) -> Option<(f64, String)> {
        /// Part of the rows without an output, at least, and times the usual distance of two outputs beyond
        /// which nothing is known between them (chosen).
        const SPARSE: f64 = 0.3;
        const LONGEST: f64 = 3.0;
        // Of rows without a time it is not known that any are missing.
        self.layout.time.column()?;
        let output = &self.column(layout.output.column)?.values;
        let is_measured = |row: &usize| output.get(*row).is_some_and(|value| !value.is_nan());
        let (mut count, mut apart) = (0, Vec::new());
        for rows in self.spans() {
            let measured: Vec<f64> =
                rows.filter(is_measured).filter_map(|row| self.times.get(row).copied()).collect();
            count += measured.len();
            apart.extend(measured.windows(2).map(|pair| pair[1] - pair[0]));
        }
        let all = output.len();
        let usual_s = median(&apart).filter(|_| (all - count) as f64 > SPARSE * all as f64)?;
        let note = format!(
            "only {count} of {all} rows have an output; it is interpolated between them, so that \
             the input steps keep their times. Intervals and p-values treat interpolated samples \
             as measured, and an onset model may take the interpolation for a lag. Models are \
             compared with the measured samples only"
        );
        Some((LONGEST * usual_s, note))
    }

    /// A line on cells that are missing in the input and the output of a joint.
    fn filled_notes(&self, layout: &JointLayout) -> Vec<String> {
        let held = if self.values(layout.input.column).first().is_some_and(|value| value.is_nan()) {
            "the last value is held; before the first value, the first one is used, so a step to \
             it is not known"
        } else {
            "the last value is held"
        };
        let filled = "short gaps are filled by linear interpolation, longer ones split the trial";
        let note = |(column, what): (usize, &str)| {
            let missing =
                self.values(column).iter().enumerate().filter(|(_, value)| value.is_nan());
            let (first, _) = missing.clone().next()?;
            let (count, name, row) = (missing.count(), self.header(column), self.row(first));
            let cells = if count == 1 { "cell is" } else { "cells are" };
            Some(format!("{count} {cells} empty or NaN in `{name}` (first at row {row}): {what}"))
        };
        let columns = [(layout.output.column, filled), (layout.input.column, held)];
        columns.into_iter().filter_map(note).collect()
    }
}

/// Whether so much time passes between two rows that the record is cut there unless it is filled.
fn is_pause(times: &[f64], period: f64) -> bool {
    let seconds = times[1] - times[0];
    (seconds / period).round() * period > filled_s(period) * (1.0 + 1e-9)
}

#[cfg(test)]
mod tests {
    use crate::experiment::{Experiment, HandedColumn, HandedLog, HandedValues, ReadOptions};

    /// The gaps that are filled in a log at 10 Hz with these inputs, whose second half begins so late.
    fn unlogged(inputs: [f64; 6], late_s: f64) -> Vec<std::ops::Range<usize>> {
        let times = (0..6).map(|k| 0.1 * f64::from(k) + if k > 2 { late_s } else { 0.0 });
        let column = |name: &str, numbers: Vec<f64>| HandedColumn {
            name: name.to_owned(),
            values: HandedValues::Numbers(numbers),
        };
        let columns = vec![
            column("time_s", times.collect()),
            column("boom.input", inputs.to_vec()),
            column("boom.output", vec![0.0, 0.1, 0.2, 0.3, 0.4, 0.5]),
        ];
        let log = HandedLog { name: "bench".to_owned(), columns };
        let found = Experiment::of_logs(vec![log], &ReadOptions::default());
        found.joints[0].trials.iter().flat_map(|trial| trial.unlogged().to_vec()).collect()
    }

    #[test]
    fn steps_are_in_pauses_where_they_are_nowhere_else() {
        let step = [0.0, 0.0, 0.0, 1.0, 1.0, 1.0];
        assert_eq!(unlogged(step, 1.0).first(), Some(&(3..13)));
        assert!(unlogged(step, 4.0).is_empty(), "too long");
        assert!(unlogged([0.0; 6], 1.0).is_empty(), "no step");
        assert!(unlogged([0.0, 0.0, 0.0, 1.0, 1.0, 2.0], 1.0).is_empty(), "another step");
    }
}
