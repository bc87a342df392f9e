//! The delays of all joints, and when a joint fails.

use crate::delay::{
    DeadTime, DelayProfile, EstimateError, Estimator, InputMotion, Settings, TrialEstimate,
    dead_time,
};
use crate::experiment::{Joint, Trial};
use crate::explain::Workers;

/// The delays of one joint in all its trials.
#[derive(Clone, Debug, PartialEq)]
pub struct JointEstimate {
    /// One result per trial of the joint, in the same order.
    pub trials: Vec<Result<TrialEstimate, EstimateError>>,
    /// The settings that it was made with.
    pub settings: Settings,
    /// How the input moves.
    pub motion: InputMotion,
    /// The dead time over the record, instead of one per step, where the input moves all the
    /// time.
    pub dead_time: Option<DeadTime>,
}

impl JointEstimate {
    /// The trials that have an estimate.
    pub fn estimated(&self) -> impl Iterator<Item = &TrialEstimate> + '_ {
        self.trials.iter().filter_map(|trial| trial.as_ref().ok())
    }

    /// Why the trials that have none do not.
    pub fn failed(&self) -> impl Iterator<Item = &EstimateError> + '_ {
        self.trials.iter().filter_map(|trial| trial.as_ref().err())
    }
}

/// Estimates every trial of every joint; `done` is called after each of them.
///
/// A joint fails when all its trials do, with the first trial's error, or when they are all
/// too short for two lines.
pub fn estimate_joints(
    joints: &[Joint],
    settings: &Settings,
    done: impl Fn() + Sync,
    workers: &impl Workers,
) -> Vec<Result<JointEstimate, EstimateError>> {
    estimate_each(joints, |_| settings.clone(), done, workers)
}

/// Estimates every trial of every joint with the settings that are `asked` for that joint.
pub(crate) fn estimate_each(
    joints: &[Joint],
    asked: impl Fn(&Joint) -> Settings + Sync,
    done: impl Fn() + Sync,
    workers: &impl Workers,
) -> Vec<Result<JointEstimate, EstimateError>> {
    workers.map(joints, |joint| estimate_one(joint, &asked(joint), &done, workers))
}

/// Estimates one joint, and its dead time where its input moves all the time.
fn estimate_one(
    joint: &Joint,
    settings: &Settings,
    done: &(impl Fn() + Sync),
    workers: &impl Workers,
) -> Result<JointEstimate, EstimateError> {
    let mut estimate = estimate_steps(joint, settings, done, workers)?;
    if settings.takes_as_continuous(&estimate.motion) {
        let found = dead_time(&joint.trials, settings);
        let trials = joint.trials.iter().zip(&mut estimate.trials).enumerate();
        for (number, (trial, estimate)) in trials {
            if let Ok(estimate) = estimate {
                estimate.profile = DelayProfile::of_windows(&found.windows, number, trial);
            }
        }
        estimate.dead_time = Some(found);
    }
    Ok(estimate)
}

/// Estimates the delay of every step of one joint.
pub(super) fn estimate_steps(
    joint: &Joint,
    settings: &Settings,
    done: &(impl Fn() + Sync),
    workers: &impl Workers,
) -> Result<JointEstimate, EstimateError> {
    let needed = |trial: &Trial| settings.at(trial.period()).beta.saturating_mul(2);
    let longest = joint.trials.iter().max_by_key(|trial| trial.len());
    if let Some(longest) = longest.filter(|_| joint.trials.iter().all(|t| t.len() < needed(t))) {
        let (samples, needed) = (longest.len(), needed(longest));
        return Err(EstimateError::TooFewSamples { samples, needed });
    }
    let estimator = Estimator::of(&joint.trials, settings);
    let one_trial = |trial: &Trial| {
        let estimate = estimator.estimate(trial);
        done();
        estimate
    };
    let trials = workers.map(&joint.trials, one_trial);
    match trials.first() {
        Some(Err(first)) if trials.iter().all(Result::is_err) => Err(first.clone()),
        _ => Ok(JointEstimate {
            trials,
            settings: settings.clone(),
            motion: estimator.motion(),
            dead_time: None,
        }),
    }
}
