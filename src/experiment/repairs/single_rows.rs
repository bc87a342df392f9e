//! Trials of one row, from which no period follows, as where a counter of trials is late by a row.

use super::repair::Repair;
use crate::experiment::log::Log;
use crate::experiment::table::TrialRows;

pub(super) struct SingleRows;

fn is_long(trial: &TrialRows) -> bool {
    trial.end > trial.start + 1
}

impl Repair for SingleRows {
    /// None where all trials are of one row: that is an error of the log.
    fn detect(log: &Log<'_>) -> impl IntoIterator<Item = Self> {
        let some_are_long = log.trials.iter().any(is_long);
        (some_are_long && !log.trials.iter().all(is_long)).then_some(Self)
    }

    fn apply(self, log: &mut Log<'_>) -> Option<String> {
        let (long, alone) = std::mem::take(&mut log.trials).into_iter().partition(is_long);
        log.trials = long;
        let alone: Vec<TrialRows> = alone;
        let label = &alone.first()?.label;
        Some(log.named(&match alone.len() {
            1 => format!("trial `{label}` has one row only and is left out"),
            count => {
                format!("{count} trials have one row only and are left out, the first is `{label}`")
            }
        }))
    }
}
