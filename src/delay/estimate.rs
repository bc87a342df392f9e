//! Algorithm 1: step by step, since each segment hangs on the verdict before it.

use std::fmt;

use serde::Serialize;

use super::condition::{Check, Condition, Facts, Outcome};
use super::profile::{DelayProfile, Interpolation};
use super::search::{Candidate, Candidates};
use super::segment::Segment;
use super::steps::{InputStep, input_steps};
use crate::experiment::Trial;
use crate::filter::{FilterError, LowPass};
use crate::units::signed;

/// Settings of Algorithm 1; the default is the paper's way.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Settings {
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
}

impl Default for Settings {
    fn default() -> Self {
        Self {
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
        self.breakpoint().filter(|_| accepted).map(|best| best.delay as f64)
    }
}

/// Estimates the delay of every input step of `trial`.
///
/// For step `i` at sample `p_i` the segment runs from `r_i` to `p_(i+1) + α`, with
/// `r_i = q_(i−1)` if step `i−1` was accepted and `p_i − α` otherwise. The pair of lines
/// with the least squared error breaks at `q_i`; the delay is `δ_i = q_i − p_i`.
///
/// # Errors
/// [`EstimateError`] when the settings make no sense or the filter does not fit this
/// trial. An input without a step is no error: there are no decisions then; nor is a
/// trial too short for two lines, whose decisions say so.
///
/// # References
/// Albrecht and Taylor, Algorithm 1 (time-varying delays of hydraulic manipulators).
pub fn estimate(trial: &Trial, settings: &Settings) -> Result<TrialEstimate, EstimateError> {
    settings.check()?;
    let samples = trial.len();
    let smooth = |filter: LowPass| filter.smooth(trial.output(), trial.period());
    let smoothed = settings.low_pass.map(smooth).transpose()?;
    let output = smoothed.as_deref().unwrap_or(trial.output());
    let steps = input_steps(trial.input(), settings.min_step);
    let mut decisions: Vec<Decision> = Vec::with_capacity(steps.len());
    for index in 0..steps.len() {
        let decision = decide(&steps, index, output, decisions.last(), settings);
        decisions.extend(decision);
    }
    let profile = DelayProfile::of(&decisions, samples, settings.interpolation);
    Ok(TrialEstimate { label: trial.label().to_owned(), smoothed, decisions, profile })
}

/// The decision on step `index`, after the one `before` it.
fn decide(
    steps: &[InputStep],
    index: usize,
    output: &[f64],
    before: Option<&Decision>,
    settings: &Settings,
) -> Option<Decision> {
    let input_step = *steps.get(index)?;
    let samples = output.len();
    let p = input_step.sample;
    // Behind the last step the trial's end stands in for the next one.
    let next = steps.get(index + 1).map_or(samples + 1, |next| next.sample);
    let accepted = before.filter(|before| before.verdict() == Verdict::Accepted);
    let previous = accepted.and_then(Decision::breakpoint);
    let before_step = p.saturating_sub(settings.alpha);
    let breakpoint = previous.map(|best| best.candidate.breakpoint);
    let latest = settings.max_delay.map_or(usize::MAX, |delay| p.saturating_add(delay));
    let first = match (breakpoint, settings.max_delay) {
        (None, _) => before_step,
        (Some(breakpoint), None) => breakpoint,
        // What came long before the step is none of its business.
        (Some(breakpoint), Some(_)) => breakpoint.max(before_step),
    };
    let last = next.min(latest).saturating_add(settings.alpha);
    let segment = Segment::clipped(first, last, samples);
    let values = output.get(segment.indices()).unwrap_or_default();
    let candidates = Candidates::search_until(values, segment.first, settings.beta, latest);
    let facts = Facts {
        step: index + 1,
        steps: steps.len(),
        input_sample: p,
        hold: next - p,
        output: values,
        rows: values.len() / settings.beta,
        best: candidates.best(),
    };
    let checks = facts.check(settings);
    Some(Decision { number: index + 1, input_step, hold: next - p, segment, candidates, checks })
}
