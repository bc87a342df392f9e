//! A damped swing over one interval, in closed form.
//!
//! ```text
//! x'' + 2 a x' + ω² x = ω² in,   a = damping · ω
//! ```
//!
//! With `in` held over an interval `dt`, the deviation `d = x − in` and the rate `r = x'`
//! obey a linear equation whose solution is exact: with `q = ω² − a²`
//!
//! ```text
//! d(dt) = (C + a S) d + S r        C = exp(−a dt) cos(√q dt)
//! r(dt) = −ω² S d + (C − a S) r    S = exp(−a dt) sin(√q dt) / √q
//! mean of d = −(Δr + 2 a Δd) / (ω² dt)
//! ```
//!
//! The last line is the equation of motion, integrated. Where `q < 0` (overdamped) the
//! functions are the hyperbolic ones; near `q = 0` both are the same power series.

/// What an interval makes of a deviation and a rate: the weights of the two.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Swing {
    /// Of the deviation at its end.
    state: [f64; 2],
    /// Of the rate at its end.
    rate: [f64; 2],
    /// Of the mean deviation over it.
    mean: [f64; 2],
}

/// Numbers of memory that [`Swing::recall`] needs.
pub(super) const SWING_MEMORY: usize = 9;

/// [`Swing::over`] and [`Swing::advance`] as equations of `omega` and a damping `ratio`: they
/// move `state` and `rate` on, and give `out`; where `at_once`, the state is the signal.
pub(super) const SWING: &str = "
    a = ratio * omega
    q = omega * omega - a * a
    x = q * dt * dt
    is_short = abs(x) < 0.25
    root = sqrt(abs(q))
    left = exp(-a * dt)
    slow = exp(-omega * omega / (a + root) * dt)
    fast = exp(-(a + root) * dt)
    even = 1 - x / 2 * (1 - x / 12 * (1 - x / 30 * (1 - x / 56 * (1 - x / 90 * (1 - x / 132 * (1 - x / 182))))))
    odd = 1 - x / 6 * (1 - x / 20 * (1 - x / 42 * (1 - x / 72 * (1 - x / 110 * (1 - x / 156 * (1 - x / 210))))))
    cosine = if(q > 0, left * cos(root * dt), 0.5 * (slow + fast))
    sine = if(q > 0, left * sin(root * dt), 0.5 * (slow - fast)) / root
    c = if(is_short, left * even, cosine)
    s = if(is_short, left * dt * odd, sine)
    deviation = state - signal
    before = rate
    scale = -1 / (omega * omega * dt)
    is_brief = (omega + a) * dt < 1e-3
    brief_state = 1 - omega * omega * dt * dt / 6 * (1 - a * dt / 2)
    brief_rate = dt / 2 - a * dt * dt / 3 + (4 * a * a - omega * omega) * dt * dt * dt / 24
    mean_state = if(is_brief, brief_state, scale * (2 * a * (c + a * s - 1) - omega * omega * s))
    mean_rate = if(is_brief, brief_rate, scale * (c + a * s - 1))
    next = signal + (c + a * s) * deviation + s * before
    state = if(at_once, signal, next)
    rate = if(at_once, 0, (c - a * s) * before - omega * omega * s * deviation)
    out = if(at_once, signal, signal + mean_state * deviation + mean_rate * before)
";

impl Swing {
    /// The swing of `omega` radians a second in an interval of `dt_s`.
    pub(super) fn over(omega: f64, damping: f64, dt_s: f64) -> Self {
        let a = damping * omega;
        let (c, s) = fundamental(a, omega * omega - a * a, omega, dt_s);
        let state = [c + a * s, s];
        let rate = [-omega * omega * s, c - a * s];
        Self { state, rate, mean: mean(state, rate, omega, a, dt_s) }
    }

