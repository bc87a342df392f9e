//! What a user writes down of an effect of their own.

use super::SyntaxError;
use crate::effect::{Dimension, Parameter, Stage, UNLIMITED};

/// An effect as a user defines it.
#[derive(Clone, Debug, PartialEq)]
pub struct Definition {
    /// Its name, in snake case, not one of the catalogue's.
    pub id: String,
    /// What it is, in one sentence without a full stop.
    pub summary: Option<String>,
    /// Where it acts.
    pub stage: Stage,
    /// The signal behind it, as a function of signals and parameters.
    pub expression: String,
    /// Its parameters.
    pub parameters: Vec<OwnParameter>,
}

/// A parameter of a [`Definition`].
#[derive(Clone, Debug, PartialEq)]
pub struct OwnParameter {
    /// Its name in the expression.
    pub name: String,
    /// Where a fit starts; away from the neutral value where none is given.
    pub start: Option<f64>,
    /// Lowest value of a fit.
    pub min: Option<f64>,
    /// Highest value of a fit.
    pub max: Option<f64>,
    /// The value at which, with the others at theirs, the effect changes nothing; 0 where
    /// none is given. It may lie outside `min` and `max`.
    pub neutral: Option<f64>,
    /// Whether a fit leaves it at its start.
    pub fixed: bool,
    /// Its unit.
    pub dimension: Dimension,
}

impl OwnParameter {
    /// A free parameter without limits, neutral at zero.
    pub fn new(name: &str, start: f64) -> Self {
        let (min, max, neutral) = (None, None, None);
        let (start, dimension) = (Some(start), Dimension::One);
        Self { name: name.to_owned(), start, min, max, neutral, fixed: false, dimension }
    }

    /// Lowest and highest value of a fit.
    pub(super) fn bounds(&self) -> (f64, f64) {
        (self.min.unwrap_or(-UNLIMITED), self.max.unwrap_or(UNLIMITED))
    }

    /// The same as every effect has it: its range holds the neutral value, too.
    pub(super) fn specified(&self) -> Parameter {
        let neutral = self.neutral.unwrap_or_default();
        let (min, max) = self.bounds();
        Parameter {
            neutral,
            min: min.min(neutral),
            max: max.max(neutral),
            fitted: !self.fixed,
            ..Parameter::new(leaked(&self.name), "a number in the expression", self.dimension)
        }
    }

    /// What is wrong with its numbers.
    pub(super) fn fault(&self) -> Option<DefinitionError> {
        let (min, max) = self.bounds();
        let neutral = self.neutral.unwrap_or_default();
        let is_finite = [min, max, neutral].iter().all(|number| number.is_finite());
        let value = self.start.unwrap_or(min);
        let holds = is_finite && min <= max && (min..=max).contains(&value);
        let parameter = self.name.clone();
        (!holds).then_some(DefinitionError::Range { parameter, value, min, max, neutral })
    }
}

/// A text that lives as long as the program.
pub(super) fn leaked(text: &str) -> &'static str {
    Box::leak(text.to_owned().into_boxed_str())
}

/// Why an effect of a user's own cannot be used.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum DefinitionError {
    /// A name is not in snake case.
    #[error("`{name}` is not in snake case: small letters, digits and `_`, a letter first")]
    Name {
        /// The id, or the name of a parameter.
        name: String,
    },
    /// The id is one of the catalogue's, or has a meaning of its own in a model file.
    #[error("`{id}` is taken; give the effect an id of its own")]
    TakenId {
        /// The id.
        id: String,
    },
    /// A parameter has the name of a signal, a function or a constant, or of another
    /// parameter.
    #[error("parameter `{parameter}` has a name that is taken: rename it")]
    TakenName {
        /// The parameter.
        parameter: String,
    },
    /// Numbers of a parameter do not go together.
    #[error(
        "parameter `{parameter}`: {min} <= {value} <= {max}, neutral at {neutral}, does not hold \
         with finite numbers"
    )]
    Range {
        /// The parameter.
        parameter: String,
        /// Its start value.
        value: f64,
        /// Its lowest value.
        min: f64,
        /// Its highest value.
        max: f64,
        /// Its neutral value.
        neutral: f64,
    },
    /// The expression cannot be computed.
    #[error("the expression cannot be computed")]
    Syntax(#[from] SyntaxError),
    /// The expression does not depend on a parameter.
    #[error("parameter `{parameter}` is not in the expression: use it, or take it out")]
    Unused {
        /// The parameter.
        parameter: String,
    },
    /// The neutral values that are given are not neutral.
    #[error(
        "at its neutral values the effect makes {found} of {signal}, and must leave it as it is; \
         correct `neutral`, or leave it out of all parameters if there is no such point"
    )]
    NotNeutral {
        /// The signal in front of it.
        signal: f64,
        /// The signal behind it.
        found: f64,
    },
}
