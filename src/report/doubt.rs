//! Decisions in the order of their doubt.

use super::EstimatedJoint;
use crate::delay::{Decision, Doubt};
use crate::experiment::Trial;

/// A decision with its doubt.
#[derive(Clone, Debug)]
pub(crate) struct Doubted<'a> {
    pub(crate) trial: &'a Trial,
    pub(crate) decision: &'a Decision,
    pub(crate) doubt: Doubt,
}

/// All decisions on `joint`, the most doubtful first; equally doubtful ones in their order.
pub(crate) fn by_doubt(joint: EstimatedJoint<'_>) -> Vec<Doubted<'_>> {
    let trials = joint.joint.trials.iter().zip(&joint.estimate.trials);
    let mut all = Vec::new();
    for (trial, found) in trials.filter_map(|(trial, found)| Some((trial, found.as_ref().ok()?))) {
        let output = found.smoothed.as_deref().unwrap_or(trial.output());
        let doubted = |decision| Doubted { trial, decision, doubt: decision.doubt(output) };
        all.extend(found.decisions.iter().map(|decision: &Decision| doubted(decision)));
    }
    all.sort_by(|a, b| b.doubt.value().total_cmp(&a.doubt.value()));
    all
}
