//! The delays of a trial: settings, decisions, and what becomes of a step.

use std::fmt;

use serde::Serialize;

use super::condition::{Check, Condition, Outcome};
use super::method::{self, Method};
use super::profile::{DelayProfile, Interpolation};
use super::response::Lag;
use super::search::{Candidate, Candidates};
use super::segment::Segment;
use super::steps::{InputStep, input_steps};
use crate::experiment::Trial;
use crate::numerics::{FilterError, LowPass};
use crate::units::{SamplePeriod, signed};

/// Settings of a method; the default is the paper's way.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Settings {
    /// How a delay is found.
    pub method: Method,
    /// α: samples that a segment reaches beyond its input steps.
    pub alpha: usize,
    /// β: samples per row of Φ, so the distance between two candidates.
    pub beta: usize,
    /// Zero-phase low-pass on the output before anything else.
    pub low_pass: Option<LowPass>,
    /// `τ_min`: the shortest hold, in samples, that is accepted.
    pub min_delay: usize,
    /// The longest delay that is looked for, in samples; a segment then runs from
    /// `p_i − α` at the earliest to `p_i + max_delay + α` at the latest. For holds so long
    /// that the output meets something else on its way, such as an end stop. The paper has
    /// no such limit.
    pub max_delay: Option<usize>,
    /// Lower and upper limit that the output must stay between.
    pub output_limits: Option<(f64, f64)>,
    /// Smallest change of slope that is accepted, output units per sample.
    pub min_slope_change: f64,
    /// Squared error that an accepted step must stay below, output units squared.
    pub max_sse: Option<f64>,
    /// Judge the first and the last step of a trial like the others.
    pub keep_first_last: bool,
    /// Smallest change of the input that is a step, input units; 0 for any change.
    pub min_step: f64,
    /// How `τ_k` goes on between two steps.
    pub interpolation: Interpolation,
    /// Reject a step as `nothing_happened` unless its change of slope is this unlikely to
    /// be noise: 0.99 takes noise for a reaction in one step of a hundred. None accepts it
    /// untested, as the paper does.
    pub confidence: Option<f64>,
    /// How often an interval of a delay is to hold the true one.
    pub interval: f64,
}

/// How sure a reaction must be where nothing else is asked for.
const CONFIDENCE: f64 = 0.99;

impl Settings {
    /// The settings that suit `method`. All but the paper's look at the output as it was
    /// measured, since smoothing takes from noise what intervals are made of.
    pub fn of(method: Method) -> Self {
        match method {
            Method::TwoLine => Self::default(),
            Method::Hinge | Method::LagAware => {
                Self { method, low_pass: None, confidence: Some(CONFIDENCE), ..Self::default() }
            }
        }
    }
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            method: Method::TwoLine,
            alpha: 10,
            beta: 5,
            low_pass: Some(LowPass { cutoff_hz: 5.0, order: 4 }),
            min_delay: 0,
            max_delay: None,
            output_limits: None,
            min_slope_change: 0.0,
            max_sse: None,
            keep_first_last: false,
            min_step: 0.0,
            interpolation: Interpolation::Hold,
            confidence: None,
            interval: 0.95,
        }
    }
}

/// Why settings make no sense, whatever the log.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SettingsError {
    /// α or β is zero.
    #[error("{name} is 0, but must be at least 1 sample")]
    Zero {
        /// The setting's name.
        name: &'static str,
    },
    /// The limits of the output are not in order.
    #[error("the output limits {low},{high} are not in order: the lower one comes first")]
    LimitsSwapped {
        /// The first limit.
        low: f64,
        /// The second limit.
        high: f64,
    },
    /// A probability is not one.
    #[error("{name} is {value}, but must be between 0 and 1, as in 0.99")]
    Probability {
        /// The setting's name.
        name: &'static str,
        /// What was given.
        value: f64,
    },
    /// A threshold is negative or not a number.
    #[error("{name} is {value}, but must be a number from 0 up")]
    Threshold {
        /// The setting's name.
        name: &'static str,
        /// What was given.
        value: f64,
    },
}

impl Settings {
    /// Checks what can be checked without a log.
    ///
    /// # Errors
    /// [`SettingsError`], the first that is found.
    pub fn check(&self) -> Result<(), SettingsError> {
        for (name, samples) in [("alpha", self.alpha), ("beta", self.beta)] {
            if samples == 0 {
                return Err(SettingsError::Zero { name });
            }
        }
        if let Some((low, high)) = self.output_limits
            && (low >= high || low.is_nan() || high.is_nan())
        {
            return Err(SettingsError::LimitsSwapped { low, high });
        }
        let probabilities =
            [("confidence", self.confidence.unwrap_or(0.5)), ("interval", self.interval)];
        for (name, value) in probabilities {
            if !(value > 0.0 && value < 1.0) {
                return Err(SettingsError::Probability { name, value });
            }
        }
        let thresholds = [
            ("min-slope-change", self.min_slope_change),
            ("max-sse", self.max_sse.unwrap_or_default()),
            ("min-step", self.min_step),
        ];
        match thresholds.into_iter().find(|(_, value)| value.is_nan() || *value < 0.0) {
            Some((name, value)) => Err(SettingsError::Threshold { name, value }),
            None => Ok(()),
        }
    }
}

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
    #[error(
        "the longest trial has {samples} samples, but two lines need at least 2β = {needed}; \
         choose a smaller `--beta`"
    )]
    TooFewSamples {
        /// Samples of the longest trial.
        samples: usize,
        /// Samples it needs.
        needed: usize,
    },
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
    /// How the joint follows after its dead time, where the method looks for it.
    pub lag: Option<Lag>,
}

