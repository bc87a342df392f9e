//! The responses that a joint may have: one entry each.
//!
//! A shape is the response of the output to a step of the input behind the dead time. All but two
//! are the integral of a speed that follows through a lag; times in samples:
//!
//! ```text
//! bend         y' = s                             two lines that meet
//! bend_lag     y' = v,  T v' = s − v              first-order lag
//! bend_lag2    y' = v,  v'' = ω²(s − v) − 2ζω v'  ζ ≥ 1: two real poles
//! oscillation  the same, ζ < 1
//! settling     T y' = s − y                       first order: a bump test is one step of it
//! slew         y' = s from the onset on for r·|Δu| samples: a constant rate into a level
//! ```
//!
//! `s` is constant but for a jump at each onset. Where holds are curved, as by a gain that changes
//! with the angle, `s' = q` with a `q` that may jump, too, and is of no interest.

/// Which of the responses.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(in crate::delay) enum Family {
    Bend,
    Lag,
    Pair,
    Settling,
    Slew,
}

impl Family {
    pub(in crate::delay) const ALL: [Self; 5] =
        [Self::Bend, Self::Lag, Self::Pair, Self::Settling, Self::Slew];

    /// Whether holds may be curved: the others come to rest.
    pub(super) fn may_be_curved(self) -> bool {
        matches!(self, Self::Bend | Self::Lag | Self::Pair)
    }
}

/// A response with its parameters.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Shape {
    pub(super) family: Family,
    /// Whether the speed changes within holds.
    pub(super) curved: bool,
    /// `ln T`, or `ln ω` and `ln ζ`, or `ln r`; times in samples.
    pub(super) logs: [f64; 2],
}

/// Damping up to which a pair of poles oscillates.
const CRITICAL: f64 = 1.0;

impl Shape {
    pub(super) const BEND: Self = Self { family: Family::Bend, curved: false, logs: [0.0; 2] };

    /// Number of its parameters.
    pub(super) fn order(&self) -> usize {
        match self.family {
            Family::Bend => 0,
            Family::Lag | Family::Settling | Family::Slew => 1,
            Family::Pair => 2,
        }
    }

    /// Its name in files.
    pub(super) fn id(&self) -> &'static str {
        match self.family {
            Family::Bend => "bend",
            Family::Lag => "bend_lag",
            Family::Pair if self.logs[1].exp() < CRITICAL => "oscillation",
            Family::Pair => "bend_lag2",
            Family::Settling => "settling",
            Family::Slew => "slew",
        }
    }

    /// How late a steady motion is behind its onset.
    pub(super) fn mean(&self) -> f64 {
        match self.family {
            Family::Bend | Family::Settling | Family::Slew => 0.0,
            Family::Lag => self.logs[0].exp(),
            Family::Pair => 2.0 * (self.logs[1] - self.logs[0]).exp(),
        }
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
            Family::Pair => self.logs[0] -= factor.ln(),
            Family::Lag | Family::Settling | Family::Slew => self.logs[0] += factor.ln(),
        }
        self
    }

    /// This response with its parameters changed: an overdamped pair by the mean of its lag and by its
    /// damping, which are nearly independent, all others by their logarithms.
    pub(super) fn moved(mut self, by: [f64; 2]) -> Self {
        /// Damping from which the mean of the lag is what is known best.
        const DAMPED: f64 = 0.7;
        let is_damped = self.family == Family::Pair && self.logs[1] > DAMPED.ln();
        self.logs[0] += if is_damped { by[1] - by[0] } else { by[0] };
        self.logs[1] += by[1];
        self
    }

    /// Whether samples can show it where holds last `hold` samples and steps of the input are by
    /// `change`. A lag of less than 0.7 samples
    /// moves the corner between samples, as a later onset does.
    pub(super) fn is_allowed(&self, hold: f64, change: f64) -> bool {
        let [first, second] = self.logs;
        let time = 0.7_f64.ln()..=(8.0 * hold).ln();
        match self.family {
            Family::Bend => true,
            Family::Lag | Family::Settling => time.contains(&first),
            // One that outlasts holds is a bend.
            Family::Slew => self.lasts(change) < hold,
            Family::Pair => {
                (-(4.0 * hold).ln()..=0.9).contains(&first)
                    && (0.02_f64.ln()..=3.0_f64.ln()).contains(&second)
            }
        }
    }

    /// Responses of a family from which its parameters are searched, for holds of `hold` samples
    /// and steps of the input by `change`.
    pub(super) fn grid(family: Family, hold: f64, change: f64) -> Vec<Self> {
        let shape = |first: f64, second: f64| Self {
            family,
            curved: false,
            logs: [first.ln(), second.ln()],
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
            Family::Pair => times(10.0, 2.4, 2.0 * hold)
                .flat_map(|t| [0.15, 0.5, 1.2].map(|zeta| shape(std::f64::consts::TAU / t, zeta)))
                .collect(),
        }
    }

    /// Its parameters in seconds, with the names that they have in files.
    pub(super) fn parameters(&self, period_s: f64) -> Vec<(&'static str, f64)> {
        let [first, second] = self.logs.map(f64::exp);
        match self.family {
            Family::Bend => Vec::new(),
            Family::Lag | Family::Settling => vec![("time_constant_s", first * period_s)],
            Family::Slew => vec![("duration_s_per_unit", first * period_s)],
            Family::Pair if second < CRITICAL => {
                vec![("period_s", std::f64::consts::TAU / first * period_s), ("damping", second)]
            }
            Family::Pair => {
                // The real poles of s² + 2ζωs + ω².
                let root = (second * second - 1.0).sqrt();
                let [slow, fast] = [second + root, second - root].map(|p| p / first * period_s);
                vec![("time_constant_s", slow), ("second_time_constant_s", fast)]
            }
        }
    }
}
