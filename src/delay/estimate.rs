//! From a trial to its delays: prepared, decided by the method, and every sample filled in.

use std::sync::Arc;

use super::coming_to_rest::ComingToRest;
use super::input_motion::{InputKind, InputMotion};
use super::method::Method;
use super::onset_model::OnsetModel;
use super::prepared::Prepared;
use super::profile::DelayProfile;
use super::settings::Settings;
use super::trial_estimate::{EstimateError, TrialEstimate};
use crate::experiment::{Record, Trial};

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
    Estimator::of(&[trial.clone()].into(), settings)?.estimate(trial)
}

/// Estimates all trials of a joint, which share the response behind their dead times.
pub fn estimate_joint(
    trials: &Record,
    settings: &Settings,
) -> Vec<Result<TrialEstimate, EstimateError>> {
    match Estimator::of(trials, settings) {
        Ok(estimator) => trials.iter().map(|trial| estimator.estimate(trial)).collect(),
        Err(error) => trials.iter().map(|_| Err(error.clone())).collect(),
    }
}

/// Estimates the trials of a joint, which share what the method finds out from all of them.
#[derive(Debug)]
pub(crate) struct Estimator {
    /// Those that were asked for, with what the input is taken for.
    settings: Settings,
    model: Option<Arc<OnsetModel>>,
    rest: ComingToRest,
    motion: InputMotion,
}

impl Estimator {
    /// Looks at all trials of a joint.
    ///
    /// # Errors
    /// [`EstimateError::Settings`] when the settings make no sense.
    pub(crate) fn of(trials: &Record, settings: &Settings) -> Result<Self, EstimateError> {
        settings.check()?;
        let motion = InputMotion::of(trials);
        let mut settings = settings.with_input(&motion);
        if settings.input == InputKind::Continuous {
            // Without steps nothing is smoothed: no filter has to fit.
            settings.low_pass = None;
        }
        // To the letter of the paper, and of a record that still grows, Algorithm 1 is what there is.
        if settings.method == Method::AUTO && (settings.paper || settings.grows) {
            settings.method = Method::TWO_LINE;
        }
        let rest = ComingToRest::of(trials, &settings);
        let model = settings.method.spec().has_intervals.then(|| {
            // Onsets are found in what was measured.
            let unsmoothed = Settings { low_pass: None, ..settings.clone() };
            let mut prepared = Prepared::all(trials, &unsmoothed);
            for trial in &mut prepared {
                rest.bound(trial, &settings.at(trial.period));
            }
            let period = prepared.first().map(|trial| trial.period);
            // A response is looked for in the trials of the first one's period.
            let settings = period.map_or_else(|| settings.clone(), |period| settings.at(period));
            settings.method.shared(&prepared, &settings)
        });
        Ok(Self { settings, model: model.flatten().map(Arc::new), rest, motion })
    }

    /// How the input of the joint moves.
    pub(crate) fn motion(&self) -> InputMotion {
        self.motion
    }

    /// Estimates one trial of the joint.
    ///
    /// # Errors
    /// [`EstimateError::Filter`] when the filter does not fit this trial.
    pub(crate) fn estimate(&self, trial: &Trial) -> Result<TrialEstimate, EstimateError> {
        let settings = self.settings.at(trial.period());
        let mut prepared = Prepared::of(trial, &settings)?;
        self.rest.bound(&mut prepared, &settings);
        let decisions = settings.method.decide(&prepared, self.model.as_deref(), &settings);
        let profile = DelayProfile::of(&decisions, trial.len(), settings.interpolation);
        let (label, smoothed) = (trial.label().to_owned(), prepared.smoothed);
        let (onset_model, tracking) = (self.model.clone(), self.rest.tracking());
        Ok(TrialEstimate { label, smoothed, decisions, profile, onset_model, tracking })
    }
}
