//! Lag of the spool: the opening of the valve approaches what is commanded.
//!
//! ```text
//! time_constant · x' + x = in
//! ```
//!
//! The equation is that of [`ActuatorLag`], before the curve of the valve instead of after it:
//! here the spool has to leave the overlap before the joint moves, so that a lag adds to the
//! delay of small openings more than to that of large ones, and a joint stops as soon as the spool
//! is back in the overlap. Without an overlap, a limit or another effect on the input the two are
//! the same, and the record shows which it is only where there is one.
//!
//! What is after sees the mean opening over an interval, and not that it passes a corner of the
//! valve's curve within it: the angle is off by up to `gain · x' · dt²/8` for each passage.
//!
//! # References
//! Jelali, M., and Kroll, A., 2003, Hydraulic Servo-systems: Modelling, Identification and Control
//! (valve dynamics); Merritt, H. E., 1967, Hydraulic Control Systems (overlapped valves).

use super::actuator_lag::LAGGING;
use super::{
    ActuatorLag, Dimension, Effect, Moment, Parameter, RecordRange, Spec, Stage, UNLIMITED,
};

/// See the [module](self).
#[derive(Clone, Copy, Debug)]
pub struct SpoolLag;

static SPEC: Spec = Spec::new(
    "spool_lag",
    Stage::Spool,
    "first-order lag of the spool, before the valve's overlap and limits",
)
.equation("time_constant d out/dt + out = in")
.source("Jelali and Kroll, 2003, Hydraulic Servo-systems; Merritt, 1967, Hydraulic Control Systems")
.parameters(&[Parameter::new(
    "time_constant",
    "time to 63 % of a change of the opening",
    Dimension::Seconds,
)
.between(0.0, UNLIMITED)])
.memory(ActuatorLag::MEMORY)
.starting_at_signal()
.confused_with(&["actuator_lag", "rate_limit", "variable_delay"])
.absorbing(&["actuator_lag"])
.refining("actuator_lag")
.equations(LAGGING);

impl Effect for SpoolLag {
    fn spec(&self) -> &'static Spec {
        &SPEC
    }

    fn step(&self, parameters: &[f64], memory: &mut [f64], at: &Moment) -> f64 {
        ActuatorLag.step(parameters, memory, at)
    }

    fn guesses(&self, record: &RecordRange<'_>) -> Vec<Vec<f64>> {
        ActuatorLag.guesses(record)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::{Component, JointModel, Surroundings, simulate_input};

    /// A step of 2 V on a joint of 10 deg/s/V with an overlap of 1 V, and back.
    fn way(effect: &'static dyn Effect) -> f64 {
        let overlap = Component::new(&super::super::DeadBand, vec![(-1.0).into(), 1.0.into()]);
        let lag = Component::new(effect, vec![0.2.into()]);
        let model = JointModel::integrator(10.0, 0.0).with(overlap.unwrap()).with(lag.unwrap());
        let input: Vec<f64> =
            (0..8000).map(|k| if (1000..3000).contains(&k) { 2.0 } else { 0.0 }).collect();
        let simulated = simulate_input(&model, &input, 0.001, 0.0, &Surroundings::default());
        simulated.output[7999]
    }

    #[test]
    fn the_spool_leaves_the_overlap_late_and_is_back_early() {
        // x = 2 (1 − e^(−t/T)) − 1 above 1 V from T ln 2 on, and 2 e^(−t/T) − 1 until T ln 2: of a
        // command of 2 s the ways are 10 (2 − T ln 2 − T) and 10 T (1 − ln 2).
        let ln2 = std::f64::consts::LN_2;
        let expected = 10.0 * (2.0 - 0.2 * ln2 - 0.2) + 10.0 * 0.2 * (1.0 - ln2);
        assert!((way(&SpoolLag) - expected).abs() < 2e-3, "{} {expected}", way(&SpoolLag));
        // A lag after the overlap loses as much at the beginning as it gains at the end.
        assert!((way(&ActuatorLag) - 20.0).abs() < 1e-6);
    }
}
