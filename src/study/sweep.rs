//! The delays of all joints with every setting of a grid.

use super::estimate::estimate_steps;
use crate::delay::EstimateError;
use crate::delay::sweep::{Grid, JointSweep, RunDelays};
use crate::delay::{InputMotion, Settings};
use crate::experiment::Joint;
use crate::explain::Workers;

/// The delays of a joint with all settings of a grid.
#[derive(Clone, Debug)]
pub struct SweptJoint {
    /// What came out.
    pub sweep: JointSweep,
    /// The runs that failed, by their index in the grid, and why.
    pub failed: Vec<(usize, EstimateError)>,
}

/// Estimates every joint with all settings of the grid that `of_joint` gives it, and shows how its delays
/// move; delays agree within `tolerance` samples. `done` is called after each run of a joint.
///
/// A joint fails when all runs do, with the first one's error.
pub fn sweep_joints(
    joints: &[Joint],
    of_joint: impl Fn(&Joint) -> Grid + Sync,
    tolerance: f64,
    done: impl Fn() + Sync,
    workers: &impl Workers,
) -> Vec<Result<SweptJoint, EstimateError>> {
    let one_run = |joint: &Joint, settings: &Settings| {
        let estimate = estimate_steps(joint, settings, &|| (), workers);
        done();
        let estimate = estimate?;
        let trials = estimate.trials.iter().map(|trial| trial.as_ref().ok());
        Ok(RunDelays::of(joint, trials, settings))
    };
    let one_joint = |joint: &Joint| {
        let grid = of_joint(joint);
        let is_continuous =
            |run: &Settings| run.takes_as_continuous(&InputMotion::of(&joint.trials));
        if grid.runs().first().is_some_and(is_continuous) {
            return Err(EstimateError::Continuous);
        }
        let runs = workers.map(grid.runs(), |settings| one_run(joint, settings));
        let mut failed = Vec::new();
        let succeeded = |(index, run): (usize, Result<_, EstimateError>)| {
            run.map_err(|error| failed.push((index, error))).ok()
        };
        let runs: Vec<_> = runs.into_iter().enumerate().map(succeeded).collect();
        match failed.first() {
            Some((_, first)) if failed.len() == runs.len() => Err(first.clone()),
            _ => Ok(SweptJoint {
                sweep: JointSweep::of(&grid, &joint.trials, &runs, tolerance),
                failed,
            }),
        }
    };
    workers.map(joints, one_joint)
}