    /// This step, taken from `memory` where it was last computed for these numbers.
    pub(super) fn recall(memory: &mut [f64], omega: f64, damping: f64, dt_s: f64) -> Self {
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

    /// Moves `state` and `rate` on, toward `signal`; returns the mean of the state.
    pub(super) fn advance(&self, signal: f64, state: &mut f64, rate: &mut f64) -> f64 {
        let (deviation, before) = (*state - signal, *rate);
        *state = signal + self.state[0] * deviation + self.state[1] * before;
        *rate = self.rate[0] * deviation + self.rate[1] * before;
        signal + self.mean[0] * deviation + self.mean[1] * before
    }
}

/// `exp(−a t) · cos(√q t)` and `exp(−a t) · sin(√q t) / √q`, for any sign of `q`.
fn fundamental(a: f64, q: f64, omega: f64, t: f64) -> (f64, f64) {
    /// Where the series are exact to the last digit. They are faster than sines, and periods
    /// of more than 13 samples need no other.
    const SHORT: f64 = 0.25;
    let x = q * t * t;
    if x.abs() < SHORT {
        let (c, s) = (nested(x, &COSINE), t * nested(x, &SINE));
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

/// Of `cos √x = 1 − x/2 (1 − x/12 (1 − …))`.
const COSINE: [f64; 7] =
    [1.0 / 2.0, 1.0 / 12.0, 1.0 / 30.0, 1.0 / 56.0, 1.0 / 90.0, 1.0 / 132.0, 1.0 / 182.0];

/// Of `sin √x / √x = 1 − x/6 (1 − x/20 (1 − …))`.
const SINE: [f64; 7] =
    [1.0 / 6.0, 1.0 / 20.0, 1.0 / 42.0, 1.0 / 72.0, 1.0 / 110.0, 1.0 / 156.0, 1.0 / 210.0];

/// `1 − f₁ x (1 − f₂ x (1 − …))`.
fn nested(x: f64, factors: &[f64; 7]) -> f64 {
    factors.iter().rev().fold(1.0, |inner, factor| 1.0 - (x * factor) * inner)
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
    use std::f64::consts::TAU;

    use super::super::testing::{assert_close, assert_close_to};
    use super::*;

    /// State at the end of an interval and its mean over it, from a step at its start.
    fn step_response(period_s: f64, damping: f64, dt_s: f64) -> [f64; 2] {
        let (mut state, mut rate) = (0.0, 0.0);
        let mean = Swing::over(TAU / period_s, damping, dt_s).advance(1.0, &mut state, &mut rate);
        [state, mean]
    }

    #[test]
    fn critically_damped_it_follows_its_closed_form() {
        // ω = 1: x = 1 − (1 + t) e^−t, its integral t − 2 + (2 + t) e^−t, at t = 1.
        let e = (-1.0_f64).exp();
        assert_close(&step_response(TAU, 1.0, 1.0), &[1.0 - 2.0 * e, -1.0 + 3.0 * e]);
    }

    #[test]
    fn overdamped_it_is_two_lags() {
        // ω = 1, damping 1.25: time constants 2 and 1/2.
        let (slow, fast) = ((-0.5_f64).exp(), (-2.0_f64).exp());
        let end = 1.0 - (4.0 * slow - fast) / 3.0;
        let mean = 1.0 - (8.0 * (1.0 - slow) - 0.5 * (1.0 - fast)) / 3.0;
        assert_close(&step_response(TAU, 1.25, 1.0), &[end, mean]);
    }

    #[test]
    fn nothing_jumps_where_the_formulas_change() {
        let series = |x: f64| (1.0 - x).sqrt();
        let edges =
            [(series(0.25), 1.0), (series(-0.25), 1.0), (0.7, 1e-3 / 1.7), (2.0, 1e-3 / 3.0)];
        for (damping, dt_s) in edges {
            let below = step_response(TAU, damping * (1.0 - 1e-9), dt_s * (1.0 - 1e-9));
            let above = step_response(TAU, damping * (1.0 + 1e-9), dt_s * (1.0 + 1e-9));
            assert_close_to(&below, &above, 1e-8);
        }
        let critical = step_response(TAU, 1.0, 1.0);
        assert_close_to(&critical, &step_response(TAU, 1.0 + 1e-9, 1.0), 1e-8);
    }

    #[test]
    fn an_interval_in_two_parts_has_the_same_end_and_mean() {
        for damping in [0.05, 1.0, 2.5] {
            let whole = step_response(0.3, damping, 0.02);
            let (mut state, mut rate) = (0.0, 0.0);
            let mut part = |dt_s| {
                let swing = Swing::over(TAU / 0.3, damping, dt_s);
                swing.advance(1.0, &mut state, &mut rate) * dt_s
            };
            let mean = (part(1e-6) + part(0.02 - 1e-6)) / 0.02;
            assert_close(&[state, mean], &whole);
        }
    }

    #[test]
    fn what_is_recalled_is_what_would_be_computed() {
        let mut memory = [0.0; SWING_MEMORY];
        for (omega, damping, dt_s) in [(9.0, 0.1, 0.01), (9.0, 0.1, 0.01), (9.0, 0.1, 0.02)] {
            let expected = Swing::over(omega, damping, dt_s);
            assert_eq!(Swing::recall(&mut memory, omega, damping, dt_s), expected);
        }
    }
}
