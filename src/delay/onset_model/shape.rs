//! The responses that a joint may have: one entry each.
//!
//! A shape is the response of the output to a step of the input after the dead time. All but two
//! are the integral of a speed that follows through a lag; times in samples:
//!
//! ```text
//! bend         y' = s                             two lines that meet
//! bend_lag     y' = v,  T v' = s − v              first-order lag
//! bend_lag2    y' = v,  v'' = ω²(s − v) − 2ζω v'  ζ ≥ 1: two real poles
//! oscillation  the same, ζ < 1
//!              v'' = ω²(x − v) − 2ζω v',          either with a third pole
//!              T x' = s − x
//! settling     T y' = s − y                       first order: a bump test is one step of it
//!              y'' = ω²(s − y) − 2ζω y'           the same with a second pole, ζ ≥ 1
//! slew         y' = s from the onset on for r·|Δu| samples: a constant rate into a level
//! ```
//!
//! `s` is constant but for a jump at each onset. Where holds are curved, as by a gain that changes
//! with the angle, `s' = q` with a `q` that may jump, too, and is of no interest.

use crate::delay::neutral::Transition;
use crate::numerics::halved;

/// Which of the responses.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(in crate::delay) enum Family {
    Bend,
    Lag,
    Pair,
    Triple,
    Settling,
    SettlingPair,
    Slew,
}

impl Family {
    pub(in crate::delay) const ALL: [Self; 7] = [
        Self::Bend,
        Self::Lag,
        Self::Pair,
        Self::Triple,
        Self::Settling,
        Self::SettlingPair,
        Self::Slew,
    ];

    /// Those whose output goes on moving.
    pub(in crate::delay) const MOVING: [Self; 4] =
        [Self::Bend, Self::Lag, Self::Pair, Self::Triple];

    /// Whether holds may be curved: the others come to rest.
    pub(super) fn may_be_curved(self) -> bool {
        Self::MOVING.contains(&self)
    }
}

/// Parameters of a response at most.
pub(super) const MOST: usize = 3;

/// A response with its parameters.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Shape {
    pub(super) family: Family,
    /// Whether the speed changes within holds.
    pub(super) curved: bool,
    /// `ln T`, or `ln ω` and `ln ζ`, with `ln T` after them where there is a third pole, or `ln r`;
    /// times in samples.
    pub(super) logs: [f64; MOST],
}

/// The responses to the kinds of steps, in the order of [`Transition::ALL`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Shapes([Shape; Transition::ALL.len()]);

impl Shapes {
    /// One for all kinds.
    pub(super) fn shared(shape: Shape) -> Self {
        Self([shape; Transition::ALL.len()])
    }

    pub(super) fn of(&self, kind: Transition) -> Shape {
        self.0[kind as usize]
    }

    pub(super) fn set(&mut self, kind: Transition, shape: Shape) {
        self.0[kind as usize] = shape;
    }

    pub(super) fn scaled(self, factor: f64) -> Self {
        Self(self.0.map(|shape| shape.scaled(factor)))
    }

    /// Each of them once.
    pub(super) fn distinct(&self) -> Vec<Shape> {
        let mut found: Vec<Shape> = Vec::new();
        for shape in self.0 {
            if !found.contains(&shape) {
                found.push(shape);
            }
        }
        found
    }
}

/// Damping up to which a pair of poles oscillates.
const CRITICAL: f64 = 1.0;

impl Shape {
    pub(super) const BEND: Self = Self { family: Family::Bend, curved: false, logs: [0.0; MOST] };

    /// Number of its parameters.
    pub(super) fn order(&self) -> usize {
        match self.family {
            Family::Bend => 0,
            Family::Lag | Family::Settling | Family::Slew => 1,
            Family::Pair | Family::SettlingPair => 2,
            Family::Triple => 3,
        }
    }

    /// States between the speed, or the level, that a step sets and what the output does.
    pub(super) fn followers(&self) -> usize {
        match self.family {
            Family::Bend | Family::Settling | Family::Slew => 0,
            Family::Lag | Family::SettlingPair => 1,
            Family::Pair => 2,
            Family::Triple => 3,
        }
    }

