//! A joint with its estimate.

use crate::delay::{AgainstState, DelayTable, Neutral, OnsetModel, Tracking};
use crate::experiment::Joint;
use crate::study::JointEstimate;

/// A joint as it was measured, and its delays.
#[derive(Clone, Copy, Debug)]
pub struct EstimatedJoint<'a> {
    /// What was measured.
    pub joint: &'a Joint,
    /// What was estimated from it.
    pub estimate: &'a JointEstimate,
}

impl EstimatedJoint<'_> {
    /// The response behind its dead times, where the method fits one.
    pub fn onset_model(&self) -> Option<&OnsetModel> {
        self.estimate.estimated().find_map(|trial| trial.onset_model.as_deref())
    }

    /// Where its output comes to rest, where its input says that.
    pub fn tracking(&self) -> Option<Tracking> {
        self.estimate.estimated().find_map(|trial| trial.tracking)
    }

    /// The joint's delays by kind of step and level.
    pub fn delay_table(&self) -> DelayTable {
        let estimates = self.estimate.trials.iter().map(|trial| trial.as_ref().ok());
        DelayTable::of(self.joint, estimates)
    }

    /// The joint's accepted delays against its state.
    pub fn against_state(&self) -> AgainstState {
        self.against_state_about(Neutral::of(&self.joint.trials).as_ref())
    }

    /// The joint's accepted delays against its state about a known neutral input.
    pub(super) fn against_state_about(&self, neutral: Option<&Neutral>) -> AgainstState {
        let estimates = self.estimate.trials.iter().map(|trial| trial.as_ref().ok());
        AgainstState::of(self.joint, neutral, estimates)
    }
}
