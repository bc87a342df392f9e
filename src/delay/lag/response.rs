//! How a joint follows behind its dead time: what a lag makes of a step of the speed.
//!
//! The lag has a real pole, a pair of poles, or both:
//!
//! ```text
//! H(s) = 1/(T·s + 1) · ω²/(s² + 2·ζ·ω·s + ω²)
//! ```
//!
//! Its answer to a unit step of the speed is, integrated, `G(t) = t − mean + transient(t)`:
//! late by the `mean` of its impulse response, and a transient of decaying modes,
//!
//! ```text
//! transient(t) = a·e^(−t/T) + e^(−σt)·(b·C(t) + d·S(t))      σ = ζω, q = ω² − σ²
//! C = cos(√q·t), S = sin(√q·t)/√q; for q < 0 their hyperbolic twins
//! ```
//!
//! Whatever moved a joint before, what remains of it is a sum of the same modes.

use super::model::{LagModel, MAX_PARAMETERS};
use super::motion::Motion;
use crate::units::{ceil_to_index, floor_to_index};

/// Settling times after which nothing is left of a transient: e⁻³⁰.
const OVER: f64 = 10.0;

/// A model ready to be computed; times in samples.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Response {
    /// How late a steady motion is.
    pub(crate) mean: f64,
    real: Option<Real>,
    pair: Option<Pair>,
}

#[derive(Clone, Copy, Debug)]
struct Real {
    rate: f64,
    part: f64,
}

#[derive(Clone, Copy, Debug)]
struct Pair {
    sigma: f64,
    q: f64,
    cosine: f64,
    sine: f64,
}

impl Pair {
    /// `e^(−σt)·C(t)` and `e^(−σt)·S(t)`.
    fn modes(&self, t: f64) -> (f64, f64) {
        let Self { sigma, q, .. } = *self;
        let root = q.abs().sqrt();
        // Critically damped, or nearly: the series, since sin(x)/x loses its digits.
        if root * t < 1e-4 {
            let decay = (-sigma * t).exp();
            return (decay * (1.0 - q * t * t / 2.0), decay * t * (1.0 - q * t * t / 6.0));
        }
        if q > 0.0 {
            let decay = (-sigma * t).exp();
            let (sine, cosine) = (root * t).sin_cos();
            return (decay * cosine, decay * sine / root);
        }
        // e^(−σt) inside the hyperbolic functions, whose own would overflow.
        let (slow, fast) = ((-(sigma - root) * t).exp(), (-(sigma + root) * t).exp());
        (f64::midpoint(slow, fast), (slow - fast) / (2.0 * root))
    }
}

impl Response {
    pub(crate) fn of(model: &LagModel) -> Self {
        let rate = model.time_constant().map(|time| 1.0 / time);
        let poles = model.pair().map(|(omega, zeta)| (omega, zeta * omega));
        let mean = rate.map_or(0.0, |rate| 1.0 / rate)
            // −H′(0): T + 2ζ/ω.
            + poles.map_or(0.0, |(omega, sigma)| 2.0 * sigma / (omega * omega));
        let part = match (rate, poles) {
            (None, _) => 0.0,
            (Some(rate), None) => 1.0 / rate,
            (Some(rate), Some((omega, sigma))) => {
                let square = omega * omega;
                // The residue of H(s)/s² at the real pole.
                square / (rate * (rate * rate - 2.0 * sigma * rate + square))
            }
        };
        let pair = poles.map(|(omega, sigma)| {
            // G and dG/dt are 0 at t = 0.
            let cosine = mean - part;
            let sine = part * rate.unwrap_or(0.0) - 1.0 + sigma * cosine;
            Pair { sigma, q: omega * omega - sigma * sigma, cosine, sine }
        });
        Self { mean, real: rate.map(|rate| Real { rate, part }), pair }
    }

    /// Number of its modes.
    pub(crate) fn modes(&self) -> usize {
        usize::from(self.real.is_some()) + 2 * usize::from(self.pair.is_some())
    }

    /// Samples until its slowest mode is down to a twentieth.
    pub(crate) fn settling_time(&self) -> f64 {
        // The real part of the slower pole of the pair.
        let slow = |pair: Pair| pair.sigma - (-pair.q).max(0.0).sqrt();
        let rates = [self.real.map(|real| real.rate), self.pair.map(slow)];
        rates.into_iter().flatten().map(|rate| 3.0 / rate).fold(0.0, f64::max)
    }

    /// Samples until nothing is left of a transient.
    pub(crate) fn over(&self) -> f64 {
        OVER * self.settling_time()
    }

