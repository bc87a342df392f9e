//! What was read and what came out of it.

use crate::delay::Settings;
use crate::experiment::Experiment;
use crate::report::{Against, EstimatedJoint};
use crate::study::OtherResult;

/// The joints that have an estimate with some settings.
pub(super) type Run<'a> = (&'a Settings, &'a [EstimatedJoint<'a>]);

/// What was read and what came out.
#[derive(Clone, Copy)]
pub(super) struct Estimated<'a> {
    pub(super) experiment: &'a Experiment,
    /// The answer: what came out by the first method.
    pub(super) joints: &'a [EstimatedJoint<'a>],
    pub(super) settings: &'a Settings,
    /// What came out by each method.
    pub(super) runs: &'a [Run<'a>],
    /// What is shown beside the answer.
    pub(super) others: &'a [OtherResult],
    /// How it differs from the answer.
    pub(super) against: &'a [Against<'a>],
}
