//! The delays of one trial, and why a trial has none.

use std::sync::Arc;

use super::decision::Decision;
use super::onset_model::OnsetModel;
use super::profile::DelayProfile;
use super::reviewer_verdict::ReviewerVerdict;
use super::settings::{Interpolation, SettingsError};
use super::tracking::Tracking;
use crate::numerics::FilterError;

/// Why a trial has no estimate.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum EstimateError {
    /// The settings make no sense.
    #[error(transparent)]
    Settings(#[from] SettingsError),
    /// The output cannot be smoothed as asked.
    #[error(transparent)]
    Filter(#[from] FilterError),
    /// Every trial of a joint is shorter than two rows of β samples.
    #[error("the longest trial has {samples} samples, but two lines need at least 2β = {needed}")]
    TooFewSamples {
        /// Samples of the longest trial.
        samples: usize,
        /// Samples it needs.
        needed: usize,
    },
    /// The input has no steps whose delays could be varied.
    #[error(
        "the input moves all the time: there is one dead time over the record, on which none of \
         these settings has an influence"
    )]
    Continuous,
}

/// The delays of one trial of one joint, with all evidence.
#[derive(Clone, Debug, PartialEq)]
pub struct TrialEstimate {
    /// The trial's label.
    pub label: String,
    /// The output that the lines were fitted to; `None` when it is the measured one.
    pub smoothed: Option<Vec<f64>>,
    /// One decision per input step, in order.
    pub decisions: Vec<Decision>,
    /// The delay of every sample.
    pub profile: DelayProfile,
    /// The response of the joint behind its dead times, where the method looks for it.
    pub onset_model: Option<Arc<OnsetModel>>,
    /// Where the output comes to rest, where its input says that: its arrivals answer no step.
    pub tracking: Option<Tracking>,
}

impl TrialEstimate {
    /// Overrides the decision on the step `number` by a reviewer's verdict; whether there is one.
    /// The delay of every sample follows.
    pub fn review(
        &mut self,
        number: usize,
        verdict: ReviewerVerdict,
        between: Interpolation,
    ) -> bool {
        let samples = self.profile.iter().len();
        let Some(decision) = self.decisions.iter_mut().find(|known| known.number == number) else {
            return false;
        };
        decision.reviewer_verdict = Some(Box::new(verdict));
        self.profile = DelayProfile::of(&self.decisions, samples, between);
        true
    }
}
