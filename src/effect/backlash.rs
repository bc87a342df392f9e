//! Backlash: play between the actuator and the sensor of the angle.
//!
//! ```text
//! out = min(max(out before, in − width/2), in + width/2)
//! ```
//!
//! ```text
#![doc = include_str!("drawing/backlash.txt")]
//! ```
//!
//! The measured side stays where it is until the play is used up (the play operator). It
//! acts on the measurement only: the joint itself goes on. In a record it looks like an
//! extra delay after each turn of the motion, by `width` over the speed.
//!
//! # References
//! Tao, G., and Kokotović, P. V., 1996, Adaptive Control of Systems with Actuator and
//! Sensor Nonlinearities.

use super::{Dimension, Effect, Equations, Moment, Parameter, RecordRange, Spec, Stage, UNLIMITED};

/// See the [module](self).
#[derive(Clone, Copy, Debug)]
pub struct Backlash;

static SPEC: Spec = Spec::new("backlash", Stage::Output, "play between actuator and sensor")
    .equation("out stays until abs(in - out) > width / 2, then follows at that distance")
    .source(
        "Tao and Kokotović, 1996, Adaptive Control of Systems with Actuator and Sensor \
             Nonlinearities",
    )
    .drawing(include_str!("drawing/backlash.txt"))
    .parameters(&[Parameter::new("width", "whole width of the play", Dimension::Output)
        .between(0.0, UNLIMITED)
        .typical(0.02)])
    .memory(1)
    .starting_at_signal()
    .confused_with(&["dead_band", "variable_delay"])
    .equations(
        Equations::new(&[
            "measured = min(max(measured, signal - 0.5 * width), signal + 0.5 * width)
             out = measured",
        ])
        .remembering(&["measured"], "measured = signal"),
    );

impl Effect for Backlash {
    fn spec(&self) -> &'static Spec {
        &SPEC
    }

    /// The memory is the output.
    fn step(&self, parameters: &[f64], memory: &mut [f64], at: &Moment) -> f64 {
        let (&[width], [measured]) = (parameters, memory) else { return at.signal };
        *measured = measured.max(at.signal - 0.5 * width).min(at.signal + 0.5 * width);
        *measured
    }

    fn bounds(&self, record: &RecordRange<'_>) -> Vec<(f64, f64)> {
        vec![(0.0, record.output_span().min(UNLIMITED))]
    }

    fn guesses(&self, record: &RecordRange<'_>) -> Vec<Vec<f64>> {
        vec![vec![0.02 * record.output_span()]]
    }
}

#[cfg(test)]
mod tests {
    use super::super::testing::{assert_close, run};
    use super::*;

    #[test]
    fn follows_at_half_a_width_and_stays_within_it() {
        let inputs = [0.5, 1.0, 5.0, 4.0, 3.0, 1.0, 2.5];
        let outputs = [0.0, 0.0, 4.0, 4.0, 4.0, 2.0, 2.0];
        assert_close(&run(&Backlash, &[2.0], &inputs), &outputs);
    }
}
