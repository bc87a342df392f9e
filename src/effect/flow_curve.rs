//! Progressive or degressive valve: the flow grows with a power of the opening.
//!
//! ```text
//! out = sign(in) · s · (|in| / s)^exponent,   s = 1 input unit
//! ```
//!
//! ```text
#![doc = include_str!("drawing/flow_curve.txt")]
//! ```
//!
//! The scale `s` keeps the unit: the output is in input units whatever the exponent, and
//! the gain of the joint remains its speed at an input of 1. Where all inputs are far
//! from 1 the exponent and the gain are strongly correlated. Below an exponent of 1 the
//! slope at zero is infinite.
//!
//! # References
//! Jelali, M., and Kroll, A., 2003, Hydraulic Servo-systems: Modelling, Identification
//! and Control (progressive flow characteristics); the power is a plain choice.

use super::{Dimension, Effect, Equations, Moment, Parameter, RecordRange, Spec, Stage};

/// See the [module](self).
#[derive(Clone, Copy, Debug)]
pub struct FlowCurve;

static SPEC: Spec = Spec::new(
    "flow_curve",
    Stage::Input,
    "progressive or degressive valve: a power of the opening",
)
.equation("out = sign(in) abs(in)^exponent, in and out counted in input units")
.source("Jelali and Kroll, 2003, Hydraulic Servo-systems")
.drawing(include_str!("drawing/flow_curve.txt"))
.parameters(&[Parameter::new("exponent", "power of the opening", Dimension::One)
    .between(0.2, 5.0)
    .neutral(1.0)])
.confused_with(&["input_saturation", "dead_band"])
.steady()
.equations(Equations::new(&["out = sign(signal) * abs(signal)^exponent"]));

impl Effect for FlowCurve {
    fn spec(&self) -> &'static Spec {
        &SPEC
    }

    fn step(&self, parameters: &[f64], _memory: &mut [f64], at: &Moment) -> f64 {
        let &[exponent] = parameters else { return at.signal };
        at.signal.abs().powf(exponent).copysign(at.signal)
    }

    fn guesses(&self, _record: &RecordRange<'_>) -> Vec<Vec<f64>> {
        vec![vec![0.7], vec![1.4]]
    }
}

#[cfg(test)]
mod tests {
    use super::super::testing::{assert_close, run};
    use super::*;

    #[test]
    fn keeps_zero_one_and_the_sign() {
        assert_close(&run(&FlowCurve, &[0.5], &[0.0, 1.0, 4.0, -9.0]), &[0.0, 1.0, 2.0, -3.0]);
        assert_close(&run(&FlowCurve, &[2.0], &[-1.0, 3.0]), &[-1.0, 9.0]);
    }
}
