//! From a trial to its delays: prepared, decided by the method, and every sample filled in.

use std::sync::Arc;

use super::decision::{Decision, ReviewerVerdict};
use super::input_motion::{InputKind, InputMotion};
use super::neutral::Neutral;
use super::onset_model::OnsetModel;
use super::prepared::Prepared;
use super::profile::DelayProfile;
use super::settings::{FirstLast, Interpolation, Settings};
use super::spec::Method;
use super::stops::{Stops, stops};
use super::tracking::{Tracking, tracking};
use crate::experiment::{Record, Trial};
use crate::numerics::FilterError;

/// Why a trial has no estimate.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum EstimateError {
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
    /// The response of the joint after its dead times, where the method looks for it.
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

/// Estimates the delay of every input step of `trial` by the method of `settings`.
///
/// What the trials of a joint share is taken from this one alone; see
/// [`estimate_joint`] for several.
///
/// # Errors
/// [`EstimateError`] when the filter does not fit this trial. An input without a step is no error: there are no decisions then; nor is a
/// trial too short for two lines, whose decisions say so.
pub fn estimate(trial: &Trial, settings: &Settings) -> Result<TrialEstimate, EstimateError> {
    Estimator::of(&[trial.clone()].into(), settings).estimate(trial)
}

/// Estimates all trials of a joint, which share the response after their dead times.
pub fn estimate_joint(
    trials: &Record,
    settings: &Settings,
) -> Vec<Result<TrialEstimate, EstimateError>> {
    let estimator = Estimator::of(trials, settings);
    trials.iter().map(|trial| estimator.estimate(trial)).collect()
}

/// Estimates the trials of a joint, which share what the method finds out from all of them.
#[derive(Debug)]
pub(crate) struct Estimator {
    /// Those that were asked for, with what the input is taken for.
    settings: Settings,
    model: Option<Arc<OnsetModel>>,
    /// Where the output comes to rest where its input says, and else at which stops: not asked by the
    /// letter of the paper, and of a record that still grows or has no steps.
    tracking: Option<Tracking>,
    stops: Option<Stops>,
    motion: InputMotion,
}

impl Estimator {
    /// Looks at all trials of a joint.
    pub(crate) fn of(trials: &Record, settings: &Settings) -> Self {
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
        let asks = !settings.paper && !settings.grows && settings.input != InputKind::Continuous;
        let tracking = asks.then(|| tracking(trials)).flatten();
        let stops = asks.then(|| stops(trials)).flatten();
        let mut estimator = Self { settings, model: None, tracking, stops, motion };
        estimator.model = estimator.model_of(trials).map(Arc::new);
        estimator
    }

    /// What the method finds out from all `trials` of the joint.
    fn model_of(&self, trials: &Record) -> Option<OnsetModel> {
        let settings = &self.settings;
        if !settings.method.spec().has_intervals {
            return None;
        }
        // Onsets are found in what was measured.
        let unsmoothed = Settings { low_pass: None, ..settings.clone() };
        let mut prepared = Prepared::all(trials, &unsmoothed);
        for trial in &mut prepared {
            self.bound(trial, &settings.at(trial.period));
        }
        // A response is looked for in the trials of the first one's period.
        let settings = settings.at(prepared.first()?.period);
        settings.method.shared(&prepared, Neutral::of(trials), &settings)
    }

    /// Bounds what says anything of each step of `trial` by where the output comes to rest.
    fn bound(&self, trial: &mut Prepared<'_>, settings: &Settings) {
        if let Some(tracking) = &self.tracking {
            tracking.bound(trial, settings);
        } else if let Some(stops) = &self.stops {
            stops.bound(trial);
        }
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
        self.bound(&mut prepared, &settings);
        let decisions = settings.method.decide(&prepared, self.model.as_deref(), &settings);
        let profile = DelayProfile::of(&decisions, trial.len(), settings.interpolation);
        let (label, smoothed) = (trial.label().to_owned(), prepared.smoothed);
        let (onset_model, tracking) = (self.model.clone(), self.tracking);
        Ok(TrialEstimate { label, smoothed, decisions, profile, onset_model, tracking })
    }
}

/// The dead time of every change of the input in all `trials` of a joint in seconds, by the best
/// method there is; none where nothing happened or it cannot be determined.
///
/// # Errors
/// [`EstimateError`], when a trial cannot be estimated.
///
/// # Examples
/// ```
/// use tauscope::delay::step_delays;
/// use tauscope::experiment::Trial;
/// use tauscope::units::SamplePeriod;
///
/// // The output follows 12 samples later.
/// let input: Vec<f64> = (0..200).map(|k| if k < 100 { 0.0 } else { 1.0 }).collect();
/// let output: Vec<f64> = (0..200).map(|k| 0.2 * f64::from((k - 112).max(0))).collect();
/// let period = SamplePeriod::from_seconds(0.01).unwrap();
/// let trial = Trial::new("swing", 0.0, period, input, output).unwrap();
/// let delays = step_delays(&[trial].into()).unwrap();
/// assert!((delays[0][0].unwrap() - 0.12).abs() < 1e-6);
/// ```
pub fn step_delays(trials: &Record) -> Result<Vec<Vec<Option<f64>>>, EstimateError> {
    // A line between the samples of a slow sensor looks like a lag: what is asked then is where the output
    // bends, without one.
    let is_interpolated = trials.iter().any(|trial| !trial.interpolated().is_empty());
    let method = if is_interpolated { Method::HINGE } else { Method::AUTO };
    let settings = Settings { first_last: FirstLast::Keep, ..Settings::of(method) };
    let estimates = estimate_joint(trials, &settings);
    let of = |(trial, estimate): (&Trial, Result<_, EstimateError>)| {
        let estimate: TrialEstimate = estimate?;
        let period_s = trial.period().seconds();
        let decisions = estimate.decisions.iter();
        let decisions = decisions.map(|decision| Some(decision.accepted_delay()? * period_s));
        Ok(decisions.collect())
    };
    trials.iter().zip(estimates).map(of).collect()
}
