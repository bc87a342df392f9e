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
//! Whatever moved a joint before, what is left of it is a sum of the same modes.

use super::basis::Motion;
use super::broken_line::floor;
use crate::units::SamplePeriod;

/// Most parameters of a lag.
pub(super) const MOST: usize = 3;

/// A number that was estimated.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LagPart {
    /// Its value.
    pub value: f64,
    /// Its standard error.
    pub std_error: f64,
}

/// The lag that all steps of a joint share, behind the dead time that each has of its own.
///
/// With neither part the joint follows at once.
#[derive(Clone, Debug, PartialEq)]
pub struct Lag {
    period: SamplePeriod,
    shape: Shape,
    /// Covariance of the shape's parameters.
    covariance: [[f64; MOST]; MOST],
}

impl Lag {
    pub(super) fn new(period: SamplePeriod, shape: Shape, covariance: [[f64; MOST]; MOST]) -> Self {
        Self { period, shape, covariance }
    }

    /// A joint that follows at once.
    pub(super) fn none() -> Self {
        Self::new(SamplePeriod::ONE_SECOND, Shape::NONE, [[0.0; MOST]; MOST])
    }

    /// Number of its parameters: 0 to 3.
    pub fn order(&self) -> usize {
        self.shape.order()
    }

    /// Time constant of the first-order part, seconds.
    pub fn time_constant_s(&self) -> Option<LagPart> {
        let value = self.shape.time_constant()? * self.period.seconds();
        Some(LagPart { value, std_error: value * self.error_of(0) })
    }

    /// Period of the second-order part without its damping, seconds.
    pub fn period_s(&self) -> Option<LagPart> {
        let (omega, _) = self.shape.pair()?;
        let value = std::f64::consts::TAU / omega * self.period.seconds();
        Some(LagPart { value, std_error: value * self.error_of(self.shape.pair_at()) })
    }

    /// Damping ratio of the second-order part.
    pub fn damping(&self) -> Option<LagPart> {
        let (_, value) = self.shape.pair()?;
        Some(LagPart { value, std_error: value * self.error_of(self.shape.pair_at() + 1) })
    }

    /// How late a steady motion is behind the dead time, seconds.
    pub fn mean_s(&self) -> LagPart {
        let slope = self.shape.slopes(|shape| Response::of(shape).mean);
        let std_error = self.variance_along(&slope).sqrt() * self.period.seconds();
        LagPart { value: Response::of(&self.shape).mean * self.period.seconds(), std_error }
    }

    /// The shape for samples of another period.
    pub(super) fn shape_at(&self, period: SamplePeriod) -> Shape {
        self.shape.stretched(self.period.seconds() / period.seconds())
    }

    /// Variance of what changes by `slopes` with the parameters.
    pub(super) fn variance_along(&self, slopes: &[f64; MOST]) -> f64 {
        let rows = self.covariance.iter().zip(slopes);
        rows.map(|(row, a)| row.iter().zip(slopes).map(|(c, b)| a * c * b).sum::<f64>())
            .sum::<f64>()
            .max(0.0)
    }

    fn error_of(&self, index: usize) -> f64 {
        let row = self.covariance.get(index);
        row.and_then(|row| row.get(index)).copied().unwrap_or(f64::NAN).max(0.0).sqrt()
    }
}

/// Which poles a lag has.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Poles {
    None,
    Real,
    Pair,
    RealAndPair,
}

/// A lag by the logarithms of its parameters, times in samples: `ln T`, `ln ω`, `ln ζ`,
/// as far as it has them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Shape {
    pub(super) poles: Poles,
    pub(super) logs: [f64; MOST],
}

/// Step of a numerical derivative in a logarithm.
const STEP: f64 = 1e-5;

impl Shape {
    pub(super) const NONE: Self = Self { poles: Poles::None, logs: [0.0; MOST] };

    pub(super) fn real(time_constant: f64) -> Self {
        Self { poles: Poles::Real, logs: [time_constant.ln(), 0.0, 0.0] }
    }

    pub(super) fn pair_of(omega: f64, zeta: f64) -> Self {
        Self { poles: Poles::Pair, logs: [omega.ln(), zeta.ln(), 0.0] }
    }

    /// This pair with a real pole before it.
    pub(super) fn behind(self, time_constant: f64) -> Self {
        let [omega, zeta, _] = self.logs;
        Self { poles: Poles::RealAndPair, logs: [time_constant.ln(), omega, zeta] }
    }

