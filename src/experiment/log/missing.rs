//! What a missing cell is, and what becomes of it: all of it is decided here.
//!
//! A cell is missing where it is empty or NaN, as it was read or as a repair left it. A missing input is
//! the one before it, since a logger may note it where it changes. A missing output lies on the line
//! between those around it, where these are near one another: how near depends on whether most rows have
//! one, or the sensor has a clock of its own. [`Grid`](crate::experiment::grid::Grid) fills them so. A
//! further signal stays missing.

use std::ops::Range;

use super::{Log, Times};
use crate::experiment::error::ReadError;
use crate::experiment::grid::Repair;
use crate::experiment::layout::JointLayout;
use crate::numerics::median;

/// What becomes of missing outputs of a joint.
pub(super) enum Missing {
    /// A line takes their place in short gaps, and longer ones part the trial.
    Filled,
    /// The sensor is slower than the log: lines between what it measured, up to so many seconds.
    Between { longest_s: f64 },
    /// Rows of one time complement one another: those with an output, of each trial, are the samples.
    LeftOut { measured: Vec<Vec<usize>> },
}

impl Log<'_> {
    /// What becomes of the missing outputs of a joint, and what is said of its missing cells.
    ///
    /// # Errors
    /// [`ReadError::Missing`] where nothing may be filled.
    pub(super) fn missing(
        &self,
        layout: &JointLayout,
        options: Repair,
    ) -> Result<(Missing, Vec<String>), ReadError> {
        if options.as_it_stands && options.fill_s.is_none() {
            self.check_whole(layout)?;
        }
        let output = self.column(layout.output.column).map_or(&[][..], |column| &column.values);
        let slow = self.is_sparse(output, options).then(|| self.of_slow_sensor(layout, output));
        Ok(slow.flatten().unwrap_or_else(|| (Missing::Filled, self.filled_notes(layout))))
    }

    /// Refuses the first missing cell.
    fn check_whole(&self, layout: &JointLayout) -> Result<(), ReadError> {
        let first_missing = |column: usize| {
            let values = &self.column(column)?.values;
            values.iter().position(|value| value.is_nan()).map(|index| (index, column))
        };
        let needed = [layout.input.column, layout.output.column];
        match needed.into_iter().filter_map(first_missing).min() {
            Some((index, column)) => Err(ReadError::Missing {
                path: self.head.path.clone(),
                row: self.row(index),
                column: self.header(column),
            }),
            None => Ok(()),
        }
    }

    /// Whether so many rows have no output that its sensor must have a clock of its own.
    fn is_sparse(&self, output: &[f64], options: Repair) -> bool {
        /// Part of the rows without an output, at least (chosen).
        const SPARSE: f64 = 0.3;
        let missing = output.iter().filter(|value| value.is_nan()).count() as f64;
        options.is_free()
            && matches!(self.times, Times::Stamps(_))
            && missing > SPARSE * output.len() as f64
    }

    /// Where each row has a time of its own, steps of the input keep theirs: the output is interpolated.
    fn of_slow_sensor(
        &self,
        layout: &JointLayout,
        output: &[f64],
    ) -> Option<(Missing, Vec<String>)> {
        /// Times the usual distance of two outputs beyond which nothing is known between them (chosen).
        const LONGEST: f64 = 3.0;
        let Times::Stamps(times) = &self.times else { return None };
        let is_measured = |row: &usize| output.get(*row).is_some_and(|value| !value.is_nan());
        let spans = self.spans().into_iter();
        let measured: Vec<Vec<usize>> =
            spans.map(|rows| rows.filter(is_measured).collect()).collect();
        let count: usize = measured.iter().map(Vec::len).sum();
        let start = format!(
            "joint `{}`: {count} of {} rows have an output",
            layout.name,
            self.table.rows.len()
        );
        let increase = |rows: Range<usize>| {
            times.get(rows).is_some_and(|part| part.is_sorted_by(|a, b| a < b))
        };
        let apart = |pair: &[usize]| Some(times.get(pair[1])? - times.get(pair[0])?);
        let pairs = measured.iter().flat_map(|rows| rows.windows(2));
        let usual_s = median(&pairs.filter_map(apart).collect::<Vec<_>>());
        Some(match usual_s.filter(|_| self.spans().into_iter().all(increase)) {
            Some(usual_s) => {
                let note = format!(
                    "{start}, which is interpolated between them, so that steps of the input keep their \
                     times; what follows from its noise, as intervals, takes all samples for measured, and \
                     `lag-aware` the lines between them for a lag; models are held against those that are \
                     measured"
                );
                (Missing::Between { longest_s: LONGEST * usual_s }, vec![note])
            }
            None => {
                let note = format!("{start}, and are taken as its samples; the input is held");
                (Missing::LeftOut { measured }, vec![note])
            }
        })
    }

    /// A line on cells that are missing in the input and the output of a joint.
    fn filled_notes(&self, layout: &JointLayout) -> Vec<String> {
        let input = self.column(layout.input.column).map_or(&[][..], |column| &column.values);
        let held = if input.first().is_some_and(|value| value.is_nan()) {
            "the last value is held, and the first one is taken before it: what the input was \
             there is not known, nor a step to it"
        } else {
            "the last value is held"
        };
        let filled = "short gaps are filled in a line, longer ones part the trial";
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
        [(layout.output.column, filled), (layout.input.column, held)]
            .into_iter()
            .filter_map(note)
            .collect()
    }
}
