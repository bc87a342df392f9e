//! What is known about each step because it was made.

use crate::clock::Clock;
use crate::drive::Step;

/// Label of the only trial, in the truth.
pub const TRIAL: &str = "1";

/// The truth about one step of one joint's input.
#[derive(Clone, Debug, PartialEq)]
pub struct StepTruth {
    /// Name of the joint.
    pub joint: String,
    /// Label of the trial.
    pub trial: String,
    /// Number of the step in the trial, from 1.
    pub i: usize,
    /// 1-based number of the sample that first shows the new level.
    pub p: usize,
    /// Level before the step, in input units.
    pub input_before: f64,
    /// Level after the step, in input units.
    pub input_after: f64,
    /// Time from sample `p` to the moment the level begins to act, in seconds.
    pub delay_s: f64,
    /// That time in sample periods, not rounded.
    pub delay_samples: f64,
    /// Samples at the new level: up to the next step or the end of the record.
    pub hold_samples: usize,
    /// Change of the steady slope of the output that this step causes, in output
    /// units per sample, from the level that acted before it: 0 inside a dead band
    /// and for a step that was overtaken. Also given for a step whose delay reaches
    /// beyond the end of the record. Of a cylinder, the change that came about until
    /// the next step began to act.
    pub slope_change: f64,
    /// Whether a later step acted first, so that this one never did.
    pub overtaken: bool,
}

/// The truth about each of `steps`, in their order, with the change of speed that each
/// caused; none for one that was overtaken.
pub(crate) fn truth_of(
    joint: &str,
    steps: &[Step],
    speed_changes: Vec<Option<f64>>,
    clock: &Clock,
) -> Vec<StepTruth> {
    let ends = steps.iter().skip(1).map(|next| next.sample);
    let ends = ends.chain([clock.samples + 1]);
    let period_s = clock.period_s;
    let steps = steps.iter().zip(speed_changes).zip(ends).enumerate();
    let truth = steps.map(|(index, ((step, change), end))| StepTruth {
        joint: joint.to_owned(),
        trial: TRIAL.to_owned(),
        i: index + 1,
        p: step.sample,
        input_before: step.before,
        input_after: step.after,
        delay_s: step.delay_s,
        delay_samples: step.delay_s / period_s,
        hold_samples: end - step.sample,
        slope_change: change.unwrap_or(0.0) * period_s,
        overtaken: change.is_none(),
    });
    truth.collect()
}
