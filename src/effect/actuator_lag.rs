//! Lag of the actuator: its speed approaches what is commanded.
//!
//! ```text
//! time_constant · x' + x = in
//! ```
//!
//! The mean over an interval `dt` with `in` held is exact, with `e = exp(−dt/T)`:
//!
//! ```text
//! x(dt) = in + (x(0) − in) · e
//! mean  = in + (x(0) − in) · (T/dt) · (1 − e)
//! ```
//!
//! The joint is late by the time constant in the long run. A log sampled more slowly than
//! that cannot separate the lag from a delay. Where friction stops the joint, the lag belongs
//! into [`CoulombFriction`](super::CoulombFriction); where the spool lags, before the overlap of
//! the valve, see [`SpoolLag`](super::SpoolLag).
//!
//! # References
//! Merritt, H. E., 1967, Hydraulic Control Systems; Ljung, L., 1999, System
//! Identification: Theory for the User (sampling of a held input).

use super::decay::{DECAY, DECAY_MEMORY, Decay};
use super::{Dimension, Effect, Equations, Moment, Parameter, RecordRange, Spec, Stage, UNLIMITED};

/// See the [module](self).
#[derive(Clone, Copy, Debug)]
pub struct ActuatorLag;

static SPEC: Spec = Spec::new(
    "actuator_lag",
    Stage::Dynamics,
    "first-order lag: the speed approaches what is commanded",
)
.equation("time_constant d out/dt + out = in")
.source(
    "Merritt, 1967, Hydraulic Control Systems; Ljung, 1999, System Identification: Theory \
             for the User",
)
.parameters(&[Parameter::new("time_constant", "time to 63 % of a change", Dimension::Seconds)
    .between(0.0, UNLIMITED)])
.memory(ActuatorLag::MEMORY)
.starting_at_signal()
.confused_with(&["resonance", "variable_delay", "rate_limit"])
.equations(LAGGING);

/// As the spool has it, too.
pub(super) const LAGGING: Equations = Equations::new(&[
    "interval = dt\n",
    DECAY,
    "deviation = state - signal
             state = signal + deviation * left
             out = signal + deviation * mean",
])
.remembering(&["state"], "state = signal");

impl ActuatorLag {
    /// The output, and the decay that was computed last.
    pub(super) const MEMORY: usize = 1 + DECAY_MEMORY;
}

impl Effect for ActuatorLag {
    fn spec(&self) -> &'static Spec {
        &SPEC
    }

    /// The memory is the output `x`, and the decay that was computed last.
    fn step(&self, parameters: &[f64], memory: &mut [f64], at: &Moment) -> f64 {
        let (&[time_constant], [state, known @ ..]) = (parameters, memory) else {
            return at.signal;
        };
        let decay = Decay::recall(known, at.dt_s, time_constant);
        let deviation = *state - at.signal;
        *state = at.signal + deviation * decay.left;
        at.signal + deviation * decay.mean
    }

    fn guesses(&self, _record: &RecordRange<'_>) -> Vec<Vec<f64>> {
        vec![vec![0.05], vec![0.3]]
    }
}

#[cfg(test)]
mod tests {
    use super::super::testing::{assert_close, run};
    use super::*;

    #[test]
    fn follows_its_closed_form() {
        // Means of 1 − exp(−t/T) over the first and the second interval, dt = T.
        let e = (-1.0_f64).exp();
        let outputs = run(&ActuatorLag, &[0.01], &[1.0, 1.0]);
        assert_close(&outputs, &[e, 1.0 - (1.0 - e) * e]);
    }

    #[test]
    fn starts_steady_where_it_is_settled() {
        let mut memory = [0.0; 5];
        let at = super::super::testing::moment(2.0);
        ActuatorLag.settle(&[0.1], &mut memory, &at);
        assert_close(&[ActuatorLag.step(&[0.1], &mut memory, &at)], &[2.0]);
    }
}