    /// The coefficients of level, ramp and modes that make up `G(t + k)` and `−dG/dt` there,
    /// for `k = 0, 1, …` and a `t` that is not negative.
    pub(crate) fn motions(&self, t: f64) -> (Motion, Motion) {
        let Running { real: [real, _], rate, pair, now: (c, s), .. } = Running::at(self, t);
        let Pair { sigma, q, cosine, sine } = pair;
        // C(t + k) = C(t)·C(k) − q·S(t)·S(k), S(t + k) = S(t)·C(k) + C(t)·S(k).
        let ahead = |a: f64, b: f64| [a * c + b * s, b * c - q * a * s];
        let step_response = self.in_order(real, ahead(cosine, sine));
        let slope =
            self.in_order(-rate * real, ahead(sine - sigma * cosine, -sigma * sine - q * cosine));
        let [a, b, c] = step_response;
        // ∂G(t − τ)/∂τ = −dG/dt.
        let derivative = slope.map(|part| -part);
        ([t - self.mean, 1.0, a, b, c], [-1.0, 0.0, derivative[0], derivative[1], derivative[2]])
    }

    /// The parts of a real pole and of a pair in the order of the modes.
    fn in_order(&self, real: f64, [cosine, sine]: [f64; 2]) -> [f64; MAX_PARAMETERS] {
        if self.real.is_some() { [real, cosine, sine] } else { [cosine, sine, 0.0] }
    }

    /// What the coefficients `of` modes become after so many samples as make the modes
    /// `decayed` from 1 or 0 at the first one.
    pub(crate) fn later(
        &self,
        of: [f64; MAX_PARAMETERS],
        decayed: [f64; MAX_PARAMETERS],
    ) -> [f64; MAX_PARAMETERS] {
        let turned =
            |q: f64, [a, b]: [f64; 2], [c, s]: [f64; 2]| [a * c + b * s, b * c - q * a * s];
        match (self.real, self.pair) {
            (real, Some(Pair { q, .. })) if real.is_some() => {
                let [a, b] = turned(q, [of[1], of[2]], [decayed[1], decayed[2]]);
                [of[0] * decayed[0], a, b]
            }
            (_, Some(Pair { q, .. })) => {
                let [a, b] = turned(q, [of[0], of[1]], [decayed[0], decayed[1]]);
                [a, b, 0.0]
            }
            _ => [of[0] * decayed[0], 0.0, 0.0],
        }
    }

    /// Puts `G(k − onset)` into `step_response`, for `k = 0, 1, …`, and its derivative to the
    /// onset, `−dG/dt`, into `derivative`; 0 before the onset.
    pub(crate) fn fill(&self, onset: f64, step_response: &mut [f64], derivative: &mut [f64]) {
        let from = ceil_to_index(onset).min(step_response.len());
        let (quiet, active) = step_response.split_at_mut(from);
        quiet.fill(0.0);
        let (still, speeds) = derivative.split_at_mut(from.min(derivative.len()));
        still.fill(0.0);
        let mut t = from as f64 - onset;
        let mut modes = Running::at(self, t);
        let over = floor_to_index(self.over()).min(active.len());
        let (moving, steady) = active.split_at_mut(over);
        for (slot, k) in steady.iter_mut().zip(0_u32..) {
            // Behind the transient G is a line.
            *slot = t + over as f64 + f64::from(k) - self.mean;
        }
        if let Some(steady) = speeds.get_mut(over..) {
            steady.fill(-1.0);
        }
        let mut speeds = speeds.iter_mut();
        for slot in moving {
            let (transient, slope) = modes.transient();
            *slot = t - self.mean + transient;
            if let Some(speed) = speeds.next() {
                *speed = -1.0 - slope;
            }
            modes.advance();
            t += 1.0;
        }
    }

    /// Fills the columns of the modes, each from 1 or 0 at the first sample.
    pub(crate) fn fill_modes(&self, columns: &mut [f64], length: usize) {
        let mut columns = columns.chunks_exact_mut(length.max(1));
        if let (Some(real), Some(column)) = (self.real, self.real.and_then(|_| columns.next())) {
            let decay = (-real.rate).exp();
            let mut value = 1.0;
            for slot in column {
                *slot = value;
                value *= decay;
            }
        }
        if let (Some(pair), Some(cosines), Some(sines)) =
            (self.pair, columns.next(), columns.next())
        {
            let (mut c, mut s) = (1.0, 0.0);
            let (step_c, step_s) = pair.modes(1.0);
            for (cosine, sine) in cosines.iter_mut().zip(sines) {
                (*cosine, *sine) = (c, s);
                // Turned by a sample, cheaper than a sine and exponential each.
                (c, s) = (c * step_c - pair.q * s * step_s, s * step_c + c * step_s);
            }
        }
    }
}

/// The modes at a time that goes on sample by sample.
struct Running {
    real: [f64; 2],
    decay: f64,
    rate: f64,
    pair: Pair,
    now: (f64, f64),
    step: (f64, f64),
}

