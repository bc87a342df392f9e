//! `auto`: the onset model whose response the joint's record supports, with Algorithm 1 beside it.
//!
//! The delay of a step is that of its [onset](crate::delay::OnsetModel); the candidates are those of
//! Algorithm 1, so that a reviewer sees both answers.

use std::sync::Arc;

use super::hinge;
use super::interface::{DelayMethod, Shared};
use super::step_context::StepContext;
use super::two_line;
use crate::delay::condition::Condition;
use crate::delay::decision::Decision;
use crate::delay::onset_model::{Obstacle, OnsetModel, StepOnset};
use crate::delay::prepared::Prepared;
use crate::delay::settings::{CONFIDENCE, Settings};
use crate::delay::spec::{Method, MethodSpec, Scope};
use crate::numerics::LowPass;
use crate::units::SamplePeriod;

static SPEC: MethodSpec = MethodSpec {
    id: "auto",
    fits: "onset model",
    source: None,
    summary: "The response that the record supports (bend, lag, oscillation, settling, slew), with \
              intervals; Algorithm 1's candidates beside it",
    has_rows: true,
    cuts_segments: true,
    has_intervals: true,
    scope: Scope::Response,
    low_pass: Some(LowPass { cutoff_hz: 5.0, order: 4 }),
    confidence: Some(CONFIDENCE),
};

impl Method {
    /// The onset model of the response that a joint's record supports.
    pub const AUTO: Self = Self::of(&SPEC);
}

impl Default for Method {
    /// The onset model.
    fn default() -> Self {
        Self::AUTO
    }
}

impl Default for Settings {
    /// Those of the onset model.
    fn default() -> Self {
        Self::of(Method::default())
    }
}

pub(super) struct Auto;

impl DelayMethod for Auto {
    fn method(&self) -> Method {
        Method::AUTO
    }

    fn shared(&self, trials: &[Prepared<'_>], settings: &Settings) -> Shared {
        Shared { onset_model: OnsetModel::of(trials, settings).map(Arc::new), ..Shared::default() }
    }

    fn decide(&self, trial: &Prepared<'_>, shared: &Shared, settings: &Settings) -> Vec<Decision> {
        let untested = Settings { confidence: None, ..settings.clone() };
        let by_lines = two_line::decide_all(trial, &untested).into_iter().enumerate();
        let context = |index| StepContext { trial, index, settings };
        let Some(model) = shared.onset_model.as_deref() else {
            // Strokes, whose steps share no response: broken lines, with intervals that hold the first motion.
            let each = hinge::decide_by_broken_lines(trial, settings);
            let pairs = by_lines.zip(each);
            return pairs
                .map(|((index, lines), own)| with_own_onset(&context(index), lines, &own))
                .collect();
        };
        let obstacle = model.obstacle().filter(|_| !settings.accept_anyway);
        let all = by_lines.zip(model.onsets(trial, settings));
        all.map(|((index, lines), onset)| {
            let mut decision = answered(&context(index), lines, onset);
            if let Some(obstacle) = obstacle {
                rejected(&mut decision, obstacle, trial.period);
            }
            decision
        })
        .collect()
    }
}

/// Algorithm 1's decision on a step with the delay that was found of this step alone.
fn with_own_onset(context: &StepContext<'_>, by_lines: Decision, own: &Decision) -> Decision {
    let Decision { segment, candidates, .. } = by_lines;
    let mut decision = context.decision(segment, context.settings.beta, candidates, own.fine);
    let tested = own.checks.iter().find(|check| check.condition == Condition::NothingHappened);
    if let Some(check) = tested {
        decision.checks.put(check);
    }
    decision
}

/// Rejects a decision for what all onsets of the joint show.
fn rejected(decision: &mut Decision, obstacle: Obstacle, period: SamplePeriod) {
    let step = decision.input_step.sample as f64;
    match obstacle {
        Obstacle::Unrelated => decision.fail(Condition::NothingHappened, None, None),
        Obstacle::Leads(lead_s) => {
            let onset = step - lead_s / period.seconds();
            decision.fail(Condition::BeforeInput, Some(onset), Some(step));
        }
        Obstacle::BeyondHolds(delay_s) => {
            let delay = delay_s / period.seconds();
            decision.fail(Condition::ShortHold, Some(decision.hold as f64), Some(delay));
        }
    }
}

/// Algorithm 1's decision on a step with the onset for its answer.
fn answered(context: &StepContext<'_>, by_lines: Decision, onset: Option<StepOnset>) -> Decision {
    let settings = context.settings;
    let fine = onset.as_ref().map(|onset| onset.fine.not_before_its_step());
    let Decision { segment, candidates, .. } = by_lines;
    let mut decision = context.decision(segment, settings.beta, candidates, fine);
    let p_value = onset.as_ref().map(|onset| onset.p_value);
    if let Some(confidence) = settings.confidence {
        decision.test_reaction(context.departed().or(p_value), confidence);
    }
    decision.onset = onset.map(Box::new);
    decision
}
