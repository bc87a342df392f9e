//! From a trial to its delays: prepared, decided by the method, and every sample filled in.

use super::prepared::Prepared;
use super::profile::DelayProfile;
use super::registry;
use super::response::Lag;
use super::settings::Settings;
use super::trial_estimate::{EstimateError, TrialEstimate};
use crate::experiment::Trial;

/// Estimates the delay of every input step of `trial` by the method of `settings`.
///
/// What the trials of a joint share is taken from this one alone; see
/// [`estimate_joint`] for several.
///
/// # Errors
/// [`EstimateError`] when the settings make no sense or the filter does not fit this
/// trial. An input without a step is no error: there are no decisions then; nor is a
/// trial too short for two lines, whose decisions say so.
pub fn estimate(trial: &Trial, settings: &Settings) -> Result<TrialEstimate, EstimateError> {
    let shared = Shared::of(std::slice::from_ref(trial), settings)?;
    shared.estimate(trial, settings)
}

/// Estimates all trials of a joint, which share what its lag looks like.
pub fn estimate_joint(
    trials: &[Trial],
    settings: &Settings,
) -> Vec<Result<TrialEstimate, EstimateError>> {
    match Shared::of(trials, settings) {
        Ok(shared) => trials.iter().map(|trial| shared.estimate(trial, settings)).collect(),
        Err(error) => trials.iter().map(|_| Err(error.clone())).collect(),
    }
}

/// What all trials of a joint have in common.
#[derive(Clone, Debug)]
pub struct Shared {
    lag: Option<Lag>,
}

impl Shared {
    /// Looks at all trials of a joint.
    ///
    /// # Errors
    /// [`EstimateError::Settings`] when the settings make no sense.
    pub fn of(trials: &[Trial], settings: &Settings) -> Result<Self, EstimateError> {
        settings.check()?;
        let prepared: Vec<_> = if settings.method.shares_a_lag() {
            trials.iter().filter_map(|trial| Prepared::of(trial, settings).ok()).collect()
        } else {
            Vec::new()
        };
        Ok(Self { lag: registry::lag_of(&prepared, settings) })
    }

    /// Estimates one trial of the joint.
    ///
    /// # Errors
    /// [`EstimateError::Filter`] when the filter does not fit this trial.
    pub fn estimate(
        &self,
        trial: &Trial,
        settings: &Settings,
    ) -> Result<TrialEstimate, EstimateError> {
        let prepared = Prepared::of(trial, settings)?;
        let decisions = registry::decide_all(&prepared, self.lag.as_ref(), settings);
        let profile = DelayProfile::of(&decisions, trial.len(), settings.interpolation);
        let (lag, smoothed) = (self.lag.clone(), prepared.smoothed);
        Ok(TrialEstimate { label: trial.label().to_owned(), smoothed, decisions, profile, lag })
    }
}
