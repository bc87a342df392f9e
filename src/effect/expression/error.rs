//! Why an effect of a user's own cannot be used.

use super::grammar::SyntaxError;

/// Why an effect of a user's own cannot be used.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum DefinitionError {
    /// A name is not in snake case, is taken, or is in no expression.
    #[error("`{name}` {problem}")]
    Name {
        /// The id, or the name of a parameter or a state.
        name: String,
        /// What is wrong with it, and what to do.
        problem: &'static str,
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
    /// An effect on the delay has states.
    #[error(
        "an effect of stage `transport` has no states: it is evaluated once at each step of the \
         input"
    )]
    States,
    /// It has too many states.
    #[error("{states} states; {most} are the most")]
    TooManyStates {
        /// How many it has.
        states: usize,
        /// How many it may have.
        most: usize,
    },
    /// The neutral values that are given are not neutral.
    #[error(
        "at its neutral values the effect changes {signal} to {found}, but must not change it; \
         correct `neutral`, or leave it out of all parameters if there is no neutral point"
    )]
    NotNeutral {
        /// The signal in front of it.
        signal: f64,
        /// The signal after it.
        found: f64,
    },
}
