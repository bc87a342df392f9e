//! Resonance: the compressible oil is a spring on which the load swings.
//!
//! ```text
//! x'' + 2 damping ω x' + ω² x = ω² in,   ω = 2π / period
//! ```
//!
//! The closed form over an interval is that of a damped swing. The peaks in a record are
//! `period / √(1 − damping²)` apart.
//!
//! # References
//! Merritt, H. E., 1967, Hydraulic Control Systems (hydraulic natural frequency).

use std::f64::consts::TAU;

use super::swing::{SWING, SWING_MEMORY, Swing};
use super::{Dimension, Effect, Equations, Moment, Parameter, RecordRange, Spec, Stage, UNLIMITED};

/// See the [module](self).
#[derive(Clone, Copy, Debug)]
pub struct Resonance;

static SPEC: Spec = Spec::new(
    "resonance",
    Stage::Dynamics,
    "compressible oil: a poorly damped oscillation of the speed",
)
.equation("d2 out/dt2 + 2 damping w d out/dt + w^2 out = w^2 in, w = 2 pi / period")
.source("Merritt, 1967, Hydraulic Control Systems")
.parameters(&[
    Parameter::new("period", "period without damping", Dimension::Seconds).between(0.0, UNLIMITED),
    Parameter::new("damping", "damping ratio; 1 is critical", Dimension::One)
        .between(0.0, 10.0)
        .neutral(1.0),
])
.memory(2 + SWING_MEMORY)
.starting_at_signal()
.confused_with(&["actuator_lag"])
.equations(
    Equations::new(&[
        "at_once = period < 1e-9
             omega = 2 * pi / max(period, 1e-9)
             ratio = damping\n",
        SWING,
    ])
    .remembering(&["state", "rate"], "state = signal\nrate = 0"),
);

/// Period below which the output is the input: it is then over before anything moves,
/// and its square is still far from the ends of what a number can hold.
pub(super) const SHORTEST_S: f64 = 1e-9;

/// Range of the damping in a fit: an undamped joint would never rest, and far above
/// critical damping only the slow of the two lags is seen.
pub(super) const FITTED_DAMPING: (f64, f64) = (0.01, 3.0);

/// Periods from which a fit starts. Two swings that drift apart by half a period within a
/// hold do not find each other.
pub(super) const PERIODS_S: [f64; 4] = [0.12, 0.25, 0.5, 1.0];

impl Effect for Resonance {
    fn spec(&self) -> &'static Spec {
        &SPEC
    }

    /// The memory is `x`, `x'` in input units per second, and the response that was
    /// computed last.
    fn step(&self, parameters: &[f64], memory: &mut [f64], at: &Moment) -> f64 {
        let (&[period, damping], [state, rate, known @ ..]) = (parameters, memory) else {
            return at.signal;
        };
        if period < SHORTEST_S {
            [*state, *rate] = [at.signal, 0.0];
            return at.signal;
        }
        let omega = TAU / period;
        Swing::recall(known, omega, damping, at.dt_s).advance(at.signal, state, rate)
    }

    /// Whether it swings: from critical damping on it is two lags.
    fn shows_its_form(&self, parameters: &[f64], _record: &RecordRange<'_>) -> bool {
        parameters.get(1).is_none_or(|damping| *damping < 1.0)
    }

    fn bounds(&self, record: &RecordRange<'_>) -> Vec<(f64, f64)> {
        let mut bounds: Vec<_> = SPEC.parameters.iter().map(|each| each.bounds(record)).collect();
        if let [_, damping] = bounds.as_mut_slice() {
            *damping = FITTED_DAMPING;
        }
        bounds
    }

    fn guesses(&self, record: &RecordRange<'_>) -> Vec<Vec<f64>> {
        let shortest = 4.0 * record.sample_period_s;
        PERIODS_S.map(|period| vec![period.max(shortest), 0.2]).to_vec()
    }
}

#[cfg(test)]
mod tests {
    use super::super::testing::{assert_close, moment};
    use super::*;

    #[test]
    fn a_step_swings_twice_as_far_and_back_in_a_period() {
        let step_response = |dt_s| {
            let mut memory = [0.0; 2 + SWING_MEMORY];
            let at = Moment { dt_s, ..moment(1.0) };
            let mean = Resonance.step(&[2.0, 0.0], &mut memory, &at);
            [memory[0], mean]
        };
        assert_close(&step_response(1.0), &[2.0, 1.0]);
        assert_close(&step_response(2.0), &[0.0, 1.0]);
    }
}
