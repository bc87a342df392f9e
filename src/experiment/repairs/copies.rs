//! Rows that are copies of the one before, all over a log, as of a logger that is faster than its bus.

use super::Repair;
use crate::experiment::log::{Log, Times, repeats};

/// Part of the rows that repeat a time, at least: of fewer the clock says what they are.
const REPEATED: f64 = 0.1;

/// The rows that are copies.
pub(super) struct Copies(Vec<usize>);

impl Repair for Copies {
    /// None where any row that repeats a time says something new.
    fn detect(log: &Log<'_>) -> Vec<Self> {
        let Times::Stamps(times) = &log.times else { return Vec::new() };
        let repeats = repeats(times, &log.trials);
        let rows: usize = log.trials.iter().map(|trial| trial.end - trial.start).sum();
        let is_copy = |row: &usize| {
            log.table.columns.iter().all(|column| {
                let pair = column.values.get(*row).zip(column.values.get(row - 1));
                pair.is_some_and(|(value, before)| value.to_bits() == before.to_bits())
            })
        };
        let are_many = repeats.len() as f64 > REPEATED * rows as f64;
        if are_many && repeats.iter().all(is_copy) { vec![Self(repeats)] } else { Vec::new() }
    }

    fn apply(self, log: &mut Log<'_>) -> Option<String> {
        let is_kept = |row: &usize| self.0.binary_search(row).is_err();
        let kept =
            log.trials.iter().map(|trial| (trial.start..trial.end).filter(is_kept).collect());
        log.rows = Some(kept.collect());
        Some(
            log.named(&format!("{} rows are copies of the row before, and left out", self.0.len())),
        )
    }
}
