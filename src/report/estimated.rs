//! A joint with its estimate.

use crate::delay::{
    AgainstState, Decision, DelayTable, Neutral, OnsetModel, Tracking, TrialEstimate,
};
use crate::experiment::{Joint, Trial};
use crate::study::JointEstimate;

/// A joint as it was measured, and its delays.
#[derive(Clone, Copy, Debug)]
pub struct EstimatedJoint<'a> {
    /// What was measured.
    pub joint: &'a Joint,
    /// What was estimated from it.
    pub estimate: &'a JointEstimate,
}

impl<'a> EstimatedJoint<'a> {
    /// The trials that have an estimate, in their order.
    pub(crate) fn trials(&self) -> impl Iterator<Item = (&'a Trial, &'a TrialEstimate)> + use<'a> {
        let trials = self.joint.trials.iter().zip(&self.estimate.trials);
        trials.filter_map(|(trial, found)| Some((trial, found.as_ref().ok()?)))
    }

    /// The decisions on all input steps in their order, each with its trial and what was estimated of
    /// that.
    pub(crate) fn decisions(
        &self,
    ) -> impl Iterator<Item = (&'a Trial, &'a TrialEstimate, &'a Decision)> + use<'a> {
        self.trials().flat_map(|(trial, found)| {
            found.decisions.iter().map(move |decision| (trial, found, decision))
        })
    }

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
