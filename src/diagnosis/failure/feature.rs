//! What the error is held against.

use std::fmt;

use serde::Serialize;

use super::record::{Samples, Units};

/// Something that is known of every sample. Of conditions that say the same, the one of the feature
/// that is first here is kept.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Feature {
    /// Sign of the input.
    Direction,
    /// Magnitude of the input.
    AbsInput,
    /// The input as it acts.
    Input,
    /// The output.
    Output,
    /// Magnitude of the speed.
    AbsSpeed,
    /// Speed of the output.
    Speed,
    /// Time since the step that acts.
    SinceStep,
    /// How long its level is held.
    Hold,
    /// Time in the record.
    Time,
    /// The trial.
    Trial,
}

/// All features in their order, with their names in files and in conditions.
const NAMED: [(Feature, &str, &str); 10] = [
    (Feature::Direction, "direction", "input"),
    (Feature::AbsInput, "abs_input", "|input|"),
    (Feature::Input, "input", "input"),
    (Feature::Output, "output", "output"),
    (Feature::AbsSpeed, "abs_speed", "|speed|"),
    (Feature::Speed, "speed", "speed"),
    (Feature::SinceStep, "since_step", "time since step"),
    (Feature::Hold, "hold", "hold"),
    (Feature::Time, "time", "time"),
    (Feature::Trial, "trial", "trial"),
];

impl Feature {
    /// All features in their order.
    pub fn all() -> impl Iterator<Item = Self> {
        NAMED.iter().map(|(feature, ..)| *feature)
    }

    /// Its name in files.
    pub fn id(self) -> &'static str {
        NAMED[self as usize].1
    }

    /// Its name in a condition.
    pub fn name(self) -> &'static str {
        NAMED[self as usize].2
    }

    /// Its name for people, who see the record on clocks of other beginnings.
    pub(super) fn in_words(self) -> &'static str {
        match self {
            Self::Time => "time in the trial",
            Self::Hold => "length of the hold",
            _ => self.name(),
        }
    }

    /// Its unit, where there is one.
    pub fn unit(self, units: &Units) -> Option<String> {
        match self {
            Self::Direction | Self::Trial => None,
            Self::Input | Self::AbsInput => units.input.clone(),
            Self::Output => units.output.clone(),
            Self::AbsSpeed | Self::Speed => units.output.as_ref().map(|unit| format!("{unit}/s")),
            Self::SinceStep | Self::Hold | Self::Time => Some("s".to_owned()),
        }
    }

    /// Its value at a sample; NaN where it is not known.
    pub(super) fn value(self, samples: &Samples, row: usize) -> Option<f64> {
        let of = |values: &[f64]| values.get(row).copied();
        match self {
            Self::Direction => of(&samples.input).map(sign),
            Self::Input => of(&samples.input),
            Self::AbsInput => of(&samples.input).map(f64::abs),
            Self::Output => of(&samples.output),
            Self::AbsSpeed => of(&samples.speed).map(f64::abs),
            Self::Speed => of(&samples.speed),
            Self::SinceStep => of(&samples.since_step_s),
            Self::Hold => of(&samples.hold_s),
            Self::Time => of(&samples.time_s),
            Self::Trial => samples.trial.get(row).copied().map(f64::from),
        }
    }

    /// Its value at every sample, likewise.
    pub(super) fn values(self, samples: &Samples) -> impl Iterator<Item = f64> + '_ {
        (0..samples.residual.len()).filter_map(move |row| self.value(samples, row))
    }

    /// Whether its values are kinds, without more or less.
    pub(super) fn has_kinds(self) -> bool {
        matches!(self, Self::Direction | Self::Trial)
    }
}

/// -1, 0, 1, or NaN where the value is not known.
fn sign(value: f64) -> f64 {
    if value == 0.0 { 0.0 } else { value.signum() }
}

impl fmt::Display for Feature {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}
