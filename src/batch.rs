//! All joints and trials in parallel; the only file that names rayon.
//!
//! Each trial is computed by one thread alone and results come back in the order of the
//! input, so that they are the same bit for bit on any number of threads.

use rayon::prelude::*;

use crate::delay::{EstimateError, Settings, TrialEstimate, estimate};
use crate::experiment::Joint;

/// The delays of one joint in all its trials.
#[derive(Clone, Debug, PartialEq)]
pub struct JointEstimate {
    /// One result per trial of the joint, in the same order.
    pub trials: Vec<Result<TrialEstimate, EstimateError>>,
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
/// # Errors
/// A joint fails when all its trials do, with the first trial's error.
pub fn estimate_joints(
    joints: &[Joint],
    settings: &Settings,
    done: impl Fn() + Sync,
) -> Vec<Result<JointEstimate, EstimateError>> {
    let one_joint = |joint: &Joint| {
        let one_trial = |trial| {
            let estimate = estimate(trial, settings);
            done();
            estimate
        };
        let trials: Vec<_> = joint.trials.par_iter().map(one_trial).collect();
        match trials.first() {
            Some(Err(first)) if trials.iter().all(Result::is_err) => Err(first.clone()),
            _ => Ok(JointEstimate { trials }),
        }
    };
    joints.par_iter().map(one_joint).collect()
}

/// Runs `work` on `threads` threads; on as many as there are processors without a number.
///
/// # Errors
/// When the threads cannot be started.
pub fn with_threads<T: Send>(
    threads: Option<usize>,
    work: impl FnOnce() -> T + Send,
) -> Result<T, rayon::ThreadPoolBuildError> {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads.unwrap_or(0)).build()?;
    Ok(pool.install(work))
}
