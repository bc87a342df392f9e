//! Short forms for the tests of the effects.

use super::{Effect, Moment};

/// A signal at angle 0, over 10 ms, of a joint measured in degrees.
pub(super) fn moment(signal: f64) -> Moment {
    Moment::of(signal)
}

/// The outputs of `effect` for `signals` one after the other, from fresh memory.
pub(super) fn run(effect: &dyn Effect, parameters: &[f64], signals: &[f64]) -> Vec<f64> {
    let mut memory = vec![0.0; effect.spec().memory];
    let mut step = |signal: &f64| effect.step(parameters, &mut memory, &moment(*signal));
    signals.iter().map(&mut step).collect()
}

/// Panics unless both have the same length and agree to 1e-12 of the larger, or of 1.
#[track_caller]
pub(super) fn assert_close(found: &[f64], expected: &[f64]) {
    assert_close_to(found, expected, 1e-12);
}

/// Panics unless both have the same length and agree to `tolerance` of the larger, or of 1.
#[track_caller]
pub(super) fn assert_close_to(found: &[f64], expected: &[f64], tolerance: f64) {
    assert_eq!(found.len(), expected.len());
    for (a, b) in found.iter().zip(expected) {
        let size = a.abs().max(b.abs()).max(1.0);
        assert!((a - b).abs() <= tolerance * size, "{found:?} is not {expected:?}");
    }
}
