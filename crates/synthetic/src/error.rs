//! Why a plant cannot be simulated, and what its numbers may be.

use std::fmt;

use crate::clock::{Clock, MIN_STEPS_PER_LAG, MIN_STEPS_PER_PERIOD};

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
    #[error("the schema is `{found}`, not `{expected}`", expected = crate::SCHEMA)]
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
        trial = crate::TRIAL
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

/// What a number may be: in words, and whether it is.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Rule(pub(crate) &'static str, fn(f64, &Clock) -> bool);

pub(crate) const FINITE: Rule = Rule("finite", |x, _| x.is_finite());
/// An end that may be left out: infinite where it is.
pub(crate) const BOUND: Rule = Rule("finite", |x, _| !x.is_nan());
pub(crate) const POSITIVE: Rule = Rule("finite, above zero", |x, _| x.is_finite() && x > 0.0);
pub(crate) const NOT_NEGATIVE: Rule =
    Rule("finite, not negative", |x, _| x.is_finite() && x >= 0.0);
pub(crate) const NOT_POSITIVE: Rule =
    Rule("finite, zero or below", |x, _| x.is_finite() && x <= 0.0);
pub(crate) const NOT_ZERO: Rule = Rule("finite, not zero", |x, _| x.is_finite() && x.abs() > 0.0);
/// The width of a rounded corner as a part of the largest level.
pub(crate) const EDGE: Rule = Rule("above 0, 1 or less", |x, _| x > 0.0 && x <= 1.0);
pub(crate) const SHARE: Rule = Rule("0 to 1", |x, _| (0.0..=1.0).contains(&x));
pub(crate) const BELOW_ONE: Rule = Rule("0 or more, below 1", |x, _| (0.0..1.0).contains(&x));
pub(crate) const OPEN_SHARE: Rule = Rule("above 0, below 1", |x, _| x > 0.0 && x < 1.0);
pub(crate) const BETWEEN_ONES: Rule = Rule("above -1, below 1", |x, _| x.abs() < 1.0);
pub(crate) const ABOVE_MINUS_ONE: Rule = Rule("finite, above -1", |x, _| x.is_finite() && x > -1.0);
pub(crate) const TWO_OR_MORE: Rule = Rule("finite, 2 or more", |x, _| x.is_finite() && x >= 2.0);
/// An angle that is not near a dead point.
pub(crate) const MOUNT: Rule = Rule("10 to 170 degrees", |x, _| (10.0..=170.0).contains(&x));
/// Seconds of a time constant that the time steps can follow.
pub(crate) const LASTS_A_LAG: Rule =
    Rule(LASTS, |x, clock| x.is_finite() && x >= MIN_STEPS_PER_LAG * clock.substep_s());
/// Seconds of a period that they can follow.
pub(crate) const LASTS_A_PERIOD: Rule =
    Rule(LASTS, |x, clock| x.is_finite() && x >= MIN_STEPS_PER_PERIOD * clock.substep_s());
const LASTS: &str = "finite seconds, long enough for the time steps (sample_period_s / substeps): \
                     4 or more in a time constant, 40 in a period";
pub(crate) const LASTS_A_SAMPLE: Rule =
    Rule("finite, a sample or more", |x, clock| x.is_finite() && x >= clock.period_s);
/// The part of a distance that is lost per second.
pub(crate) const DRAINS: Rule =
    Rule("0 or more, below one in a sample", |x, clock| x >= 0.0 && x * clock.period_s < 1.0);

/// A key, its value, whether that is allowed, and what is.
pub(crate) type Condition<'a> = (&'a str, &'a dyn fmt::Debug, bool, &'static str);

impl Place {
    /// The joint `name`.
    pub(crate) fn joint(name: &str) -> Self {
        Self::Joint(name.to_owned())
    }

    /// An error about the first of `conditions` that does not hold.
    pub(crate) fn require(&self, conditions: &[Condition<'_>]) -> Result<(), PlantError> {
        let wrong = conditions.iter().find(|(_, _, holds, _)| !holds);
        wrong.map_or(Ok(()), |(key, value, _, allowed)| Err(self.refuse(key, value, allowed)))
    }

    /// An error about the number `key` unless its `value` follows the rule.
    pub(crate) fn number(
        &self,
        key: &str,
        value: f64,
        Rule(allowed, fits): Rule,
        clock: &Clock,
    ) -> Result<(), PlantError> {
        self.require(&[(key, &value, fits(value, clock), allowed)])
    }

    /// The error that `key` has a value other than `allowed`.
    pub(crate) fn refuse(
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
        let refused = Place::joint("elbow").require(&[("gain", &0.0, false, "finite, not zero")]);
        let text = refused.unwrap_err().to_string();
        assert_eq!(text, "joint `elbow`: `gain` is 0.0; allowed: finite, not zero");
    }
}
