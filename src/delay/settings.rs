//! What is asked for: a method, and its settings.

use super::input_motion::{InputKind, InputMotion};
use super::spec::Method;
use crate::numerics::LowPass;
use crate::units::SamplePeriod;
use serde::Serialize;

/// How `τ_k` goes on between two steps.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Interpolation {
    /// `τ_k = δ_i` for `k = p_i … p_(i+1)`: the paper's.
    #[default]
    Hold,
    /// From `δ_i` at `p_i` in a line to `δ_(i+1)` at `p_(i+1)`; held where the next step
    /// was not accepted.
    Linear,
}

/// Whether the first and the last step of a trial are judged, which have no neighbour on one
/// side: the paper's condition 1.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum FirstLast {
    /// Rejected in a trial of more than three steps; judged like the others in one of three or
    /// fewer, such as a stroke from rest to rest, which has hardly any others.
    #[default]
    Auto,
    /// Rejected, as in the paper.
    Reject,
    /// Judged like the others.
    Keep,
}

impl FirstLast {
    /// Steps of a trial up to which its first and last are judged.
    pub(super) const FEW: usize = 3;

    /// Whether they are judged in a trial of so many steps.
    pub(crate) fn are_judged(self, steps: usize) -> bool {
        match self {
            Self::Auto => steps <= Self::FEW,
            Self::Reject => false,
            Self::Keep => true,
        }
    }
}

/// Which candidates a decision keeps.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum CandidateLines {
    /// All with both lines, which can be drawn then.
    #[default]
    All,
    /// The best one, and of the others their number, the second-best error and how far those lie
    /// that fit nearly as well, where the method compares many: enough for all but a drawing.
    Best,
}

/// The settings that were given in seconds; the others are numbers of samples.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct InSeconds {
    /// α.
    pub alpha: Option<f64>,
    /// β.
    pub beta: Option<f64>,
    /// `τ_min`.
    pub min_delay: Option<f64>,
    /// The longest delay that is looked for.
    pub max_delay: Option<f64>,
}

/// A method and its settings; the default is the onset model. Lengths and thresholds are no less than
/// zero, and probabilities lie between zero and one. The paper's search is that of
/// [`Method::TWO_LINE`], with what real logs need beside it, see [`Settings::paper`].
#[derive(Clone, Debug, PartialEq)]
#[expect(clippy::struct_excessive_bools, reason = "each is an option of its own")]
pub struct Settings {
    /// How a delay is found.
    pub method: Method,
    /// α: samples that a segment reaches beyond its input steps.
    pub alpha: usize,
    /// β: samples per row of Φ, so the distance between two candidates.
    pub beta: usize,
    /// Zero-phase low-pass on the output before anything else.
    pub low_pass: Option<LowPass>,
    /// Refuse a trial that is sampled too slowly for the low-pass. Else the low-pass is left
    /// out there: such a record holds nothing that it would remove.
    pub low_pass_required: bool,
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
    /// Whether the first and the last step of a trial are judged.
    pub first_last: FirstLast,
    /// Algorithm 1 to the letter: nothing is made of rest and of stops, so that a segment runs
    /// from step to step whatever the output does, and no step is `at_rest`.
    pub paper: bool,
    /// Whether delays are accepted although the onsets of a joint are no delays: its output leads the
    /// input, does not follow it, or reacts later than the next step.
    pub accept_anyway: bool,
    /// Smallest change of the input that is a step, input units; 0 for any change.
    pub min_step: f64,
    /// Whether the input is taken as steps or as moving all the time.
    pub input: InputKind,
    /// Whether the record still grows: nothing is then taken from the whole of it, neither whether
    /// the output tracks its input, nor what its sensor's noise is, and every change of
    /// the input is a step, as with `paper`.
    pub grows: bool,
    /// How `τ_k` goes on between two steps.
    pub interpolation: Interpolation,
    /// Reject a step as `nothing_happened` unless its change of slope is this unlikely to
    /// be noise: 0.99 takes noise for a reaction in one step of a hundred. None accepts it
    /// untested, as the paper does.
    pub confidence: Option<f64>,
    /// How often an interval of a delay is to hold the true one.
    pub interval: f64,
    /// Of which candidates a decision keeps both lines.
    pub lines: CandidateLines,
    /// Those of the lengths above that were given in seconds, which then count: how many samples
    /// they are depends on the trial, see [`Settings::at`].
    pub in_seconds: InSeconds,
}

/// How sure a reaction must be, for methods that test it unasked; chosen: noise then passes
/// for a reaction in one step of a hundred.
pub(crate) const CONFIDENCE: f64 = 0.99;

impl Settings {
    /// The settings that suit `method`: its own confidence, and else those of the paper's
    /// Algorithm 1, with intervals that hold 95 % of the true delays.
    pub fn of(method: Method) -> Self {
        Self {
            method,
            alpha: 10,
            beta: 5,
            low_pass: Some(LowPass { cutoff_hz: 5.0, order: 4 }),
            low_pass_required: false,
            min_delay: 0,
            max_delay: None,
            output_limits: None,
            min_slope_change: 0.0,
            max_sse: None,
            first_last: FirstLast::Auto,
            paper: false,
            accept_anyway: false,
            min_step: 0.0,
            input: InputKind::Auto,
            grows: false,
            interpolation: Interpolation::Hold,
            confidence: method.spec().has_intervals.then_some(CONFIDENCE),
            interval: 0.95,
            lines: CandidateLines::All,
            in_seconds: InSeconds::default(),
        }
    }
}

impl Default for Settings {
    /// Those of the onset model.
    fn default() -> Self {
        Self::of(Method::AUTO)
    }
}

impl Settings {
    /// The low-pass of a trial that is sampled every `period`.
    pub(crate) fn low_pass_at(&self, period: SamplePeriod) -> Option<LowPass> {
        let fits = |low_pass: &LowPass| low_pass.cutoff_hz < period.nyquist_hz();
        self.low_pass.filter(|low_pass| self.low_pass_required || fits(low_pass))
    }

    /// Whether an input that moves so is taken as moving all the time. One whose smallest step is
    /// given has steps.
    pub(crate) fn takes_as_continuous(&self, motion: &InputMotion) -> bool {
        match self.input {
            InputKind::Auto => self.min_step <= 0.0 && motion.is_continuous(),
            InputKind::Steps => false,
            InputKind::Continuous => true,
        }
    }

    /// These settings with the kind of input that moves so.
    pub(super) fn with_input(&self, motion: &InputMotion) -> Self {
        let is_continuous = self.takes_as_continuous(motion);
        let input = if is_continuous { InputKind::Continuous } else { InputKind::Steps };
        Self { input, ..self.clone() }
    }
}
