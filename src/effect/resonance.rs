//! Resonance: the compressible oil is a spring on which the load swings.
//!
//! ```text
//! x'' + 2 damping ω x' + ω² x = ω² in,   ω = 2π / period
//! ```
//!
//! With `in` held over an interval `dt`, the deviation `d = x − in` and the rate `r = x'`
//! obey a linear equation whose solution is exact: with `a = damping · ω` and
//! `q = ω² − a²`
//!
//! ```text
//! d(dt) = (C + a S) d + S r        C = exp(−a dt) cos(√q dt)
//! r(dt) = −ω² S d + (C − a S) r    S = exp(−a dt) sin(√q dt) / √q
//! mean of d = −(Δr + 2 a Δd) / (ω² dt)
//! ```
//!
//! The last line is the equation of motion, integrated. Where `q < 0` (overdamped) the
//! functions are the hyperbolic ones; near `q = 0` both are the same power series. The
//! peaks in a record are `period / √(1 − damping²)` apart.
//!
//! # References
//! Merritt, H. E., 1967, Hydraulic Control Systems (hydraulic natural frequency).

use std::f64::consts::TAU;

use super::{Dimension, Effect, Moment, Parameter, RecordRange, Spec, Stage, UNLIMITED};

/// See the [module](self).
#[derive(Clone, Copy, Debug)]
pub struct Resonance;

static SPEC: Spec = Spec {
    id: "resonance",
    summary: "compressible oil: a poorly damped swing of the speed",
    equation: "d2 out/dt2 + 2 damping w d out/dt + w^2 out = w^2 in, w = 2 pi / period",
    source: "Merritt, 1967, Hydraulic Control Systems",
    stage: Stage::Dynamics,
    drawing: None,
    parameters: &[
        Parameter::new("period", "period without damping", Dimension::Seconds)
            .between(0.0, UNLIMITED),
        Parameter::new("damping", "damping ratio; 1 is critical", Dimension::One)
            .between(0.0, 10.0)
            .neutral(1.0),
    ],
    memory: 2 + RESPONSE_MEMORY,
    confused_with: &["actuator_lag"],
    absorbs: &[],
    acts_on_state: false,
};

/// Period below which the output is the input: it is then over before anything moves,
/// and its square is still far from the ends of what a number can hold.
const SHORTEST_S: f64 = 1e-9;

/// Range of the damping in a fit: an undamped joint would never rest, and far above
/// critical damping only the slow of the two lags is seen.
const FITTED_DAMPING: (f64, f64) = (0.01, 3.0);

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
        let response = Response::recall(known, omega, damping, at.dt_s);
        let (deviation, before) = (*state - at.signal, *rate);
        *state = at.signal + response.state[0] * deviation + response.state[1] * before;
        *rate = response.rate[0] * deviation + response.rate[1] * before;
        at.signal + response.mean[0] * deviation + response.mean[1] * before
    }

    fn settle(&self, _parameters: &[f64], memory: &mut [f64], at: &Moment) {
        if let [state, rate, ..] = memory {
            [*state, *rate] = [at.signal, 0.0];
        }
    }

    fn bounds(&self, record: &RecordRange<'_>) -> Vec<(f64, f64)> {
        let mut bounds: Vec<_> = SPEC.parameters.iter().map(|each| each.bounds(record)).collect();
        if let [_, damping] = bounds.as_mut_slice() {
            *damping = FITTED_DAMPING;
        }
        bounds
    }

    /// Two swings that drift apart by half a period within a hold do not find each other.
    fn guesses(&self, record: &RecordRange<'_>) -> Vec<Vec<f64>> {
        let shortest = 4.0 * record.sample_period_s;
        let periods = [0.12, 0.25, 0.5, 1.0].map(|period: f64| period.max(shortest));
        periods.into_iter().map(|period| vec![period, 0.2]).collect()
    }
}

/// What an interval makes of a deviation and a rate: the weights of the two.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Response {
    /// Of the deviation at its end.
    state: [f64; 2],
    /// Of the rate at its end.
    rate: [f64; 2],
    /// Of the mean deviation over it.
    mean: [f64; 2],
}

/// Numbers of memory that [`Response::recall`] needs.
const RESPONSE_MEMORY: usize = 9;

impl Response {
    /// The response to an interval of `dt_s`.
    fn over(omega: f64, damping: f64, dt_s: f64) -> Self {
        let a = damping * omega;
        let (c, s) = fundamental(a, omega * omega - a * a, omega, dt_s);
        let state = [c + a * s, s];
        let rate = [-omega * omega * s, c - a * s];
        Self { state, rate, mean: mean(state, rate, omega, a, dt_s) }
    }

    /// The same, taken from `memory` where it was last computed for these numbers.
    fn recall(memory: &mut [f64], omega: f64, damping: f64, dt_s: f64) -> Self {
        let [key @ .., a, b, c, d, e, f] = memory else {
            return Self::over(omega, damping, dt_s);
        };
        let wanted = [omega, damping, dt_s];
        let same = key.iter().zip(&wanted).all(|(a, b)| a.to_bits() == b.to_bits());
        if !same {
            let Self { state, rate, mean } = Self::over(omega, damping, dt_s);
            [[*a, *b], [*c, *d], [*e, *f]] = [state, rate, mean];
            key.iter_mut().zip(wanted).for_each(|(known, wanted)| *known = wanted);
        }
        Self { state: [*a, *b], rate: [*c, *d], mean: [*e, *f] }
    }
}

