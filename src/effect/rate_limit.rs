//! Slew rate of the spool: the opening follows the input at a limited speed.
//!
//! ```text
//! s · x' = sign(in − x) until x = in,   x' = 0 from then on
//! s = seconds_per_input where x rises,   seconds_per_input · (1 + falling) where it falls
//! ```
//!
//! ```text
#![doc = include_str!("drawing/rate_limit.txt")]
//! ```
//!
//! The parameter is the time the spool takes for one input unit, so that "no limit" is
//! the number 0. A solenoid pushes the spool one way and a spring or another solenoid the other,
//! which need not be as fast. The mean over an interval is exact: a ramp, and where the ramp ends in
//! it a constant behind. The joint is late by half the time of the ramp; a log sampled
//! more slowly than the ramp lasts shows little more than that delay.
//!
//! # References
//! Jelali, M., and Kroll, A., 2003, Hydraulic Servo-systems: Modelling, Identification
//! and Control (velocity limit of the valve spool).

use super::{Dimension, Effect, Equations, Moment, Parameter, RecordRange, Spec, Stage, UNLIMITED};

/// See the [module](self).
#[derive(Clone, Copy, Debug)]
pub struct RateLimit;

static SPEC: Spec = Spec::new("rate_limit", Stage::Dynamics, "slew rate of the spool")
    .equation(EQUATION)
    .source("Jelali and Kroll, 2003, Hydraulic Servo-systems")
    .drawing(include_str!("drawing/rate_limit.txt"))
    .parameters(&SLEW)
    .memory(1)
    .starting_at_signal()
    .confused_with(&["actuator_lag", "variable_delay"])
    .equations(SLEWING);

/// The limit of each direction.
pub(super) const EQUATION: &str =
    "-1 / (seconds_per_input (1 + falling)) <= d out/dt <= 1 / seconds_per_input, toward in";

/// The parameters, as those of a spool that slews before the overlap.
pub(super) const SLEW: [Parameter; 2] = [
    Parameter::new(
        "seconds_per_input",
        "time for a change of one input unit",
        Dimension::SecondsPerInput,
    )
    .between(0.0, UNLIMITED),
    Parameter::new(
        "falling",
        "relative change of that time where the opening falls",
        Dimension::One,
    )
    .between(-0.9, 9.0),
];

/// One interval, likewise.
pub(super) const SLEWING: Equations = Equations::new(&["way = signal - opening
             seconds = seconds_per_input * if(way < 0, 1 + falling, 1)
             ramp = abs(way) * seconds
             arrives = ramp <= dt
             moved = sign(way) * dt / seconds
             behind = if(ramp > 0, way * (0.5 * ramp / dt), 0)
             mean = if(arrives, signal - behind, opening + 0.5 * moved)
             opening = if(arrives, signal, opening + moved)
             out = mean"])
.remembering(&["opening"], "opening = signal");

impl Effect for RateLimit {
    fn spec(&self) -> &'static Spec {
        &SPEC
    }

    /// The memory is the opening in input units.
    fn step(&self, parameters: &[f64], memory: &mut [f64], at: &Moment) -> f64 {
        let (&[seconds_per_input, falling], [opening]) = (parameters, memory) else {
            return at.signal;
        };
        let way = at.signal - *opening;
        let seconds = seconds_per_input * if way < 0.0 { 1.0 + falling } else { 1.0 };
        let ramp_s = way.abs() * seconds;
        if ramp_s <= at.dt_s {
            *opening = at.signal;
            return if ramp_s > 0.0 {
                at.signal - way * (0.5 * ramp_s / at.dt_s)
            } else {
                at.signal
            };
        }
        let moved = (at.dt_s / seconds).copysign(way);
        *opening += moved;
        *opening - 0.5 * moved
    }

    fn guesses(&self, record: &RecordRange<'_>) -> Vec<Vec<f64>> {
        let size = record.size(Dimension::SecondsPerInput);
        [0.1, 0.5].into_iter().map(|full_s| vec![full_s * size, 0.0]).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::super::testing::{assert_close, run};
    use super::*;

    #[test]
    fn ramps_and_stops_within_an_interval() {
        // 0.5 input units per interval of 10 ms; the last one is reached halfway.
        let outputs = run(&RateLimit, &[0.02, 3.0], &[1.25, 1.25, 1.25, 1.25]);
        assert_close(&outputs, &[0.25, 0.75, 1.1875, 1.25]);
        // Half as fast downward.
        let outputs = run(&RateLimit, &[0.02, 1.0], &[-0.5, -0.5, -0.5]);
        assert_close(&outputs, &[-0.125, -0.375, -0.5]);
    }
}
