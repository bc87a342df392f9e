//! What the experimenter wants to drive a joint with.

use serde::{Deserialize, Serialize};

use crate::clock::Clock;
use crate::error::{FINITE, Place, PlantError};

/// The input of a joint: voltage steps, drawn or given.
///
/// ```toml
/// input = { levels = [-1, 0, 1], hold_s = [0.9, 2.0] }
/// input = { steps = [[40, 1], [89, -1]], initial = 0 }
/// ```
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "RawInput", untagged)]
#[non_exhaustive]
pub enum InputSpec {
    /// Random levels, held for random times. The record starts at level 0.
    Levels {
        /// Levels to draw from, in input units; never the same twice running.
        /// One that is listed twice is drawn twice as often.
        levels: Vec<f64>,
        /// Shortest and longest hold in seconds, the first one included. All
        /// times between are alike; a hold is rounded to whole samples.
        hold_s: [f64; 2],
    },
    /// Steps that are given.
    Steps {
        /// 1-based sample that first shows the level, and the level in input units.
        steps: Vec<(usize, f64)>,
        /// Level before the first step, in input units; 0 where a file leaves it out.
        initial: f64,
    },
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct RawInput {
    levels: Option<Vec<f64>>,
    hold_s: Option<[f64; 2]>,
    steps: Option<Vec<(usize, f64)>>,
    initial: Option<f64>,
}

impl TryFrom<RawInput> for InputSpec {
    type Error = &'static str;

    fn try_from(raw: RawInput) -> Result<Self, Self::Error> {
        match (raw.levels, raw.hold_s, raw.steps, raw.initial) {
            (Some(levels), Some(hold_s), None, None) => Ok(Self::Levels { levels, hold_s }),
            (None, None, Some(steps), initial) => {
                Ok(Self::Steps { steps, initial: initial.unwrap_or(0.0) })
            }
            _ => Err("`input` holds `levels` and `hold_s`, or `steps` and perhaps `initial`"),
        }
    }
}

impl InputSpec {
    /// The level that the record starts at, in input units.
    pub(crate) fn initial(&self) -> f64 {
        match self {
            Self::Levels { .. } => 0.0,
            Self::Steps { initial, .. } => *initial,
        }
    }

    /// The largest magnitude of a level, in input units.
    pub(crate) fn largest(&self) -> f64 {
        let larger = |largest: f64, level: f64| largest.max(level.abs());
        match self {
            Self::Levels { levels, .. } => levels.iter().copied().fold(0.0, larger),
            Self::Steps { steps, initial } => {
                steps.iter().map(|(_, level)| *level).fold(initial.abs(), larger)
            }
        }
    }

    /// Seconds from one step to the next, on average.
    pub(crate) fn mean_hold_s(&self, clock: &Clock) -> f64 {
        match self {
            Self::Levels { hold_s: [shortest, longest], .. } => f64::midpoint(*shortest, *longest),
            Self::Steps { steps, .. } => clock.time_s(clock.samples) / steps.len() as f64,
        }
    }

    /// Steps in the record, on average.
    pub(crate) fn steps_in(&self, clock: &Clock) -> f64 {
        // A hold is a sample at least.
        let samples = clock.samples_in(self.mean_hold_s(clock)).max(1);
        clock.samples as f64 / samples as f64
    }

    /// Refuses what cannot be drawn or does not fit the record.
    pub(crate) fn check(&self, clock: &Clock, place: &Place) -> Result<(), PlantError> {
        match self {
            Self::Levels { levels, hold_s } => {
                for level in levels {
                    place.number("input.levels", *level, FINITE, clock)?;
                }
                let mut pairs = levels.windows(2);
                let several = pairs.any(|pair| matches!(pair, &[a, b] if differ(a, b)));
                let [shortest, longest] = *hold_s;
                let holds = shortest > 0.0 && shortest <= longest && longest.is_finite();
                let allowed = "[shortest, longest] in seconds, finite and above zero";
                place.require(&[
                    ("input.levels", levels, several, "two levels or more that differ"),
                    ("input.hold_s", hold_s, holds, allowed),
                ])
            }
            Self::Steps { steps, initial } => {
                place.number("input.initial", *initial, FINITE, clock)?;
                check_steps(steps, *initial, clock, place)
            }
        }
    }
}

/// Whether two levels differ. A negative zero is zero.
pub(crate) fn differ(a: f64, b: f64) -> bool {
    (a - b).abs() > 0.0
}

fn check_steps(
    steps: &[(usize, f64)],
    initial: f64,
    clock: &Clock,
    place: &Place,
) -> Result<(), PlantError> {
    let (mut sample_before, mut level_before) = (1, initial);
    for step in steps {
        let (sample, level) = *step;
        let rises = sample > sample_before && sample <= clock.samples;
        let samples = "samples that rise, the first from 2, the last within the record";
        let changes = level.is_finite() && differ(level, level_before);
        let levels = "finite levels, each other than the one before";
        let key = "input.steps";
        place.require(&[(key, step, rises, samples), (key, step, changes, levels)])?;
        (sample_before, level_before) = (sample, level);
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn reads_both_forms() {
        let drawn = toml::from_str("levels = [-1, 0.5]\nhold_s = [1, 2]").unwrap();
        assert_eq!(InputSpec::Levels { levels: vec![-1.0, 0.5], hold_s: [1.0, 2.0] }, drawn);
        let given = toml::from_str("steps = [[40, 1], [89, -1.5]]").unwrap();
        let steps = vec![(40, 1.0), (89, -1.5)];
        assert_eq!(InputSpec::Steps { steps, initial: 0.0 }, given);
    }

    #[test]
    fn a_mixture_of_both_forms_is_refused() {
        for text in ["levels = [1, 2]", "hold_s = [1, 2]\nsteps = [[2, 1]]", "", "initial = 1"] {
            assert!(toml::from_str::<InputSpec>(text).is_err(), "{text}");
        }
    }
}
