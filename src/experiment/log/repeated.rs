//! Rows that stand at the time of the one before, all over a log: copies, and tables with a row for each
//! joint.

use super::cells::Log;
use crate::experiment::error::ReadError;
use crate::experiment::layout::JointLayout;
use crate::experiment::table::TrialRows;
use crate::experiment::time_column::TimeSource;
use crate::numerics::median;

/// Part of the rows that repeat a time, at least: of fewer the clock says what they are.
const REPEATED: f64 = 0.1;

impl Log<'_> {
    /// The rows of each trial without those that are copies of the row before; `None` where those that
    /// repeat a time are few, or say anything new.
    pub(super) fn without_copies(
        &self,
        times: &[f64],
        trials: &[TrialRows],
    ) -> Option<Vec<Vec<usize>>> {
        let columns = || self.table.columns.iter().map(|column| &column.values);
        let is_copy = |row: usize| {
            columns().all(|values| {
                let pair = values.get(row).zip(values.get(row - 1));
                pair.is_some_and(|(value, before)| value.to_bits() == before.to_bits())
            })
        };
        let repeats = repeats(times, trials);
        let rows: usize = trials.iter().map(|trial| trial.end - trial.start).sum();
        let are_copies = (repeats.len() as f64) > REPEATED * rows as f64
            && repeats.iter().all(|row| is_copy(*row));
        let kept = |trial: &TrialRows| {
            (trial.start..trial.end).filter(|row| repeats.binary_search(row).is_err()).collect()
        };
        are_copies.then(|| trials.iter().map(kept).collect())
    }

    /// Refuses an output that has several series at each time, as in a table with a row for each joint.
    pub(super) fn check_one_series(
        &self,
        layout: &JointLayout,
        trials: &[TrialRows],
        time: TimeSource,
    ) -> Result<(), ReadError> {
        /// Part of the rows in groups of one size, and how far apart values of one time must lie beside
        /// values of one series (chosen): of stamps that are rounded all of them follow one another.
        const ALIKE: f64 = 0.9;
        const APART: f64 = 10.0;
        let times = time.column().and_then(|column| self.column(column));
        let Some((times, output)) = times.zip(self.column(layout.output.column)) else {
            return Ok(());
        };
        let repeats = repeats(&times.values, trials);
        let rows: usize = trials.iter().map(|trial| trial.end - trial.start).sum();
        let groups = rows - repeats.len();
        // Rounded to the nearest.
        let size = (2 * rows + groups).checked_div(2 * groups).unwrap_or(1);
        let is_whole = (rows as f64 - (size * groups) as f64).abs() <= (1.0 - ALIKE) * rows as f64;
        if size < 2 || !is_whole {
            return Ok(());
        }
        let distance = |row: usize, before: usize| {
            let pair = output.values.get(row).zip(output.values.get(row.checked_sub(before)?));
            pair.map(|(value, before)| (value - before).abs()).filter(|apart| !apart.is_nan())
        };
        let of = |before: usize| {
            let apart: Vec<f64> = repeats.iter().filter_map(|row| distance(*row, before)).collect();
            median(&apart).unwrap_or_default()
        };
        if of(1) > APART * of(size) {
            return Err(ReadError::SeveralSeries {
                path: self.head.path.clone(),
                column: self.header(layout.output.column),
                size,
            });
        }
        Ok(())
    }
}

/// The rows at the time of the row before in their trial.
fn repeats(times: &[f64], trials: &[TrialRows]) -> Vec<usize> {
    let rows = trials.iter().flat_map(|trial| trial.start + 1..trial.end);
    rows.filter(|row| times.get(*row) == times.get(row - 1)).collect()
}
