//! Has anything happened? The change of slope against the noise.
//!
//! The output before the next step of the input, as it was measured, is fitted by one line
//! and by the best bend; how often noise alone gains as much is the p-value of [`Bends`]. The
//! noise, with its memory, is taken from the residuals of the bends.

use crate::delay::decision::Decision;
use crate::delay::onset_model::{Bend, Bends, memory};
use crate::delay::prepared::Prepared;

/// Steps from which the noise is known well enough to say that there is nothing else; chosen: one
/// reaction alone passes for the memory of a noise.
const FEWEST: usize = 3;

/// The p-value of a reaction that is plain: noise alone passes for it once in a million steps.
const PLAIN: f64 = 1e-6;

/// Steps whose noise is taken for that of the next, at most.
const LATEST: usize = 20;

/// Puts the verdict on each decision of a method that has none of its own.
pub(super) fn judge(decisions: &mut [Decision], trial: &Prepared<'_>, confidence: f64) {
    let bends = Bends::within(longest(decisions));
    let best = |decision: &Decision| bends.best(window(decision, trial));
    let found: Vec<Option<Bend>> = decisions.iter().map(best).collect();
    let memory = memory(found.iter().flatten().map(|bend| bend.residuals.as_slice()));
    for (decision, bend) in decisions.iter_mut().zip(found) {
        decision.test_reaction(bend.map(|bend| bend.p_value(memory)), confidence);
    }
}

/// Puts the verdict on the decisions before the first that shows a plain reaction, or at which
/// the joint `departs` from its rest.
///
/// The paper asks nothing of the kind, of joints that do react; of one that never does, as when its
/// sensor is not connected, it would make delays of noise. The noise is that of the steps so far,
/// so that a verdict stays as a record grows.
pub(super) fn judge_until_one_reacts(
    decisions: &mut [Decision],
    trial: &Prepared<'_>,
    departs: impl Fn(usize) -> bool,
    confidence: f64,
) {
    let mut found: Vec<Bend> = Vec::new();
    for (index, decision) in decisions.iter_mut().enumerate() {
        if departs(index) {
            break;
        }
        let values = window(decision, trial);
        let Some(bend) = Bends::within(values.len() + 1).best(values) else { continue };
        found.push(bend);
        let latest = &found[found.len().saturating_sub(LATEST)..];
        let memory = memory(latest.iter().map(|bend| bend.residuals.as_slice()));
        let p_value = latest.last().map(|bend| bend.p_value(memory));
        if p_value.is_some_and(|p_value| p_value < PLAIN) {
            break;
        }
        if found.len() >= FEWEST {
            decision.test_reaction(p_value, confidence);
        }
    }
}

/// More samples than any window has.
fn longest(decisions: &[Decision]) -> usize {
    decisions.iter().map(|decision| decision.segment.len()).max().unwrap_or(0) + 1
}

/// The samples of a decision's segment that its own step alone can have moved.
fn window<'a>(decision: &Decision, trial: &'a Prepared<'_>) -> &'a [f64] {
    let indices = decision.segment.indices();
    let end = indices.end.min(decision.next_sample() - 1);
    trial.raw.get(indices.start..end).unwrap_or_default()
}