    pub(super) fn order(&self) -> usize {
        match self.poles {
            Poles::None => 0,
            Poles::Real => 1,
            Poles::Pair => 2,
            Poles::RealAndPair => 3,
        }
    }

    fn time_constant(&self) -> Option<f64> {
        matches!(self.poles, Poles::Real | Poles::RealAndPair).then(|| self.logs[0].exp())
    }

    /// Where the pair's parameters begin.
    fn pair_at(&self) -> usize {
        usize::from(self.poles == Poles::RealAndPair)
    }

    /// ω and ζ.
    fn pair(&self) -> Option<(f64, f64)> {
        match (self.poles, self.logs) {
            (Poles::Pair, [omega, zeta, _]) | (Poles::RealAndPair, [_, omega, zeta]) => {
                Some((omega.exp(), zeta.exp()))
            }
            _ => None,
        }
    }

    /// Starts for each kind of lag that is about as late as this one.
    pub(super) fn nearby(&self) -> Vec<Vec<Self>> {
        const FACTORS: [f64; 3] = [0.6, 1.0, 1.7];
        const ZETAS: [f64; 3] = [0.2, 0.5, 1.2];
        let mean = Response::of(self).mean.max(0.2);
        let real = vec![Self::real(mean)];
        let pairs = match self.pair() {
            Some((omega, zeta)) => {
                FACTORS.map(|factor| Self::pair_of(omega * factor, zeta)).to_vec()
            }
            None => ZETAS.map(|zeta| Self::pair_of(2.0 * zeta / mean, zeta)).to_vec(),
        };
        let both = match (self.time_constant(), self.pair()) {
            (Some(_), Some(_)) => vec![*self],
            (_, Some((omega, _))) => [0.1, 0.5].map(|part| self.behind(part / omega)).to_vec(),
            _ => {
                ZETAS.map(|zeta| Self::pair_of(4.0 * zeta / mean, zeta).behind(mean / 2.0)).to_vec()
            }
        };
        vec![vec![Self::NONE], real, pairs, both]
    }

    /// Lags with fewer poles that are about as late, or have the same pair.
    pub(super) fn simpler(&self) -> Vec<Self> {
        let real = Self::real(Response::of(self).mean.max(0.2));
        let pair = self.pair().map(|(omega, zeta)| Self::pair_of(omega, zeta));
        match self.poles {
            Poles::None => Vec::new(),
            Poles::Real => vec![Self::NONE],
            Poles::Pair => vec![Self::NONE, real],
            Poles::RealAndPair => [Self::NONE, real].into_iter().chain(pair).collect(),
        }
    }

    /// Whether it has the same poles as `other`, at about the same places.
    pub(super) fn is_near(&self, other: &Self) -> bool {
        /// Difference of a logarithm.
        const NEAR: f64 = 0.01;
        let pairs = self.logs.iter().zip(&other.logs);
        self.poles == other.poles && pairs.take(self.order()).all(|(a, b)| (a - b).abs() < NEAR)
    }

    /// The same lag with all times `factor` as long.
    fn stretched(mut self, factor: f64) -> Self {
        let shift = factor.ln();
        match (self.poles, &mut self.logs) {
            (Poles::None, _) => {}
            (Poles::Real, [time, ..]) => *time += shift,
            (Poles::Pair, [omega, ..]) => *omega -= shift,
            (Poles::RealAndPair, [time, omega, _]) => {
                *time += shift;
                *omega -= shift;
            }
        }
        self
    }

    /// This shape with one logarithm a little larger.
    pub(super) fn nudged(mut self, index: usize) -> Self {
        if let Some(log) = self.logs.get_mut(index) {
            *log += STEP;
        }
        self
    }

    /// What a step of [`nudged`](Self::nudged) is to be divided by.
    pub(super) const fn nudge() -> f64 {
        STEP
    }

