//! Why a plant cannot be simulated.

use std::fmt;

use crate::experiment::{TrialError, did_you_mean};

/// Which part of a plant file is meant.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Place {
    /// The plant as a whole.
    Plant,
    /// The joint of this name.
    Joint(String),
}

/// Why a plant cannot be read or simulated.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum PlantError {
    /// The text is not the TOML that is expected.
    #[error("not a plant file")]
    Parse {
        /// Line, column and cause.
        source: Box<toml::de::Error>,
    },
    /// A number, such as a very large seed, has no place in TOML.
    #[error("the plant cannot be written")]
    Write {
        /// Which, and why.
        source: Box<toml::ser::Error>,
    },
    /// The file follows another schema.
    #[error("the schema is `{found}`, not `{expected}`", expected = super::schema::SCHEMA)]
    Schema {
        /// The schema it names.
        found: String,
    },
    /// A key has a value that is not allowed.
    #[error("{place}: `{key}` is {value}; allowed: {allowed}")]
    Value {
        /// What the key belongs to.
        place: Place,
        /// The key, with that of its table before a dot.
        key: &'static str,
        /// The value found.
        value: String,
        /// What it may be.
        allowed: &'static str,
    },
    /// No effect has this name.
    #[error("no effect `{name}`{}; known: {known}", did_you_mean(*nearest))]
    Unknown {
        /// The name.
        name: String,
        /// The name that is most like it.
        nearest: Option<&'static str>,
        /// All names.
        known: String,
    },
    /// An effect is there twice.
    #[error("the effect `{name}` is named twice")]
    Twice {
        /// Its name.
        name: &'static str,
    },
    /// The numbers given for an effect are not those it has.
    #[error("effect `{name}`: {}", cause.message())]
    Numbers {
        /// The effect.
        name: &'static str,
        /// Which number is missing or too much.
        cause: Box<toml::de::Error>,
    },
    /// The law `listed` has too few delays for an input that is drawn, or another
    /// number than the steps that are given.
    #[error("{place}: `delay.seconds` lists {given} delays; needed for the steps: {needed}")]
    ListedDelays {
        /// The joint.
        place: Place,
        /// Delays in the list.
        given: usize,
        /// Delays needed; for an input that is drawn, up to the step without one.
        needed: usize,
    },
    /// No level keeps the joint in its range.
    #[error(
        "{place}: no level keeps it in `range` from sample {sample} on; widen the range, \
         shorten `input.hold_s` or add smaller levels"
    )]
    Range {
        /// The joint.
        place: Place,
        /// 1-based number of the sample of the step.
        sample: usize,
    },
    /// The equations of a cylinder ran away.
    #[error(
        "{place}: its pressures or its angle grow beyond all measure at {time_s} s; make \
         `cylinder.time_step_s` smaller, or the load in keeping with the cylinder"
    )]
    Runaway {
        /// The joint.
        place: Place,
        /// When it was found, in seconds.
        time_s: f64,
    },
    /// The simulated samples do not make a trial: the angle grew without bound.
    #[error("{place}: the simulated samples do not make a trial")]
    Trial {
        /// The joint.
        place: Place,
        /// What is wrong with them.
        source: TrialError,
    },
}

/// What a number may be.
#[derive(Clone, Copy, Debug)]
pub(super) enum Allowed {
    /// Any finite number.
    Finite,
    /// Finite, above zero.
    Positive,
    /// Finite, zero or above.
    NotNegative,
    /// Finite, zero or below.
    NotPositive,
    /// From 0 to 1.
    Share,
    /// From 0, below 1.
    BelowOne,
}

impl Allowed {
    fn words(self) -> &'static str {
        match self {
            Self::Finite => "finite",
            Self::Positive => "finite, above zero",
            Self::NotNegative => "finite, not negative",
            Self::NotPositive => "finite, zero or below",
            Self::Share => "0 to 1",
            Self::BelowOne => "0 or more, below 1",
        }
    }

    fn fits(self, value: f64) -> bool {
        match self {
            Self::Finite => value.is_finite(),
            Self::Positive => value.is_finite() && value > 0.0,
            Self::NotNegative => value.is_finite() && value >= 0.0,
            Self::NotPositive => value.is_finite() && value <= 0.0,
            Self::Share => (0.0..=1.0).contains(&value),
            Self::BelowOne => (0.0..1.0).contains(&value),
        }
    }
}

impl Place {
    /// The joint `name`.
    pub(super) fn joint(name: &str) -> Self {
        Self::Joint(name.to_owned())
    }

    /// An error about `key` unless its `value` fits.
    pub(super) fn require<T: fmt::Debug>(
        &self,
        key: &'static str,
        value: T,
        allowed: &'static str,
        fits: impl FnOnce(&T) -> bool,
    ) -> Result<(), PlantError> {
        if fits(&value) { Ok(()) } else { Err(self.refuse(key, value, allowed)) }
    }

    /// An error about the number `key` unless its `value` is allowed.
    pub(super) fn number(
        &self,
        key: &'static str,
        value: f64,
        allowed: Allowed,
    ) -> Result<(), PlantError> {
        self.require(key, value, allowed.words(), |value| allowed.fits(*value))
    }

    /// An error unless `range` is finite and in order.
    pub(super) fn range(
        &self,
        [from, to]: [&'static str; 2],
        range: [f64; 2],
    ) -> Result<(), PlantError> {
        self.number(from, range[0], Allowed::Finite)?;
        let allowed = "finite, above the lower end";
        self.require(to, range[1], allowed, |to| to.is_finite() && *to > range[0])
    }

    /// The error that `key` has a value other than `allowed`.
    pub(super) fn refuse(
        &self,
        key: &'static str,
        value: impl fmt::Debug,
        allowed: &'static str,
    ) -> PlantError {
        let (place, value) = (self.clone(), format!("{value:?}"));
        PlantError::Value { place, key, value, allowed }
    }
}

/// Refuses a value that is there but not finite and above zero.
pub(super) fn above_zero(
    place: &Place,
    key: &'static str,
    value: Option<f64>,
) -> Result<(), PlantError> {
    let Some(value) = value else { return Ok(()) };
    place.require(key, value, "finite, above zero", |value| value.is_finite() && *value > 0.0)
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Plant => f.write_str("plant"),
            Self::Joint(name) => write!(f, "joint `{name}`"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_bad_value_is_told_with_joint_key_value_and_what_is_allowed() {
        let refused = Place::joint("elbow").require("gain", 0.0, "finite, not zero", |_| false);
        let text = refused.unwrap_err().to_string();
        assert_eq!(text, "joint `elbow`: `gain` is 0.0; allowed: finite, not zero");
    }
}
