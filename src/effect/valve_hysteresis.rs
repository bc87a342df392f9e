//! Hysteresis of the valve: the spool follows its command with a play.
//!
//! ```text
//! out = min(max(out before, in − width/2), in + width/2)
//! ```
//!
//! At one level of the input the valve is open by `width` less where the level was reached from below
//! than where it was reached from above: friction and magnetic hysteresis of the solenoid, of which
//! a data sheet states the width in percent of the range. The play operator has the memory of the
//! turning points alone and none of time. In a record a static valve curve has two branches.
//!
//! # References
//! Jelali, M., and Kroll, A., 2003, Hydraulic Servo-systems: Modelling, Identification and Control
//! (hysteresis of proportional valves); Tao, G., and Kokotović, P. V., 1996, Adaptive Control of
//! Systems with Actuator and Sensor Nonlinearities (the play operator).

use super::{Dimension, Effect, Equations, Moment, Parameter, RecordRange, Spec, Stage, UNLIMITED};

/// See the [module](self).
#[derive(Clone, Copy, Debug)]
pub struct ValveHysteresis;

static SPEC: Spec = Spec::new(
    "valve_hysteresis",
    Stage::Spool,
    "play of the spool: at the same input the valve opens less when it is reached from below than \
     from above",
)
.equation("out stays until abs(in - out) > width / 2, then follows at that distance")
.source(
    "Jelali and Kroll, 2003, Hydraulic Servo-systems; Tao and Kokotović, 1996, Adaptive Control \
     of Systems with Actuator and Sensor Nonlinearities",
)
.parameters(&[Parameter::new("width", "whole width of the play", Dimension::Input)
    .between(0.0, UNLIMITED)
    .typical(0.1)])
.memory(1)
.starting_at_signal()
.confused_with(&["stiction", "dead_band", "backlash", "variable_delay"])
.steady()
.equations(
    Equations::new(&["opening = min(max(opening, signal - 0.5 * width), signal + 0.5 * width)
             out = opening"])
    .remembering(&["opening"], "opening = signal"),
);

impl Effect for ValveHysteresis {
    fn spec(&self) -> &'static Spec {
        &SPEC
    }

    /// The memory is the opening.
    fn step(&self, parameters: &[f64], memory: &mut [f64], at: &Moment) -> f64 {
        let (&[width], [opening]) = (parameters, memory) else { return at.signal };
        *opening = opening.max(at.signal - 0.5 * width).min(at.signal + 0.5 * width);
        *opening
    }

    fn bounds(&self, record: &RecordRange<'_>) -> Vec<(f64, f64)> {
        vec![(0.0, record.size(Dimension::Input).min(UNLIMITED))]
    }

    fn guesses(&self, record: &RecordRange<'_>) -> Vec<Vec<f64>> {
        [0.05, 0.25].map(|part| vec![part * record.size(Dimension::Input)]).to_vec()
    }
}

#[cfg(test)]
mod tests {
    use super::super::testing::{assert_close, run};
    use super::*;

    #[test]
    fn the_branch_from_below_lies_a_width_below_the_one_from_above() {
        let outputs = run(&ValveHysteresis, &[0.4], &[1.0, 2.0, 1.0, 0.9, 1.5, 1.0]);
        assert_close(&outputs, &[0.8, 1.8, 1.2, 1.1, 1.3, 1.2]);
    }
}
