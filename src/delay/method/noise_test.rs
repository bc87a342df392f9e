//! Has anything happened? The change of slope against the noise.
//!
//! The output before the next step of the input, as it was measured, is fitted by one line
//! and by the best broken line; how often noise alone gains as much is the p-value of
//! [`Window`]. The noise, with its memory, is taken from the residuals of the broken lines.

use crate::delay::broken_line::{BrokenLine, PARAMETERS, Window};
use crate::delay::decision::Decision;
use crate::numerics::NoiseModel;

/// Puts the verdict on each decision of a method that has none of its own.
pub(super) fn judge(decisions: &mut [Decision], raw: &[f64], confidence: f64) {
    let windows: Vec<&[f64]> = decisions.iter().map(|decision| window(decision, raw)).collect();
    let white = NoiseModel::white();
    let residuals = |values: &&[f64]| Some(best(values, &white)?.residuals(values));
    let noise =
        NoiseModel::of(&windows.iter().filter_map(residuals).collect::<Vec<_>>(), PARAMETERS);
    for (decision, values) in decisions.iter_mut().zip(windows) {
        decision.test_reaction(best(values, &noise).map(|line| line.p_value), confidence);
    }
}

/// The samples of a decision's segment that its own step alone can have moved.
fn window<'a>(decision: &Decision, raw: &'a [f64]) -> &'a [f64] {
    let indices = decision.segment.indices();
    let end = indices.end.min(decision.next_sample() - 1);
    raw.get(indices.start..end).unwrap_or_default()
}

/// The best broken line through `values`, if they are enough.
fn best(values: &[f64], noise: &NoiseModel) -> Option<BrokenLine> {
    let window = Window::of(values, noise)?;
    window.best(window.positions())
}
