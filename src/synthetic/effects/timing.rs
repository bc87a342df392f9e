//! Effects on the time at which a step of the input acts.

use serde::{Deserialize, Serialize};

use super::super::clock::Clock;
use super::super::error::{Allowed, Place, PlantError};
use super::part::Part;

/// What is added to the delay of each step. What is left out is zero.
///
/// ```text
/// small_s exp(-abs(after - before) / scale)
///   + falling_s where after < before
///   + rested_s (1 - exp(-held / rest_s))
///   + cold_s exp(-t / warming_s)
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct VariableDelay {
    /// Of a very small step, in seconds.
    pub small_s: f64,
    /// Size of step that leaves 37 % of `small_s`, in input units; 4 where left out.
    pub scale: f64,
    /// Of a step downward, in seconds.
    pub falling_s: f64,
    /// Of a step after a long hold, in seconds.
    pub rested_s: f64,
    /// Hold after which 63 % of `rested_s` is there, in seconds; 4 where left out.
    pub rest_s: f64,
    /// Of a step at the start of the record, in seconds.
    pub cold_s: f64,
    /// Time that leaves 37 % of `cold_s`, in seconds; 120 where left out.
    pub warming_s: f64,
}

/// A change of the input.
#[derive(Clone, Copy, Debug)]
pub(in super::super) struct Change {
    /// Level after less level before, in input units.
    pub(in super::super) rise: f64,
    /// Seconds that the level before was held.
    pub(in super::super) held_s: f64,
    /// Seconds since the first sample.
    pub(in super::super) time_s: f64,
}

impl Default for VariableDelay {
    fn default() -> Self {
        let (scale, rest_s, warming_s) = (4.0, 4.0, 120.0);
        Self { small_s: 0.0, scale, falling_s: 0.0, rested_s: 0.0, rest_s, cold_s: 0.0, warming_s }
    }
}

impl VariableDelay {
    /// Seconds that are added for one change.
    pub(in super::super) fn extra_s(&self, change: &Change) -> f64 {
        let small = self.small_s * (-change.rise.abs() / self.scale).exp();
        let falling = if change.rise < 0.0 { self.falling_s } else { 0.0 };
        let rested = -self.rested_s * (-change.held_s / self.rest_s).exp_m1();
        small + falling + rested + self.cold_s * (-change.time_s / self.warming_s).exp()
    }

    /// Seconds that no change exceeds.
    pub(in super::super) fn longest_s(&self) -> f64 {
        self.small_s + self.falling_s + self.rested_s + self.cold_s
    }
}

impl Part for VariableDelay {
    fn check(&self, place: &Place, _clock: &Clock) -> Result<(), PlantError> {
        for (key, seconds) in [
            ("effect.variable_delay.small_s", self.small_s),
            ("effect.variable_delay.falling_s", self.falling_s),
            ("effect.variable_delay.rested_s", self.rested_s),
            ("effect.variable_delay.cold_s", self.cold_s),
        ] {
            place.number(key, seconds, Allowed::NotNegative)?;
        }
        place.number("effect.variable_delay.scale", self.scale, Allowed::Positive)?;
        place.number("effect.variable_delay.rest_s", self.rest_s, Allowed::Positive)?;
        place.number("effect.variable_delay.warming_s", self.warming_s, Allowed::Positive)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_term_is_there_when_it_should_be() {
        let law = VariableDelay {
            small_s: 0.1,
            falling_s: 0.2,
            rested_s: 0.4,
            cold_s: 0.8,
            ..VariableDelay::default()
        };
        let change = Change { rise: -4.0, held_s: 4.0, time_s: 120.0 };
        let left = (-1.0_f64).exp();
        let expected = 0.1 * left + 0.2 + 0.4 * (1.0 - left) + 0.8 * left;
        assert!((law.extra_s(&change) - expected).abs() < 1e-12);
        assert!(law.extra_s(&Change { rise: 4.0, ..change }) < expected - 0.19);
        assert!(law.longest_s() >= expected);
    }
}