    /// Its name in files.
    pub(super) fn id(&self) -> &'static str {
        match self.family {
            Family::Bend => "bend",
            Family::Lag => "bend_lag",
            Family::Pair | Family::Triple if self.logs[1].exp() < CRITICAL => "oscillation",
            Family::Pair | Family::Triple => "bend_lag2",
            Family::Settling | Family::SettlingPair => "settling",
            Family::Slew => "slew",
        }
    }

    /// How late a steady motion is after its onset.
    pub(super) fn mean(&self) -> f64 {
        match self.family {
            Family::Bend | Family::Settling | Family::SettlingPair | Family::Slew => 0.0,
            Family::Lag => self.logs[0].exp(),
            Family::Pair => self.pair_mean(),
            Family::Triple => self.pair_mean() + self.logs[2].exp(),
        }
    }

    /// How late a steady motion is after a pair of poles.
    fn pair_mean(&self) -> f64 {
        2.0 * (self.logs[1] - self.logs[0]).exp()
    }

    /// Samples for which the motion lasts that a step of the input by `change` starts.
    pub(super) fn lasts(&self, change: f64) -> f64 {
        match self.family {
            Family::Slew => self.logs[0].exp() * change.abs(),
            _ => f64::INFINITY,
        }
    }

    /// This response in samples that are `factor` times as short.
    pub(super) fn scaled(mut self, factor: f64) -> Self {
        match self.family {
            Family::Bend => {}
            Family::Pair | Family::SettlingPair => self.logs[0] -= factor.ln(),
            Family::Lag | Family::Settling | Family::Slew => self.logs[0] += factor.ln(),
            Family::Triple => {
                self.logs[0] -= factor.ln();
                self.logs[2] += factor.ln();
            }
        }
        self
    }

    /// This response with its parameters changed: an overdamped pair by the mean of its lag and by its
    /// damping, which are nearly independent, three poles by what they have in common, all others by
    /// their logarithms.
    pub(super) fn moved(mut self, by: [f64; MOST]) -> Self {
        /// Damping from which the mean of the lag is what is known best.
        const DAMPED: f64 = 0.7;
        let is_pair = matches!(self.family, Family::Pair | Family::SettlingPair | Family::Triple);
        let is_damped = is_pair && self.logs[1] > DAMPED.ln();
        if is_damped && self.family == Family::Triple {
            return self.moved_in_common(by);
        }
        self.logs[0] += if is_damped { by[1] - by[0] } else { by[0] };
        self.logs[1] += by[1];
        self.logs[2] += by[2];
        self
    }

    /// Three poles changed by the logarithms of the coefficients of their polynomial `1 + a s + b s² + c s³`
    /// in units of their mean `a`, and of this mean. Which of them is the third one is no matter to these;
    /// where it is the same as one of the others, its time constant and theirs have one effect.
    fn moved_in_common(&self, [mean, second, third]: [f64; MOST]) -> Self {
        let [omega, zeta, lag] = self.logs.map(f64::exp);
        let (pair, square) = (2.0 * zeta / omega, omega.powi(-2));
        let a = (pair + lag) * mean.exp();
        let b = (square + pair * lag) * (2.0 * mean + second).exp();
        let c = square * lag * (3.0 * mean + third).exp();
        // Time constants are the roots of x³ − a x² + b x − c; there is one from 0 to a of stable poles.
        let value = |x: f64| ((x - a) * x + b) * x - c;
        let (_, high) = halved((0.0, a), 60, |x| value(x) < 0.0);
        let omega = (high / c).sqrt();
        let logs = [omega.ln(), (omega * (a - high) / 2.0).ln(), high.ln()];
        Self { logs, ..*self }
    }

    /// Whether samples can show it where holds last `hold` samples and steps of the input are by
    /// `change`. A lag of less than 0.7 samples
    /// moves the corner between samples, as a later onset does.
    pub(super) fn is_allowed(&self, hold: f64, change: f64) -> bool {
        let [first, second, third] = self.logs;
        let time = 0.7_f64.ln()..=(8.0 * hold).ln();
        match self.family {
            Family::Bend => true,
            Family::Lag | Family::Settling => time.contains(&first),
            // One that outlasts holds is a bend.
            Family::Slew => self.lasts(change) < hold,
            Family::Pair | Family::Triple => {
                (-(4.0 * hold).ln()..=0.9).contains(&first)
                    && (0.02_f64.ln()..=3.0_f64.ln()).contains(&second)
                    && self.real_lags().is_none_or(|[_, fast]| time.contains(&fast.ln()))
                    && (self.family == Family::Pair || time.contains(&third))
            }
            Family::SettlingPair => {
                second <= 3.0_f64.ln()
                    && self
                        .real_lags()
                        .is_some_and(|both| both.iter().all(|lag| time.contains(&lag.ln())))
            }
        }
    }

    /// Responses of a family from which its parameters are searched, for holds of `hold` samples
    /// and steps of the input by `change`.
    pub(super) fn grid(family: Family, hold: f64, change: f64) -> Vec<Self> {
        let shape = |first: f64, second: f64| Self {
            family,
            curved: false,
            logs: [first.ln(), second.ln(), 0.0],
        };
        let times = |from: f64, factor: f64, to: f64| {
            std::iter::successors(Some(from), move |t| Some(t * factor))
                .take_while(move |t| *t < to)
        };
        match family {
            Family::Bend => vec![Self::BEND],
            Family::Lag => times(1.0, 2.5, 1.5 * hold).map(|t| shape(t, 1.0)).collect(),
            Family::Settling => times(1.5, 2.5, 4.0 * hold).map(|t| shape(t, 1.0)).collect(),
            Family::Slew => {
                times(0.02, 2.0, 1.0).map(|part| shape(part * hold / change, 1.0)).collect()
            }
            // Found from those with a pole less.
            Family::SettlingPair | Family::Triple => Vec::new(),
            Family::Pair => times(10.0, 2.4, 2.0 * hold)
                .flat_map(|t| [0.15, 0.5, 1.2].map(|zeta| shape(std::f64::consts::TAU / t, zeta)))
                .collect(),
        }
    }

    /// Its parameters in seconds, with the names that they have in files.
    pub(super) fn parameters(&self, period_s: f64) -> Vec<(&'static str, f64)> {
        let [first, second, third] = self.logs.map(f64::exp);
        match self.family {
            Family::Bend => Vec::new(),
            Family::Lag | Family::Settling => vec![("time_constant_s", first * period_s)],
            Family::Slew => vec![("duration_s_per_unit", first * period_s)],
            Family::Pair | Family::Triple if second < CRITICAL => {
                let period = std::f64::consts::TAU / first * period_s;
                let mut found = vec![("period_s", period), ("damping", second)];
                if self.family == Family::Triple {
                    found.push(("time_constant_s", third * period_s));
                }
                found
            }
            Family::Pair | Family::SettlingPair | Family::Triple => {
                const NAMES: [&str; MOST] =
                    ["time_constant_s", "second_time_constant_s", "third_time_constant_s"];
                let mut lags = self.real_lags().unwrap_or_default().to_vec();
                lags.extend((self.family == Family::Triple).then_some(third));
                lags.sort_by(|a, b| b.total_cmp(a));
                NAMES.into_iter().zip(lags.into_iter().map(|lag| lag * period_s)).collect()
            }
        }
    }

    /// The time constants of an overdamped pair, the longer one first: the poles of `s² + 2ζωs + ω²`.
    pub(super) fn real_lags(&self) -> Option<[f64; 2]> {
        let [omega, zeta, _] = self.logs.map(f64::exp);
        let root = (zeta * zeta - 1.0).sqrt();
        (zeta >= CRITICAL).then(|| [zeta + root, zeta - root].map(|p| p / omega))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Three real poles, of which the last is the third one.
    fn lags([one, other, third]: [f64; 3]) -> Shape {
        let omega = (one * other).sqrt().recip();
        let zeta = (one + other) * omega / 2.0;
        Shape { family: Family::Triple, curved: false, logs: [omega.ln(), zeta.ln(), third.ln()] }
    }

    fn polynomial(shape: &Shape) -> [f64; 3] {
        let [omega, zeta, lag] = shape.logs.map(f64::exp);
        let (pair, square) = (2.0 * zeta / omega, omega.powi(-2));
        [pair + lag, square + pair * lag, square * lag]
    }

    #[test]
    fn three_poles_move_alike_whichever_is_the_third_one() {
        for by in [[0.0; 3], [0.1, -0.02, 0.05], [-0.2, 0.01, -0.1]] {
            let moved = [[4.0, 7.0, 3.0], [3.0, 7.0, 4.0], [4.0, 3.0, 7.0]]
                .map(|of| polynomial(&lags(of).moved(by)));
            let [one, other, third] = &moved;
            for k in 0..3 {
                let apart = (one[k] / other[k]).ln().abs() + (one[k] / third[k]).ln().abs();
                assert!(apart < 1e-9, "{by:?}: {moved:?}");
            }
            assert!((one[0].ln() - 14.0_f64.ln() - by[0]).abs() < 1e-9, "{moved:?}");
        }
    }
}
