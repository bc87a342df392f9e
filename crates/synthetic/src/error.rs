//! Why a plant cannot be simulated.

use std::fmt;

use super::clock::{Clock, MIN_STEPS_PER_LAG, MIN_STEPS_PER_PERIOD};

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
        key: String,
        /// The value found.
        value: String,
        /// What it may be.
        allowed: &'static str,
    },
    /// No effect has this name.
    #[error("no effect `{name}`{}; known: {known}", suggestion(*nearest))]
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
    /// The angle grew without bound.
    #[error(
        "{place}: the simulated samples do not make a trial: trial `{trial}` has a sample that is \
         not finite: number {sample}",
        trial = super::simulate::TRIAL
    )]
    NotFinite {
        /// The joint.
        place: Place,
        /// 1-based number of the first such sample.
        sample: usize,
    },
}

/// What is said of the name that is most like an unknown one.
fn suggestion(nearest: Option<&str>) -> String {
    nearest.map_or_else(String::new, |name| format!(" (did you mean `{name}`?)"))
}

/// What a number may be.
#[derive(Clone, Copy, Debug)]
pub(super) struct Allowed {
    pub(super) words: &'static str,
    fits: fn(f64, &Clock) -> bool,
}

const fn allowed(words: &'static str, fits: fn(f64, &Clock) -> bool) -> Allowed {
    Allowed { words, fits }
}

pub(super) const FINITE: Allowed = allowed("finite", |x, _| x.is_finite());
/// An end that may be left out: infinite where it is.
pub(super) const BOUND: Allowed = allowed("finite", |x, _| !x.is_nan());
pub(super) const POSITIVE: Allowed = allowed("finite, above zero", |x, _| x.is_finite() && x > 0.0);
pub(super) const NOT_NEGATIVE: Allowed =
    allowed("finite, not negative", |x, _| x.is_finite() && x >= 0.0);
pub(super) const NOT_POSITIVE: Allowed =
    allowed("finite, zero or below", |x, _| x.is_finite() && x <= 0.0);
pub(super) const NOT_ZERO: Allowed =
    allowed("finite, not zero", |x, _| x.is_finite() && x.abs() > 0.0);
/// The width of a rounded corner as a part of the largest level.
pub(super) const EDGE: Allowed = allowed("above 0, 1 or less", |x, _| x > 0.0 && x <= 1.0);
pub(super) const SHARE: Allowed = allowed("0 to 1", |x, _| (0.0..=1.0).contains(&x));
pub(super) const BELOW_ONE: Allowed = allowed("0 or more, below 1", |x, _| (0.0..1.0).contains(&x));
pub(super) const OPEN_SHARE: Allowed = allowed("above 0, below 1", |x, _| x > 0.0 && x < 1.0);
pub(super) const BETWEEN_ONES: Allowed = allowed("above -1, below 1", |x, _| x.abs() < 1.0);
pub(super) const ABOVE_MINUS_ONE: Allowed =
    allowed("finite, above -1", |x, _| x.is_finite() && x > -1.0);
pub(super) const TWO_OR_MORE: Allowed =
    allowed("finite, 2 or more", |x, _| x.is_finite() && x >= 2.0);
/// An angle that is not near a dead point.
pub(super) const MOUNT: Allowed = allowed("10 to 170 degrees", |x, _| (10.0..=170.0).contains(&x));
/// Seconds of a time constant that the time steps can follow.
pub(super) const LASTS_A_LAG: Allowed =
    allowed(LASTS, |x, clock| x.is_finite() && x >= MIN_STEPS_PER_LAG * clock.substep_s());
/// Seconds of a period that they can follow.
pub(super) const LASTS_A_PERIOD: Allowed =
    allowed(LASTS, |x, clock| x.is_finite() && x >= MIN_STEPS_PER_PERIOD * clock.substep_s());
const LASTS: &str = "finite seconds, long enough for the time steps (sample_period_s / substeps): \
                     4 or more in a time constant, 40 in a period";
pub(super) const LASTS_A_SAMPLE: Allowed =
    allowed("finite, a sample or more", |x, clock| x.is_finite() && x >= clock.period_s());
/// The part of a distance that is lost per second.
pub(super) const DRAINS: Allowed =
    allowed("0 or more, below one in a sample", |x, clock| x >= 0.0 && x * clock.period_s() < 1.0);

impl Place {
    /// The joint `name`.
    pub(super) fn joint(name: &str) -> Self {
        Self::Joint(name.to_owned())
    }

    /// An error about `key` unless its `value` fits.
    pub(super) fn require<T: fmt::Debug>(
        &self,
        key: &str,
        value: T,
        allowed: &'static str,
        fits: impl FnOnce(&T) -> bool,
    ) -> Result<(), PlantError> {
        if fits(&value) { Ok(()) } else { Err(self.refuse(key, value, allowed)) }
    }

    /// An error about the number `key` unless its `value` is allowed.
    pub(super) fn number(
        &self,
        key: &str,
        value: f64,
        allowed: &Allowed,
        clock: &Clock,
    ) -> Result<(), PlantError> {
        self.require(key, value, allowed.words, |value| (allowed.fits)(*value, clock))
    }

    /// The error that `key` has a value other than `allowed`.
    pub(super) fn refuse(
        &self,
        key: &str,
        value: impl fmt::Debug,
        allowed: &'static str,
    ) -> PlantError {
        let (place, key, value) = (self.clone(), key.to_owned(), format!("{value:?}"));
        PlantError::Value { place, key, value, allowed }
    }
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
