//! What a missing cell is, and what becomes of it: all of it is decided here.
//!
//! A cell is missing where it is empty or NaN, as it was read or as a repair left it. A missing input is
//! the one before it, since a logger may note it where it changes. A missing output lies on the line
//! between those around it, where these are near one another: how near depends on whether most rows have
//! one, or the sensor has a clock of its own. A grid fills them so. A further signal stays missing.

use super::cells::{Log, Times};
use crate::experiment::error::{ReadError, ReadErrorKind};
use crate::experiment::grid::Repair;
use crate::experiment::layout::JointLayout;
use crate::numerics::median;

impl Log<'_> {
    /// Up to how many seconds an output of a joint is interpolated, where its sensor is slower than the log,
    /// and what is said of missing cells. Of other outputs the gaps are filled that are filled in a clock.
    ///
    /// # Errors
    /// [`ReadErrorKind::Missing`] where nothing may be filled.
    pub(super) fn missing(
        &self,
        layout: &JointLayout,
        options: Repair,
    ) -> Result<(Option<f64>, Vec<String>), ReadError> {
        if options.as_it_stands && options.fill_s.is_none() {
            self.check_whole(layout)?;
        }
        Ok(match self.slow_sensor(layout).filter(|_| options.is_free()) {
            Some((longest_s, note)) => (Some(longest_s), vec![note]),
            None => (None, self.filled_notes(layout)),
        })
    }

    /// Refuses the first missing cell.
    fn check_whole(&self, layout: &JointLayout) -> Result<(), ReadError> {
        let first_missing = |column: usize| {
            let values = &self.column(column)?.values;
            values.iter().position(|value| value.is_nan()).map(|index| (index, column))
        };
        let needed = [layout.input.column, layout.output.column];
        match needed.into_iter().filter_map(first_missing).min() {
            Some((index, column)) => {
                let error = ReadError::new(ReadErrorKind::Missing, "the cell is empty or NaN");
                Err(error.in_row(self.row(index)).in_column(self.header(column)))
            }
            None => Ok(()),
        }
    }

    /// How far apart outputs may be that are joined by a line, where so many rows have none that the sensor
    /// must have a clock of its own: steps of the input keep their times.
    fn slow_sensor(&self, layout: &JointLayout) -> Option<(f64, String)> {
        /// Part of the rows without an output, at least, and times the usual distance of two outputs beyond
        /// which nothing is known between them (chosen).
        const SPARSE: f64 = 0.3;
        const LONGEST: f64 = 3.0;
        let Times::Stamps(times) = &self.times else { return None };
        let output = &self.column(layout.output.column)?.values;
        let is_measured = |row: &usize| output.get(*row).is_some_and(|value| !value.is_nan());
        let (mut count, mut apart) = (0, Vec::new());
        for rows in self.spans() {
            let measured: Vec<f64> =
                rows.filter(is_measured).filter_map(|row| times.get(row).copied()).collect();
            count += measured.len();
            apart.extend(measured.windows(2).map(|pair| pair[1] - pair[0]));
        }
        let all = output.len();
        let usual_s = median(&apart).filter(|_| (all - count) as f64 > SPARSE * all as f64)?;
        let note = format!(
            "{count} of {all} rows have an output, which is interpolated between them, so that \
             steps of the input keep their times; what follows from its noise, as intervals, takes all \
             samples for measured, and an onset model the lines between them for a lag; models are held \
             against those that are measured"
        );
        Some((LONGEST * usual_s, note))
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
            let (column, row) = (self.header(column), self.row(first));
            let cells = if missing == 1 { "cell is" } else { "cells are" };
            Some(format!(
                "{missing} {cells} empty or NaN in `{column}` (first at row \
                 {row}): {what}"
            ))
        };
        [(layout.output.column, filled), (layout.input.column, held)]
            .into_iter()
            .filter_map(note)
            .collect()
    }
}
