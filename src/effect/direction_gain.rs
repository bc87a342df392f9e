//! Other gain in the other direction, as of a cylinder with a rod on one side.
//!
//! ```text
//! out = in                     where in ≥ 0
//! out = negative_factor · in   where in < 0
//! ```
//!
//! ```text
#![doc = include_str!("drawing/direction_gain.txt")]
//! ```
//!
//! A flow moves the piston faster where the rod takes up part of the area. The
//! factor is that of the two areas and of the valve's two edges together; the gain of
//! the joint is that of the positive direction.
//!
//! # References
//! Jelali, M., and Kroll, A., 2003, Hydraulic Servo-systems: Modelling, Identification
//! and Control (single-rod cylinders).

use super::{Dimension, Effect, Equations, Moment, Parameter, Spec, Stage};

/// See the [module](self).
#[derive(Clone, Copy, Debug)]
pub struct DirectionGain;

static SPEC: Spec = Spec::new(
    "direction_gain",
    Stage::Input,
    "single-rod cylinder: another gain in the negative direction",
)
.equation("out = in where in >= 0, negative_factor in where in < 0")
.source("Jelali and Kroll, 2003, Hydraulic Servo-systems")
.drawing(include_str!("drawing/direction_gain.txt"))
.parameters(&[Parameter::new(
    "negative_factor",
    "gain of the negative direction over that of the positive one",
    Dimension::One,
)
.between(0.05, 20.0)
.neutral(1.0)
.typical(-0.2)])
.confused_with(&["input_offset", "gravity_load"])
.steady()
.equations(Equations::new(&["out = if(signal < 0, negative_factor * signal, signal)"]));

impl Effect for DirectionGain {
    fn spec(&self) -> &'static Spec {
        &SPEC
    }

    fn step(&self, parameters: &[f64], _memory: &mut [f64], at: &Moment) -> f64 {
        let &[negative_factor] = parameters else { return at.signal };
        if at.signal < 0.0 { negative_factor * at.signal } else { at.signal }
    }
}

#[cfg(test)]
mod tests {
    use super::super::testing::{assert_close, run};
    use super::*;

    #[test]
    fn scales_the_negative_direction_only() {
        assert_close(&run(&DirectionGain, &[0.7], &[2.0, 0.0, -2.0]), &[2.0, 0.0, -1.4]);
    }
}