impl Running {
    fn at(response: &Response, t: f64) -> Self {
        let still = Pair { sigma: 0.0, q: 0.0, cosine: 0.0, sine: 0.0 };
        let Real { rate, part } = response.real.unwrap_or(Real { rate: 0.0, part: 0.0 });
        let pair = response.pair.unwrap_or(still);
        Self {
            real: [part * (-rate * t).exp(), 0.0],
            decay: (-rate).exp(),
            rate,
            pair,
            now: pair.modes(t),
            step: pair.modes(1.0),
        }
    }

    /// The transient and its slope.
    fn transient(&self) -> (f64, f64) {
        let Pair { sigma, q, cosine, sine } = self.pair;
        let ((c, s), [real, _]) = (self.now, self.real);
        // d/dt of e^(−σt)·(b·C + d·S), with C′ = −q·S and S′ = C.
        let slope = (sine - sigma * cosine) * c - (sigma * sine + q * cosine) * s;
        (real + cosine * c + sine * s, slope - self.rate * real)
    }

    fn advance(&mut self) {
        let ((c, s), (step_c, step_s)) = (self.now, self.step);
        self.now = (c * step_c - self.pair.q * s * step_s, s * step_c + c * step_s);
        self.real[0] *= self.decay;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn models() -> Vec<LagModel> {
        let pairs = [(0.3, 0.25), (0.1, 1.0), (0.2, 1.8), (0.157, 0.999_999)];
        let pairs = pairs.map(|(omega, zeta)| LagModel::pair_of(omega, zeta));
        let both =
            [LagModel::pair_of(0.2, 0.3).behind(6.0), LagModel::pair_of(0.1, 0.9).behind(2.0)];
        [LagModel::NONE, LagModel::real(6.0)].into_iter().chain(pairs).chain(both).collect()
    }

    /// Position after `t` samples by small Euler-midpoint steps of the equations.
    fn simulated(model: &LagModel, t: f64) -> f64 {
        let time = model.time_constant();
        let rate = |state: [f64; 4]| {
            let [lagged, speed, acceleration, _] = state;
            let (d_lagged, drive) = time.map_or((0.0, 1.0), |time| ((1.0 - lagged) / time, lagged));
            let Some((omega, zeta)) = model.pair() else {
                return [d_lagged, 0.0, 0.0, drive];
            };
            let pull = omega * omega * (drive - speed) - 2.0 * zeta * omega * acceleration;
            [d_lagged, acceleration, pull, speed]
        };
        let moved = |state: [f64; 4], rate: [f64; 4], dt: f64| {
            std::array::from_fn(|i| state[i] + rate[i] * dt)
        };
        let steps = 40_000;
        let dt = t / f64::from(steps);
        let mut state = [0.0; 4];
        for _ in 0..steps {
            let middle = moved(state, rate(state), dt / 2.0);
            state = moved(state, rate(middle), dt);
        }
        state[3]
    }

    #[test]
    fn the_closed_form_is_what_the_equations_do() {
        for model in models() {
            let response = Response::of(&model);
            let (mut step_response, mut derivative) = (vec![0.0; 60], vec![0.0; 60]);
            response.fill(10.3, &mut step_response, &mut derivative);
            for k in [11, 14, 25, 59] {
                let expected = simulated(&model, k as f64 - 10.3);
                assert!(
                    (step_response[k] - expected).abs() < 1e-6,
                    "{model:?} {k}: {}",
                    step_response[k]
                );
            }
            let (mut later, mut unused) = (vec![0.0; 60], vec![0.0; 60]);
            response.fill(10.3 + 1e-6, &mut later, &mut unused);
            for k in 12..60 {
                let slope = (later[k] - step_response[k]) / 1e-6;
                assert!((slope - derivative[k]).abs() < 1e-4, "{model:?} {k}");
            }
            assert!(step_response[..11].iter().all(|y| *y == 0.0));
        }
    }

    #[test]
    fn what_is_left_of_an_earlier_step_is_a_sum_of_the_modes() {
        for model in models() {
            let response = Response::of(&model);
            let (mut step_response, mut unused) = (vec![0.0; 50], vec![0.0; 50]);
            response.fill(-7.7, &mut step_response, &mut unused);
            let count = response.modes();
            let mut columns = vec![0.0; 50 * count];
            response.fill_modes(&mut columns, 50);
            let ones = vec![1.0; 50];
            let line: Vec<f64> = (0..50).map(f64::from).collect();
            let all = nalgebra::DMatrix::from_fn(50, count + 2, |k, i| match i {
                0 => ones[k],
                1 => line[k],
                _ => columns[(i - 2) * 50 + k],
            });
            let y = nalgebra::DVector::from_vec(step_response);
            let solved = all.clone().svd(true, true).solve(&y, 1e-13).unwrap();
            assert!((y - all * solved).norm() < 1e-8, "{model:?}");
        }
    }
}