    /// This shape moved by `change`, within what samples can show: poles from a fifth of a
    /// sample to `longest` samples, damping of 0.02 to 3, of 0.95 beside a real pole.
    pub(super) fn moved(mut self, change: &[f64; MOST], longest: f64) -> Self {
        for (log, change) in self.logs.iter_mut().zip(change) {
            *log += change.clamp(-1.0, 1.0);
        }
        let times = 0.2_f64.ln()..=longest.max(1.0).ln();
        let omegas = -longest.max(1.0).ln()..=1.5_f64.ln();
        let within = |log: f64, range: &std::ops::RangeInclusive<f64>| {
            log.clamp(*range.start(), *range.end())
        };
        let zetas = |most: f64| 0.02_f64.ln()..=most.ln();
        match (self.poles, &mut self.logs) {
            (Poles::None, _) => {}
            (Poles::Real, [time, ..]) => *time = within(*time, &times),
            (Poles::Pair, [omega, zeta, _]) => {
                (*omega, *zeta) = (within(*omega, &omegas), within(*zeta, &zetas(3.0)));
            }
            (Poles::RealAndPair, [time, omega, zeta]) => {
                *time = within(*time, &times);
                (*omega, *zeta) = (within(*omega, &omegas), within(*zeta, &zetas(0.95)));
            }
        }
        self
    }

    /// Derivatives of `value` to the logarithms.
    fn slopes(&self, value: impl Fn(&Self) -> f64) -> [f64; MOST] {
        let at = value(self);
        let mut slopes = [0.0; MOST];
        for (index, slope) in slopes.iter_mut().enumerate().take(self.order()) {
            *slope = (value(&self.nudged(index)) - at) / STEP;
        }
        slopes
    }
}

/// Settling times after which nothing is left of a transient: e⁻³⁰.
const OVER: f64 = 10.0;

/// A shape ready to be computed; times in samples.
#[derive(Clone, Copy, Debug)]
pub(super) struct Response {
    /// How late a steady motion is.
    pub(super) mean: f64,
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
        if root * t < 1e-4 {
            let decay = (-sigma * t).exp();
            return (decay * (1.0 - q * t * t / 2.0), decay * t * (1.0 - q * t * t / 6.0));
        }
        if q > 0.0 {
            let decay = (-sigma * t).exp();
            let (sine, cosine) = (root * t).sin_cos();
            return (decay * cosine, decay * sine / root);
        }
        let (slow, fast) = ((-(sigma - root) * t).exp(), (-(sigma + root) * t).exp());
        (f64::midpoint(slow, fast), (slow - fast) / (2.0 * root))
    }
}

impl Response {
    pub(super) fn of(shape: &Shape) -> Self {
        let rate = shape.time_constant().map(|time| 1.0 / time);
        let poles = shape.pair().map(|(omega, zeta)| (omega, zeta * omega));
        let mean = rate.map_or(0.0, |rate| 1.0 / rate)
            + poles.map_or(0.0, |(omega, sigma)| 2.0 * sigma / (omega * omega));
        let part = match (rate, poles) {
            (None, _) => 0.0,
            (Some(rate), None) => 1.0 / rate,
            (Some(rate), Some((omega, sigma))) => {
                let square = omega * omega;
                square / (rate * (rate * rate - 2.0 * sigma * rate + square))
            }
        };
        let pair = poles.map(|(omega, sigma)| {
            let cosine = mean - part;
            let sine = part * rate.unwrap_or(0.0) - 1.0 + sigma * cosine;
            Pair { sigma, q: omega * omega - sigma * sigma, cosine, sine }
        });
        Self { mean, real: rate.map(|rate| Real { rate, part }), pair }
    }

    /// Number of its modes.
    pub(super) fn modes(&self) -> usize {
        usize::from(self.real.is_some()) + 2 * usize::from(self.pair.is_some())
    }

    /// Samples until its slowest mode is down to a twentieth.
    pub(super) fn settling(&self) -> f64 {
        let slow = |pair: Pair| pair.sigma - (-pair.q).max(0.0).sqrt();
        let rates = [self.real.map(|real| real.rate), self.pair.map(slow)];
        rates.into_iter().flatten().map(|rate| 3.0 / rate).fold(0.0, f64::max)
    }

    /// Samples until nothing is left of a transient.
    pub(super) fn over(&self) -> f64 {
        OVER * self.settling()
    }