/// `exp(−a t) · cos(√q t)` and `exp(−a t) · sin(√q t) / √q`, for any sign of `q`.
fn fundamental(a: f64, q: f64, omega: f64, t: f64) -> (f64, f64) {
    /// Where the series are exact to the last digit.
    const NEAR_CRITICAL: f64 = 1e-2;
    let x = q * t * t;
    if x.abs() < NEAR_CRITICAL {
        let c = 1.0 - x / 2.0 * (1.0 - x / 12.0 * (1.0 - x / 30.0 * (1.0 - x / 56.0)));
        let s = t * (1.0 - x / 6.0 * (1.0 - x / 20.0 * (1.0 - x / 42.0)));
        let left = (-a * t).exp();
        return (left * c, left * s);
    }
    let root = q.abs().sqrt();
    if q > 0.0 {
        let ((sin, cos), left) = ((root * t).sin_cos(), (-a * t).exp());
        return (left * cos, left * sin / root);
    }
    // a − √(a² − ω²) without its cancellation.
    let slow = (-omega * omega / (a + root) * t).exp();
    let fast = (-(a + root) * t).exp();
    (f64::midpoint(slow, fast), (slow - fast) / (2.0 * root))
}

/// Weights of the mean deviation.
fn mean(state: [f64; 2], rate: [f64; 2], omega: f64, a: f64, t: f64) -> [f64; 2] {
    /// Below this part of a radian the differences below lose more digits than the
    /// series loses terms.
    const SHORT: f64 = 1e-3;
    let square = omega * omega;
    if (omega + a) * t < SHORT {
        let of_deviation = 1.0 - square * t * t / 6.0 * (1.0 - a * t / 2.0);
        let of_rate = t / 2.0 - a * t * t / 3.0 + (4.0 * a * a - square) * t * t * t / 24.0;
        return [of_deviation, of_rate];
    }
    let scale = -1.0 / (square * t);
    [scale * (rate[0] + 2.0 * a * (state[0] - 1.0)), scale * (rate[1] - 1.0 + 2.0 * a * state[1])]
}

#[cfg(test)]
mod tests {
    use super::super::testing::{assert_close, assert_close_to, moment};
    use super::*;

    /// Output at the end of an interval and its mean over it, from a step at its start.
    fn step_response(parameters: &[f64; 2], dt_s: f64) -> [f64; 2] {
        let mut memory = [0.0; 2 + RESPONSE_MEMORY];
        let mean = Resonance.step(parameters, &mut memory, &Moment { dt_s, ..moment(1.0) });
        [memory[0], mean]
    }

    #[test]
    fn undamped_it_is_a_cosine() {
        // 1 − cos after a half and after a whole period; the mean over both is 1.
        assert_close(&step_response(&[2.0, 0.0], 1.0), &[2.0, 1.0]);
        assert_close(&step_response(&[2.0, 0.0], 2.0), &[0.0, 1.0]);
    }

    #[test]
    fn critically_damped_it_follows_its_closed_form() {
        // ω = 1: x = 1 − (1 + t) e^−t, its integral t − 2 + (2 + t) e^−t, at t = 1.
        let e = (-1.0_f64).exp();
        assert_close(&step_response(&[TAU, 1.0], 1.0), &[1.0 - 2.0 * e, -1.0 + 3.0 * e]);
    }

    #[test]
    fn overdamped_it_is_two_lags() {
        // ω = 1, damping 1.25: time constants 2 and 1/2.
        let (slow, fast) = ((-0.5_f64).exp(), (-2.0_f64).exp());
        let end = 1.0 - (4.0 * slow - fast) / 3.0;
        let mean = 1.0 - (8.0 * (1.0 - slow) - 0.5 * (1.0 - fast)) / 3.0;
        assert_close(&step_response(&[TAU, 1.25], 1.0), &[end, mean]);
    }

    #[test]
    fn nothing_jumps_where_the_formulas_change() {
        for (damping, dt_s) in [(0.995, 1.0), (1.005, 1.0), (0.7, 1e-3 / 1.7), (2.0, 1e-3 / 3.0)] {
            let below = step_response(&[TAU, damping * (1.0 - 1e-9)], dt_s * (1.0 - 1e-9));
            let above = step_response(&[TAU, damping * (1.0 + 1e-9)], dt_s * (1.0 + 1e-9));
            assert_close_to(&below, &above, 1e-8);
        }
        let critical = step_response(&[TAU, 1.0], 1.0);
        assert_close_to(&critical, &step_response(&[TAU, 1.0 + 1e-9], 1.0), 1e-8);
    }

    #[test]
    fn an_interval_in_two_parts_has_the_same_end_and_mean() {
        for damping in [0.05, 1.0, 2.5] {
            let whole = step_response(&[0.3, damping], 0.02);
            let mut memory = [0.0; 2 + RESPONSE_MEMORY];
            let mut part = |dt_s| {
                let at = Moment { dt_s, ..moment(1.0) };
                Resonance.step(&[0.3, damping], &mut memory, &at) * dt_s
            };
            let mean = (part(1e-6) + part(0.02 - 1e-6)) / 0.02;
            assert_close(&[memory[0], mean], &whole);
        }
    }
}
