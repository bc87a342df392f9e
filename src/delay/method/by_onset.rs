//! `auto`, `lag-aware` and `hinge`: the onsets of an onset model, of all shapes or of some.
//!
//! The delay of a step is that of its [onset](crate::delay::OnsetModel); the candidates are those of
//! Algorithm 1, so that a reviewer sees both answers.

use std::sync::Arc;

use super::interface::{DelayMethod, Shared};
use super::step_context::StepContext;
use super::two_line;
use crate::delay::condition::Condition;
use crate::delay::decision::Decision;
use crate::delay::interval::FineDelay;
use crate::delay::onset_model::{Family, Obstacle, OnsetModel, StepOnset};
use crate::delay::prepared::Prepared;
use crate::delay::settings::{CONFIDENCE, Settings};
use crate::delay::spec::{Method, MethodSpec};
use crate::numerics::LowPass;
use crate::units::SamplePeriod;

/// What all onset models have in common.
const ONSET: MethodSpec = MethodSpec {
    id: "",
    fits: "onset model",
    source: None,
    summary: "",
    has_intervals: true,
    low_pass: Some(LowPass { cutoff_hz: 5.0, order: 4 }),
    confidence: Some(CONFIDENCE),
};

static AUTO: MethodSpec = MethodSpec {
    id: "auto",
    summary: "The response that the record supports (bend, lag, oscillation, settling, slew), with \
              intervals; Algorithm 1's candidates beside it",
    ..ONSET
};

static LAG_AWARE: MethodSpec = MethodSpec {
    id: "lag-aware",
    fits: "two lines that meet, behind a lag or an oscillation",
    summary: "`auto` of a joint whose speed changes at once, or behind a lag or an oscillation",
    ..ONSET
};

static HINGE: MethodSpec = MethodSpec {
    id: "hinge",
    fits: "two lines that meet",
    summary: "`auto` of a joint whose speed changes at once",
    ..ONSET
};

impl Method {
    /// The onset model of the response that a joint's record supports.
    pub const AUTO: Self = Self::of(&AUTO);

    /// The onset model of a speed that changes at once, or behind a lag or an oscillation.
    pub const LAG_AWARE: Self = Self::of(&LAG_AWARE);

    /// The onset model of a speed that changes at once.
    pub const HINGE: Self = Self::of(&HINGE);
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

/// A method that finds onsets behind one of some responses.
pub(super) struct ByOnset {
    method: Method,
    families: &'static [Family],
}

impl ByOnset {
    pub(super) const AUTO: Self = Self { method: Method::AUTO, families: &Family::ALL };
    pub(super) const LAG_AWARE: Self =
        Self { method: Method::LAG_AWARE, families: &[Family::Bend, Family::Lag, Family::Pair] };
    pub(super) const HINGE: Self = Self { method: Method::HINGE, families: &[Family::Bend] };
}

impl DelayMethod for ByOnset {
    fn method(&self) -> Method {
        self.method
    }

    fn shared(&self, trials: &[Prepared<'_>], settings: &Settings) -> Shared {
        OnsetModel::of(trials, settings, self.families).map(Arc::new)
    }

    fn decide(&self, trial: &Prepared<'_>, shared: &Shared, settings: &Settings) -> Vec<Decision> {
        let by_lines = two_line::by_lines(trial, settings).into_iter().enumerate();
        let model = shared.as_deref();
        let onsets = model.map_or_else(Vec::new, |model| model.onsets(trial, settings));
        let obstacle = model.and_then(OnsetModel::obstacle).filter(|_| !settings.accept_anyway);
        let all = by_lines.zip(onsets.into_iter().chain(std::iter::repeat(None)));
        all.map(|((index, lines), onset)| {
            let mut decision = answered(&StepContext { trial, index, settings }, lines, onset);
            if let Some(obstacle) = obstacle {
                rejected(&mut decision, obstacle, trial.period);
            }
            decision
        })
        .collect()
    }
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
    let fine = onset.as_ref().map(|onset| from_rest(context, onset.fine.not_before_its_step()));
    let Decision { segment, candidates, .. } = by_lines;
    let mut decision = context.decision(segment, candidates, fine);
    let p_value = onset.as_ref().map(|onset| onset.p_value);
    if let Some(confidence) = settings.confidence {
        decision.test_reaction(context.departed().or(p_value), confidence);
    }
    decision.onset = onset.map(Box::new);
    decision
}

/// `fine`, whose interval also holds the onsets of a joint that gathers speed from rest in a way
/// of its own: lines meet behind them.
fn from_rest(context: &StepContext<'_>, fine: FineDelay) -> FineDelay {
    context.gradual().map_or(fine, |other| FineDelay {
        low: fine.low.min(other.low),
        high: fine.high.max(other.high),
        ..fine
    })
}
