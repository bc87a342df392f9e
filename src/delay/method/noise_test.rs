//! Has anything happened? The change of slope against the noise.
//!
//! The output before the next step of the input, as it was measured, is fitted by one line
//! and by the best broken line; how often noise alone gains as much is the p-value of
//! [`Window`]. The noise, with its memory, is taken from the residuals of the broken lines.

use std::borrow::Cow;

use crate::delay::broken_line::{BrokenLine, PARAMETERS, Window};
use crate::delay::decision::Decision;
use crate::delay::prepared::Prepared;
use crate::numerics::NoiseModel;

/// Steps from which the noise is known well enough to say that there is nothing else; chosen: one
/// reaction alone passes for the memory of a noise.
const FEWEST: usize = 3;

/// The p-value of a reaction that is plain: noise alone passes for it once in a million steps.
const PLAIN: f64 = 1e-6;

/// Steps whose noise is taken for that of the next, at most.
const LATEST: usize = 20;

/// Puts the verdict on each decision of a method that has none of its own.
pub(super) fn judge(decisions: &mut [Decision], trial: &Prepared<'_>, confidence: f64) {
    let white = NoiseModel::white();
    let residuals = |decision: &Decision| {
        let values = window(decision, trial);
        Some(best(&values, &white)?.residuals(&values))
    };
    // About the broken lines: about one line each reaction would pass for noise with a long memory.
    let noise = NoiseModel::of(decisions.iter().filter_map(residuals), PARAMETERS);
    for decision in decisions {
        let line = best(&window(decision, trial), &noise);
        decision.test_reaction(line.map(|line| line.p_value), confidence);
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
    let white = NoiseModel::white();
    let mut residuals: Vec<Vec<f64>> = Vec::new();
    for (index, decision) in decisions.iter_mut().enumerate() {
        if departs(index) {
            break;
        }
        let values = window(decision, trial);
        let Some(line) = best(&values, &white) else { continue };
        residuals.push(line.residuals(&values));
        let latest = residuals.len().saturating_sub(LATEST);
        let noise = NoiseModel::of(&residuals[latest..], PARAMETERS);
        let p_value = best(&values, &noise).map(|line| line.p_value);
        if p_value.is_some_and(|p_value| p_value < PLAIN) {
            break;
        }
        if residuals.len() >= FEWEST {
            decision.test_reaction(p_value, confidence);
        }
    }
}

/// The samples of a decision's segment that its own step alone can have moved.
fn window<'a>(decision: &Decision, trial: &'a Prepared<'_>) -> Cow<'a, [f64]> {
    let indices = decision.segment.indices();
    let end = indices.end.min(decision.next_sample() - 1);
    trial.measured(indices.start..end)
}

/// The best broken line through `values`, if they are enough.
fn best(values: &[f64], noise: &NoiseModel) -> Option<BrokenLine> {
    let window = Window::of(values, noise)?;
    window.best(window.positions())
}
