//! Saturation of the valve: the flow ends at a limit, at a corner or in a soft knee.
//!
//! ```text
//! |out| = |in|                                   where |in| ≤ limit (1 − softness)
//! |out| = |in| − (|in| − limit (1 − softness))² / (4 softness limit)      between
//! |out| = limit                                  where |in| ≥ limit (1 + softness)
//! ```
//!
//! ```text
#![doc = include_str!("drawing/input_saturation.txt")]
//! ```
//!
//! The knee is the parabola that meets both lines with their slopes, so the output has
//! no corner unless `softness` is 0. Both directions have the same limit; where they differ, see
//! [`AsymmetricSaturation`](super::AsymmetricSaturation). `limit` is
//! neutral at 1e12, which stands for none.
//!
//! # References
//! Jelali, M., and Kroll, A., 2003, Hydraulic Servo-systems: Modelling, Identification
//! and Control (flow saturation). The parabola is a plain choice, not from a source.

use super::{Dimension, Effect, Equations, Moment, Parameter, RecordRange, Spec, Stage, UNLIMITED};

/// See the [module](self).
#[derive(Clone, Copy, Debug)]
pub struct InputSaturation;

static SPEC: Spec =
    Spec::new("input_saturation", Stage::Input, "flow limit, hard or with a soft knee")
        .equation("abs(out) = min(abs(in), limit), rounded within limit (1 -+ softness)")
        .source("Jelali and Kroll, 2003, Hydraulic Servo-systems")
        .drawing(include_str!("drawing/input_saturation.txt"))
        .parameters(&[
            Parameter::new("limit", "largest magnitude that passes", Dimension::Input)
                .between(0.0, UNLIMITED)
                .neutral(UNLIMITED),
            SOFTNESS,
        ])
        .confused_with(&["flow_curve", "rate_limit"])
    .steady()
    .equations(Equations::new(&["size = abs(signal)
             into_knee = size - limit * (1 - softness)
             width = 2 * softness * limit
             rounded = size - into_knee * (into_knee / (2 * width))
             out = if(into_knee <= 0, signal, sign(signal) * if(into_knee < width, rounded, limit))"]
        ));

/// As the asymmetric form has it, too.
pub(super) const SOFTNESS: Parameter = Parameter::new(
    "softness",
    "half the width of the knee, as a part of the limit",
    Dimension::One,
)
.between(0.0, 1.0);

/// Range of the limit in a fit, in parts of the largest input: below it nothing of the
/// input's shape is left, above it nothing of the limit is seen.
pub(super) const FITTED_LIMIT: (f64, f64) = (0.01, 2.0);

impl Effect for InputSaturation {
    fn spec(&self) -> &'static Spec {
        &SPEC
    }

    fn step(&self, parameters: &[f64], _memory: &mut [f64], at: &Moment) -> f64 {
        let &[limit, softness] = parameters else { return at.signal };
        limited(at.signal, limit, softness)
    }

    fn shows_its_form(&self, parameters: &[f64], record: &RecordRange<'_>) -> bool {
        let &[limit, softness] = parameters else { return true };
        levels_off(limit, softness, record)
    }

    fn bounds(&self, record: &RecordRange<'_>) -> Vec<(f64, f64)> {
        let (low, high) = FITTED_LIMIT;
        let largest = record.size(Dimension::Input);
        vec![(low * largest, high * largest), (0.0, 1.0)]
    }

    fn guesses(&self, record: &RecordRange<'_>) -> Vec<Vec<f64>> {
        let largest = record.size(Dimension::Input);
        [0.4, 0.65, 0.9].into_iter().map(|part| vec![part * largest, 0.1]).collect()
    }
}

/// Whether the input of `record` passes the knee, beyond which the flow rises no more.
pub(super) fn levels_off(limit: f64, softness: f64, record: &RecordRange<'_>) -> bool {
    limit * (1.0 + softness) <= record.input_abs_max
}

/// What passes of `signal`.
pub(super) fn limited(signal: f64, limit: f64, softness: f64) -> f64 {
    let size = signal.abs();
    let into_knee = size - limit * (1.0 - softness);
    if into_knee <= 0.0 {
        return signal;
    }
    let width = 2.0 * softness * limit;
    let passed =
        if into_knee < width { size - into_knee * (into_knee / (2.0 * width)) } else { limit };
    passed.copysign(signal)
}

#[cfg(test)]
mod tests {
    use super::super::testing::{assert_close, run};
    use super::*;

    #[test]
    fn a_hard_limit_has_a_corner() {
        let outputs = run(&InputSaturation, &[2.0, 0.0], &[-3.0, -1.0, 2.0, 2.001, 1e9]);
        assert_close(&outputs, &[-2.0, -1.0, 2.0, 2.0, 2.0]);
    }

    #[test]
    fn a_soft_knee_loses_a_quarter_of_its_half_width_at_the_limit() {
        // At |in| = limit: (softness limit)² / (4 softness limit) = 0.5 · 2 / 4 is lost.
        let outputs = run(&InputSaturation, &[2.0, 0.5], &[1.0, 2.0, -2.0, 3.0, 4.0]);
        assert_close(&outputs, &[1.0, 1.75, -1.75, 2.0, 2.0]);
    }
}
