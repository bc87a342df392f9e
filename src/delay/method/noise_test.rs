//! Has anything happened? The change of slope against the noise.
//!
//! The output before the next step of the input, as it was measured, is fitted by one line
//! and by the best bend; how often noise alone gains as much is the p-value of [`Bends`]. The
//! noise, with its memory, is taken from the residuals of the bends.

use crate::delay::decision::Decision;
use crate::delay::onset_model::{Bend, Bends, memory};
use crate::delay::prepared::Prepared;

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