    /// The coefficients of level, ramp and modes that make up `G(t + k)` and `−dG/dt` there,
    /// for `k = 0, 1, …` and a `t` that is not negative.
    pub(super) fn motions(&self, t: f64) -> (Motion, Motion) {
        let Running { real: [real, _], rate, pair, now: (c, s), .. } = Running::at(self, t);
        let Pair { sigma, q, cosine, sine } = pair;
        let ahead = |a: f64, b: f64| [a * c + b * s, b * c - q * a * s];
        let position = self.in_order(real, ahead(cosine, sine));
        let slope =
            self.in_order(-rate * real, ahead(sine - sigma * cosine, -sigma * sine - q * cosine));
        let [a, b, c] = position;
        let backward = slope.map(|part| -part);
        ([t - self.mean, 1.0, a, b, c], [-1.0, 0.0, backward[0], backward[1], backward[2]])
    }

    /// The parts of a real pole and of a pair in the order of the modes.
    fn in_order(&self, real: f64, [cosine, sine]: [f64; 2]) -> [f64; MOST] {
        if self.real.is_some() { [real, cosine, sine] } else { [cosine, sine, 0.0] }
    }

    /// What the coefficients `of` modes become after so many samples as make the modes
    /// `decayed` from 1 or 0 at the first one.
    pub(super) fn later(&self, of: [f64; MOST], decayed: [f64; MOST]) -> [f64; MOST] {
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

    /// Puts `G(k − place)` into `position`, for `k = 0, 1, …`, and its derivative to the
    /// place, `−dG/dt`, into `backward`; 0 before the place.
    pub(super) fn fill(&self, place: f64, position: &mut [f64], backward: &mut [f64]) {
        let from = super::chain::ceil(place).min(position.len());
        let (quiet, active) = position.split_at_mut(from);
        quiet.fill(0.0);
        let (still, speeds) = backward.split_at_mut(from.min(backward.len()));
        still.fill(0.0);
        let mut t = from as f64 - place;
        let mut modes = Running::at(self, t);
        let over = floor(self.over()).min(active.len());
        let (moving, steady) = active.split_at_mut(over);
        for (slot, k) in steady.iter_mut().zip(0_u32..) {
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
    pub(super) fn fill_modes(&self, columns: &mut [f64], length: usize) {
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

    fn shapes() -> Vec<Shape> {
        let pairs = [(0.3, 0.25), (0.1, 1.0), (0.2, 1.8), (0.157, 0.999_999)];
        let pairs = pairs.map(|(omega, zeta)| Shape::pair_of(omega, zeta));
        let both = [Shape::pair_of(0.2, 0.3).behind(6.0), Shape::pair_of(0.1, 0.9).behind(2.0)];
        [Shape::NONE, Shape::real(6.0)].into_iter().chain(pairs).chain(both).collect()
    }

    /// Position after `t` samples by small Euler-midpoint steps of the equations.
    fn simulated(shape: &Shape, t: f64) -> f64 {
        let time = shape.time_constant();
        let rate = |state: [f64; 4]| {
            let [lagged, speed, acceleration, _] = state;
            let (d_lagged, drive) = time.map_or((0.0, 1.0), |time| ((1.0 - lagged) / time, lagged));
            let Some((omega, zeta)) = shape.pair() else {
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
        for shape in shapes() {
            let response = Response::of(&shape);
            let (mut position, mut backward) = (vec![0.0; 60], vec![0.0; 60]);
            response.fill(10.3, &mut position, &mut backward);
            for k in [11, 14, 25, 59] {
                let expected = simulated(&shape, k as f64 - 10.3);
                assert!((position[k] - expected).abs() < 1e-6, "{shape:?} {k}: {}", position[k]);
            }
            let (mut later, mut unused) = (vec![0.0; 60], vec![0.0; 60]);
            response.fill(10.3 + 1e-6, &mut later, &mut unused);
            for k in 12..60 {
                let slope = (later[k] - position[k]) / 1e-6;
                assert!((slope - backward[k]).abs() < 1e-4, "{shape:?} {k}");
            }
            assert!(position[..11].iter().all(|y| *y == 0.0));
        }
    }

    #[test]
    fn what_is_left_of_an_earlier_step_is_a_sum_of_the_modes() {
        for shape in shapes() {
            let response = Response::of(&shape);
            let (mut position, mut unused) = (vec![0.0; 50], vec![0.0; 50]);
            response.fill(-7.7, &mut position, &mut unused);
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
            let y = nalgebra::DVector::from_vec(position);
            let solved = all.clone().svd(true, true).solve(&y, 1e-13).unwrap();
            assert!((y - all * solved).norm() < 1e-8, "{shape:?}");
        }
    }
}