/// A delay finer than a sample, and how well it is known; all in samples.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FineDelay {
    /// The delay that the true one is as likely below as above.
    pub delay: f64,
    /// Lower end of its interval.
    pub low: f64,
    /// Upper end of its interval.
    pub high: f64,
    /// How often such an interval holds the true delay.
    pub confidence: f64,
}

/// The decision on one input step, with the evidence for it.
#[derive(Clone, Debug, PartialEq)]
pub struct Decision {
    /// `i`: number of the step in its trial, from 1.
    pub number: usize,
    /// `p_i` and the levels of the input.
    pub input_step: InputStep,
    /// Samples to the next step, or to the end of the trial.
    pub hold: usize,
    /// The samples that were looked at.
    pub segment: Segment,
    /// Every pair of lines.
    pub candidates: Candidates,
    /// Every condition, in the order of [`Condition::ALL`].
    pub checks: Vec<Check>,
    /// The delay between samples, where the method tells it.
    pub fine: Option<FineDelay>,
}

/// The best breakpoint of a segment, accepted or not.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Breakpoint {
    /// The pair of lines.
    pub candidate: Candidate,
    /// `δ_i = q_i − p_i` in samples; negative when it comes before the input step.
    pub delay: i64,
}

/// What became of a step.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Verdict {
    /// Its delay counts.
    Accepted,
    /// It does not; the first condition that failed.
    Rejected(Condition),
}

impl fmt::Display for Verdict {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Accepted => f.write_str("accepted"),
            Self::Rejected(condition) => f.write_str(condition.id()),
        }
    }
}

impl Decision {
    /// The best breakpoint, if there was a candidate.
    pub fn breakpoint(&self) -> Option<Breakpoint> {
        let candidate = self.candidates.best()?;
        let delay = signed(candidate.breakpoint) - signed(self.input_step.sample);
        Some(Breakpoint { candidate, delay })
    }

    /// `p_(i+1)`: the sample of the next step, or the one behind the trial's last.
    pub fn next_sample(&self) -> usize {
        self.input_step.sample + self.hold
    }

    /// Accepted, or the first condition that failed.
    pub fn verdict(&self) -> Verdict {
        self.failed().next().map_or(Verdict::Accepted, Verdict::Rejected)
    }

    /// All conditions that failed.
    pub fn failed(&self) -> impl Iterator<Item = Condition> + '_ {
        let failed = self.checks.iter().filter(|check| check.outcome == Outcome::Failed);
        failed.map(|check| check.condition)
    }

    /// The delay in samples, if it was accepted.
    pub fn accepted_delay(&self) -> Option<f64> {
        let accepted = self.verdict() == Verdict::Accepted;
        self.delay().filter(|_| accepted)
    }

    /// The delay in samples, accepted or not, as finely as the method tells it.
    pub fn delay(&self) -> Option<f64> {
        let fine = self.fine.map(|fine| fine.delay);
        fine.or_else(|| self.breakpoint().map(|best| best.delay as f64))
    }
}

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
        Ok(Self { lag: method::lag_of(&prepared, settings) })
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
        let decisions = method::decide_all(&prepared, self.lag.as_ref(), settings);
        let profile = DelayProfile::of(&decisions, trial.len(), settings.interpolation);
        let (lag, smoothed) = (self.lag.clone(), prepared.smoothed);
        Ok(TrialEstimate { label: trial.label().to_owned(), smoothed, decisions, profile, lag })
    }
}

/// A trial as a method sees it.
pub(super) struct Prepared<'a> {
    pub(super) raw: &'a [f64],
    smoothed: Option<Vec<f64>>,
    pub(super) period: SamplePeriod,
    pub(super) steps: Vec<InputStep>,
}

impl<'a> Prepared<'a> {
    fn of(trial: &'a Trial, settings: &Settings) -> Result<Self, FilterError> {
        let smooth = |filter: LowPass| filter.smooth(trial.output(), trial.period());
        let smoothed = settings.low_pass.map(smooth).transpose()?;
        let steps = input_steps(trial.input(), settings.min_step);
        Ok(Self { raw: trial.output(), smoothed, period: trial.period(), steps })
    }

    /// What the method is to look at.
    pub(super) fn output(&self) -> &[f64] {
        self.smoothed.as_deref().unwrap_or(self.raw)
    }
}
