//! Slew rate of the spool before the overlap: the spool moves at a limited speed, and the valve passes
//! what its edges make of where it is.
//!
//! ```text
//! s · x' = sign(in − x) until x = in,   x' = 0 from then on
//! s = seconds_per_input where x rises,   seconds_per_input · (1 + falling) where it falls
//! ```
//!
//! The equation is that of [`RateLimit`], before the overlap and the limits of the valve instead of
//! after them: the spool crosses the overlap before the joint moves, so that the delay grows with
//! the overlap over the rate, and a joint stops as soon as the spool is back in the overlap. Without
//! an effect of the valve the two are the same.
//!
//! # References
//! Jelali, M., and Kroll, A., 2003, Hydraulic Servo-systems: Modelling, Identification and Control
//! (velocity limit of the valve spool); Merritt, H. E., 1967, Hydraulic Control Systems (overlapped
//! valves).

use super::rate_limit::{EQUATION, SLEW, SLEWING};
use super::{Effect, Moment, RateLimit, RecordRange, Spec, Stage};

/// See the [module](self).
#[derive(Clone, Copy, Debug)]
pub struct SpoolRateLimit;

static SPEC: Spec = Spec::new(
    "spool_rate_limit",
    Stage::Spool,
    "slew rate of the spool, before the valve's overlap and limits",
)
.equation(EQUATION)
.source("Jelali and Kroll, 2003, Hydraulic Servo-systems; Merritt, 1967, Hydraulic Control Systems")
.parameters(&SLEW)
.memory(1)
.starting_at_signal()
.confused_with(&["rate_limit", "spool_lag", "variable_delay"])
.absorbing(&["rate_limit"])
.refining("rate_limit")
.equations(SLEWING);

impl Effect for SpoolRateLimit {
    fn spec(&self) -> &'static Spec {
        &SPEC
    }

    fn step(&self, parameters: &[f64], memory: &mut [f64], at: &Moment) -> f64 {
        RateLimit.step(parameters, memory, at)
    }

    fn guesses(&self, record: &RecordRange<'_>) -> Vec<Vec<f64>> {
        RateLimit.guesses(record)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::{Component, JointModel, Surroundings, simulate_input};

    #[test]
    fn the_spool_crosses_the_overlap_first() {
        // 4 V at 10 V/s across an overlap of 1 V: from 0.1 s on the opening grows by 10 V/s to 3 V;
        // back at 0 V it is closed 0.3 s after the step.
        let overlap = Component::new(&super::super::DeadBand, vec![(-1.0).into(), 1.0.into()]);
        let slew = Component::new(&SpoolRateLimit, vec![0.1.into(), 0.0.into()]);
        let model = JointModel::integrator(10.0, 0.0).with(overlap.unwrap()).with(slew.unwrap());
        let input: Vec<f64> =
            (0..3000).map(|k| if (500..1500).contains(&k) { 4.0 } else { 0.0 }).collect();
        let way = simulate_input(&model, &input, 0.001, 0.0, &Surroundings::default()).output;
        let expected = 10.0 * (3.0 * 0.3 / 2.0 + 3.0 * 0.6 + 3.0 * 0.3 / 2.0);
        assert!((way[2999] - expected).abs() < 0.05, "{} {expected}", way[2999]);
        assert!(way[599].abs() < 1e-9, "it is in the overlap for 0.1 s");
    }
}
