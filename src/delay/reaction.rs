//! Has anything happened? The change of slope against the noise.
//!
//! The output before the next step of the input, as it was measured, is fitted by one line
//! and by the best broken line; noise alone would gain as much with the chance that
//! [`Window`] tells. The noise, with its memory, is what the broken lines leave.

use super::broken_line::{PARAMETERS, Window};
use super::condition::nothing_happened;
use super::decision::Decision;
use crate::numerics::NoiseModel;

/// Puts the verdict on each decision of a method that has none of its own.
pub(super) fn judge(decisions: &mut [Decision], raw: &[f64], confidence: f64) {
    let windows: Vec<&[f64]> = decisions.iter().map(|decision| window(decision, raw)).collect();
    let white = NoiseModel::white();
    let residuals: Vec<_> = windows.iter().filter_map(|values| residuals(values, &white)).collect();
    let noise = NoiseModel::of(&residuals, PARAMETERS);
    for (decision, values) in decisions.iter_mut().zip(windows) {
        if let Some(check) = decision.checks.last_mut() {
            *check = nothing_happened(chance(values, &noise), confidence);
        }
    }
}

/// The samples of a decision's segment that its own step alone can have moved.
fn window<'a>(decision: &Decision, raw: &'a [f64]) -> &'a [f64] {
    let indices = decision.segment.indices();
    let end = indices.end.min(decision.next_sample() - 1);
    raw.get(indices.start..end).unwrap_or_default()
}

fn chance(values: &[f64], noise: &NoiseModel) -> Option<f64> {
    let window = Window::of(values, noise)?;
    Some(window.best(window.places())?.p_value)
}

/// What the best broken line leaves of `values`.
fn residuals(values: &[f64], noise: &NoiseModel) -> Option<Vec<f64>> {
    let window = Window::of(values, noise)?;
    Some(window.best(window.places())?.residuals(values))
}
