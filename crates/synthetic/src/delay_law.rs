//! How long a step of the input takes to act.

use serde::{Deserialize, Serialize};

use crate::clock::Clock;
use crate::error::{NOT_NEGATIVE, POSITIVE, Place, PlantError};

/// What sets the delay of each step. All times are in seconds.
///
/// With `a` the level before the step, `b` the one after it, `t` its time:
///
/// | law | delay |
/// |---|---|
/// | `constant` | `seconds` |
/// | `uniform` | drawn for each step between `min` and `max` |
/// | `step_size` | `min + (max - min) exp(-abs(b - a) / scale)`: a small step takes longer |
/// | `direction` | `rising` where `b > a`, else `falling` |
/// | `warming` | `first` at the first sample, `last` at the last one, linear between |
/// | `listed` | the `i`-th of `seconds` for step `i` |
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "law", rename_all = "snake_case", deny_unknown_fields)]
#[non_exhaustive]
pub enum DelayLaw {
    /// One delay for all steps.
    Constant {
        /// Delay of each step.
        seconds: f64,
    },
    /// Drawn for each step, all values between the bounds alike.
    Uniform {
        /// Shortest delay.
        min: f64,
        /// Longest delay.
        max: f64,
    },
    /// Falls with the size of the step.
    StepSize {
        /// Delay of a very large step.
        min: f64,
        /// Delay of a very small step.
        max: f64,
        /// Size of step, in input units, that leaves 37 % of `max - min`.
        scale: f64,
    },
    /// One value up, another one down.
    Direction {
        /// Delay of a step to a higher level.
        rising: f64,
        /// Delay of a step to a lower level.
        falling: f64,
    },
    /// Changes in proportion to time, as oil that warms up.
    Warming {
        /// Delay at the first sample.
        first: f64,
        /// Delay at the last sample.
        last: f64,
    },
    /// Given for each step.
    Listed {
        /// Delay of step 1, of step 2, …
        seconds: Vec<f64>,
    },
}

/// A step, as a law of delay sees it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Occasion {
    /// Number of the step, from 0.
    pub(crate) index: usize,
    /// Input level before it.
    pub(crate) before: f64,
    /// Input level after it.
    pub(crate) after: f64,
    /// Its time as a fraction of the record: 0 at the first sample, 1 at the last.
    pub(crate) progress: f64,
    /// A number drawn for it, uniform in [0, 1).
    pub(crate) chance: f64,
    /// Seconds that the level before was held.
    pub(crate) held_s: f64,
    /// Seconds since the first sample.
    pub(crate) time_s: f64,
}

impl DelayLaw {
    /// Delay of one step in seconds; `None` where the list is too short.
    pub(crate) fn delay_s(&self, at: &Occasion) -> Option<f64> {
        Some(match self {
            Self::Constant { seconds } => *seconds,
            Self::Uniform { min, max } => between(*min, *max, at.chance),
            Self::StepSize { min, max, scale } => {
                between(*min, *max, (-(at.after - at.before).abs() / scale).exp())
            }
            Self::Direction { rising, .. } if at.after > at.before => *rising,
            Self::Direction { falling, .. } => *falling,
            Self::Warming { first, last } => between(*first, *last, at.progress),
            Self::Listed { seconds } => return seconds.get(at.index).copied(),
        })
    }

    /// A delay in seconds that no step exceeds.
    pub(crate) fn longest_s(&self) -> f64 {
        self.bounds().into_iter().map(|(_, seconds)| seconds).fold(0.0, f64::max)
    }

    /// Refuses a negative delay, one that is not finite, and bounds in wrong order.
    pub(crate) fn check(&self, clock: &Clock, place: &Place) -> Result<(), PlantError> {
        for (key, seconds) in self.bounds() {
            place.number(key, seconds, NOT_NEGATIVE, clock)?;
        }
        if let Self::Uniform { min, max } | Self::StepSize { min, max, .. } = self {
            place.require(&[("delay.min", min, min <= max, "not above `delay.max`")])?;
        }
        if let Self::StepSize { scale, .. } = self {
            place.number("delay.scale", *scale, POSITIVE, clock)?;
        }
        Ok(())
    }

    /// The times that it is made of, each with its key.
    fn bounds(&self) -> Vec<(&'static str, f64)> {
        match self {
            Self::Constant { seconds } => vec![("delay.seconds", *seconds)],
            Self::Uniform { min, max } | Self::StepSize { min, max, .. } => {
                vec![("delay.min", *min), ("delay.max", *max)]
            }
            Self::Direction { rising, falling } => {
                vec![("delay.rising", *rising), ("delay.falling", *falling)]
            }
            Self::Warming { first, last } => vec![("delay.first", *first), ("delay.last", *last)],
            Self::Listed { seconds } => seconds.iter().map(|s| ("delay.seconds", *s)).collect(),
        }
    }
}

/// `from` at fraction 0, `to` at fraction 1.
fn between(from: f64, to: f64, fraction: f64) -> f64 {
    from + (to - from) * fraction
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Step 2 of a record, from 1 to `after`, a quarter through, with chance 0.5.
    fn delay_s(law: &str, after: f64) -> Option<f64> {
        let at = Occasion {
            index: 1,
            before: 1.0,
            after,
            progress: 0.25,
            chance: 0.5,
            held_s: 1.0,
            time_s: 2.0,
        };
        toml::from_str::<DelayLaw>(law).unwrap().delay_s(&at)
    }

    fn assert_close(found: Option<f64>, expected: f64) {
        assert!((found.unwrap() - expected).abs() < 1e-12, "{found:?} is not {expected}");
    }

    #[test]
    fn each_law_gives_its_delay() {
        assert_close(delay_s("law = 'constant'\nseconds = 0.15", 2.0), 0.15);
        assert_close(delay_s("law = 'uniform'\nmin = 0.1\nmax = 0.5", 2.0), 0.3);
        let by_size = "law = 'step_size'\nmin = 0.1\nmax = 0.5\nscale = 2";
        assert_close(delay_s(by_size, -1.0), 0.1 + 0.4 * (-1.0_f64).exp());
        let by_direction = "law = 'direction'\nrising = 0.1\nfalling = 0.5";
        assert_close(delay_s(by_direction, 2.0), 0.1);
        assert_close(delay_s(by_direction, 0.0), 0.5);
        assert_close(delay_s("law = 'warming'\nfirst = 0.5\nlast = 0.1", 2.0), 0.4);
        assert_close(delay_s("law = 'listed'\nseconds = [0.1, 0.2]", 2.0), 0.2);
    }

    #[test]
    fn a_list_that_is_too_short_has_no_delay() {
        assert_eq!(delay_s("law = 'listed'\nseconds = [0.1]", 2.0), None);
    }

    #[test]
    fn the_longest_delay_bounds_all() {
        let law = DelayLaw::Direction { rising: 0.1, falling: 0.4 };
        assert!((law.longest_s() - 0.4).abs() < 1e-15);
    }

    #[test]
    fn a_key_of_another_law_is_refused() {
        let mixed = "law = 'constant'\nseconds = 0.1\nmax = 0.5";
        assert!(toml::from_str::<DelayLaw>(mixed).is_err());
    }
}
