//! Creep: a part of the speed arrives with a second, slow time constant.
//!
//! ```text
//! out = (1 − share) · in + share · x,   time_constant · x' + x = in
//! ```
//!
//! Seals, hoses and the pressure compensator of a pump let the speed follow most of a step at once
//! and the rest over a second or more. The mean of `x` over an interval is exact, as in
//! [`ActuatorLag`](super::ActuatorLag), which is the case of a share of one.
//!
//! # References
//! Merritt, H. E., 1967, Hydraulic Control Systems (pressure compensated pumps); Ljung, L., 1999,
//! System Identification: Theory for the User (sampling of a held input).

use super::decay::{DECAY, DECAY_MEMORY, Decay};
use super::{Dimension, Effect, Equations, Moment, Parameter, RecordRange, Spec, Stage, UNLIMITED};

/// See the [module](self).
#[derive(Clone, Copy, Debug)]
pub struct Creep;

static SPEC: Spec = Spec::new(
    "creep",
    Stage::Dynamics,
    "a part of the speed arrives with a second, slow time constant",
)
.equation("out = (1 - share) in + share x, time_constant dx/dt + x = in")
.source("Merritt, 1967, Hydraulic Control Systems")
.parameters(&[
    Parameter::new("share", "part of a change that arrives late", Dimension::One)
        .between(-0.95, 0.95)
        .typical(0.3),
    Parameter::new("time_constant", "time to 63 % of that part", Dimension::Seconds)
        .between(0.0, UNLIMITED)
        .neutral(1.0),
])
.memory(1 + DECAY_MEMORY)
.starting_at_signal()
.slower_than_speed()
.confused_with(&["actuator_lag", "leakage", "thermal_drift", "accumulator_droop"])
.equations(
    Equations::new(&[
        "interval = dt\n",
        DECAY,
        "deviation = state - signal
             state = signal + deviation * left
             out = signal + share * deviation * mean",
    ])
    .remembering(&["state"], "state = signal"),
);

/// Shortest and longest time constant of a fit: below it is a lag, above it hardly arrives while the
/// input is held.
const FITTED_S: (f64, f64) = (0.1, 60.0);

impl Effect for Creep {
    fn spec(&self) -> &'static Spec {
        &SPEC
    }

    /// The memory is the slow state `x`, and the decay that was computed last.
    fn step(&self, parameters: &[f64], memory: &mut [f64], at: &Moment) -> f64 {
        let (&[share, time_constant], [state, known @ ..]) = (parameters, memory) else {
            return at.signal;
        };
        let decay = Decay::recall(known, at.dt_s, time_constant);
        let deviation = *state - at.signal;
        *state = at.signal + deviation * decay.left;
        at.signal + share * deviation * decay.mean
    }

    fn bounds(&self, record: &RecordRange<'_>) -> Vec<(f64, f64)> {
        let (short, long) = FITTED_S;
        let samples = 10.0 * record.sample_period_s;
        vec![(-0.95, 0.95), (short.max(samples), long.max(10.0 * samples))]
    }

    fn guesses(&self, record: &RecordRange<'_>) -> Vec<Vec<f64>> {
        let slow = 100.0 * record.sample_period_s;
        [0.5, 4.0].map(|times| vec![0.3, (times * slow).clamp(0.5, 20.0)]).to_vec()
    }
}

#[cfg(test)]
mod tests {
    use super::super::testing::{assert_close, run};
    use super::*;

    #[test]
    fn the_late_part_follows_its_closed_form() {
        // dt = T: of the part 0.4 the mean e is missing first, then (1 − e)… of what is left.
        let e = (-1.0_f64).exp();
        let outputs = run(&Creep, &[0.4, 0.01], &[1.0, 1.0]);
        assert_close(&outputs, &[1.0 - 0.4 * (1.0 - e), 1.0 - 0.4 * (1.0 - e) * e]);
    }
}
