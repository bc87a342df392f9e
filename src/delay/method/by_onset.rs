//! `auto`, `lag-aware` and `hinge`: the onsets of an onset model, of all shapes or of some.
//!
//! The delay of a step is that of its [onset](OnsetModel); the candidates are those of
//! Algorithm 1, so that a reviewer sees both answers.

use super::step_context::StepContext;
use super::two_line;
use crate::delay::condition::Condition;
use crate::delay::decision::Decision;
use crate::delay::interval::FineDelay;
use crate::delay::onset_model::{Obstacle, OnsetModel, StepOnset};
use crate::delay::prepared::Prepared;
use crate::delay::settings::Settings;
use crate::units::SamplePeriod;

/// The decisions on all steps of a trial, by the response that its joint has.
pub(super) fn decide(
    trial: &Prepared<'_>,
    model: Option<&OnsetModel>,
    settings: &Settings,
) -> Vec<Decision> {
    let by_lines = two_line::by_lines(trial, settings).into_iter().enumerate();
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
        let is_accepted = decision.failed().next().is_none();
        if is_accepted && fine.is_some_and(|fine| could_be_anywhere(fine, decision.hold)) {
            decision.fail(Condition::NothingHappened, None, None);
        }
    }
    decision.onset = onset.map(Box::new);
    decision
}

/// Whether the interval of an onset is all of its hold of so many samples: the reaction is then seen at no
/// time of it, however unlikely it is that white noise alone bends the output so.
fn could_be_anywhere(fine: FineDelay, hold: usize) -> bool {
    /// What comes after an onset, samples: those that show that the output does otherwise.
    const AFTER: f64 = 2.0;
    fine.low <= 0.0 && fine.high >= hold as f64 - AFTER
}

/// `fine` with its interval extended to the onsets of a joint that accelerates gradually from rest:
/// two lines meet after such an onset.
fn from_rest(context: &StepContext<'_>, fine: FineDelay) -> FineDelay {
    context.gradual().map_or(fine, |other| FineDelay {
        low: fine.low.min(other.low),
        high: fine.high.max(other.high),
        ..fine
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_interval_that_is_all_of_a_hold_says_nothing_of_the_onset() {
        let fine = |low, high| FineDelay { delay: 40.0, low, high, confidence: 0.95 };
        assert!(
            could_be_anywhere(fine(0.0, 98.2), 100) && could_be_anywhere(fine(-3.0, 120.0), 100)
        );
        assert!(
            !could_be_anywhere(fine(0.5, 99.2), 100) && !could_be_anywhere(fine(0.0, 90.0), 100)
        );
    }
}
