//! Decisions in the order of their doubt.

use super::EstimatedJoint;
use crate::delay::{Decision, Doubt};
use crate::experiment::Trial;

/// A decision with its doubt.
#[derive(Clone, Debug)]
pub(crate) struct Doubted<'a> {
    pub(crate) trial: &'a Trial,
    /// The output that the lines were fitted to; none where it is the measured one.
    pub(crate) smoothed: Option<&'a [f64]>,
    pub(crate) decision: &'a Decision,
    pub(crate) doubt: Doubt,
}

/// All decisions on `joint`, the most doubtful first; equally doubtful ones in their order.
pub(crate) fn by_doubt(joint: EstimatedJoint<'_>) -> Vec<Doubted<'_>> {
    let trials = joint.joint.trials.iter().zip(&joint.estimate.trials);
    let mut all = Vec::new();
    for (trial, found) in trials.filter_map(|(trial, found)| Some((trial, found.as_ref().ok()?))) {
        let smoothed = found.smoothed.as_deref();
        let output = smoothed.unwrap_or(trial.output());
        all.extend(found.decisions.iter().map(|decision| {
            let doubt = decision.doubt(output);
            Doubted { trial, smoothed, decision, doubt }
        }));
    }
    all.sort_by(|a, b| b.doubt.value().total_cmp(&a.doubt.value()));
    all
}
