//! `two-line`: Albrecht and Taylor's Algorithm 1, step by step, since each segment begins
//! where the verdict before it says.
//!
//! For step `i` at sample `p_i` the segment runs from `r_i` to `p_(i+1) + α`, with
//! `r_i = q_(i−1)` if step `i−1` was accepted and `p_i − α` otherwise. The pair of lines
//! with the least squared error breaks at `q_i`; the delay is `δ_i = q_i − p_i`.
//!
//! # References
//! Albrecht and Taylor, Algorithm 1 (time-varying delays of hydraulic manipulators).

use super::interface::DelayMethod;
use super::noise_test;
use super::step_context::StepContext;
use crate::delay::decision::{Decision, Verdict};
use crate::delay::lag::Lag;
use crate::delay::prepared::Prepared;
use crate::delay::search::Candidates;
use crate::delay::segment::Segment;
use crate::delay::settings::Settings;
use crate::delay::spec::{Method, MethodSpec, Scope};
use crate::delay::steps::InputStep;
use crate::numerics::LowPass;

static SPEC: MethodSpec = MethodSpec {
    id: "two-line",
    fits: "two-line regression",
    source: Some("Albrecht and Taylor, Algorithm 1"),
    summary: "Two regression lines (Albrecht and Taylor)",
    has_rows: true,
    has_intervals: false,
    scope: Scope::Segment,
    low_pass: Some(LowPass { cutoff_hz: 5.0, order: 4 }),
    confidence: None,
};

impl Method {
    /// Two regression lines that need not meet: Albrecht and Taylor's Algorithm 1.
    pub const TWO_LINE: Self = Self::of(&SPEC);
}

impl Default for Method {
    /// The paper's.
    fn default() -> Self {
        Self::TWO_LINE
    }
}

impl Default for Settings {
    /// The paper's.
    fn default() -> Self {
        Self::of(Method::default())
    }
}

pub(super) struct TwoLine;

impl DelayMethod for TwoLine {
    fn method(&self) -> Method {
        Method::TWO_LINE
    }

    fn decide(&self, trial: &Prepared<'_>, _: Option<&Lag>, settings: &Settings) -> Vec<Decision> {
        decide_all(trial.output(), trial.raw, &trial.steps, settings)
    }
}

/// The decisions on all `steps`; `output` is what the lines are fitted to, `raw` what was
/// measured.
fn decide_all(
    output: &[f64],
    raw: &[f64],
    steps: &[InputStep],
    settings: &Settings,
) -> Vec<Decision> {
    let mut decisions: Vec<Decision> = Vec::with_capacity(steps.len());
    for index in 0..steps.len() {
        let context = StepContext { steps, index, output, settings };
        decisions.push(decide(&context, decisions.last()));
    }
    if let Some(confidence) = settings.confidence {
        noise_test::judge(&mut decisions, raw, confidence);
    }
    decisions
}

/// The decision on a step, after the one `before` it.
fn decide(context: &StepContext<'_>, before: Option<&Decision>) -> Decision {
    let StepContext { output, settings, .. } = *context;
    let p = context.step().sample;
    let accepted = before.filter(|before| before.verdict() == Verdict::Accepted);
    let previous = accepted.and_then(Decision::breakpoint);
    let before_step = p.saturating_sub(settings.alpha);
    let breakpoint = previous.map(|best| best.candidate.breakpoint);
    let latest = settings.max_delay.map_or(usize::MAX, |delay| p.saturating_add(delay));
    // r_i = q_(i−1) if step i−1 was accepted, else p_i − α.
    let first = match (breakpoint, settings.max_delay) {
        (None, _) => before_step,
        (Some(breakpoint), None) => breakpoint,
        // What came long before the step is none of its business.
        (Some(breakpoint), Some(_)) => breakpoint.max(before_step),
    };
    let last = context.next_sample().min(latest).saturating_add(settings.alpha);
    let segment = Segment::clipped(first, last, output.len());
    let values = &output[segment.indices()];
    let candidates = Candidates::search_until(values, segment.first, settings.beta, latest);
    context.decision(segment, settings.beta, candidates, None)
}
