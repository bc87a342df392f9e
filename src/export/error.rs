//! Why a model cannot leave the program.

use crate::effect::expression::SyntaxError;

/// Why a model cannot leave the program.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum ExportError {
    /// An effect does not say what it does as equations.
    #[error("effect `{effect}` cannot be exported: it has no equations")]
    NoEquations {
        /// Id of the effect.
        effect: &'static str,
    },
    /// An effect takes delays from a log.
    #[error(
        "effect `{effect}` cannot be exported: it takes the delay of each step from a log, which \
         an exported model does not have"
    )]
    MeasuredDelays {
        /// Id of the effect.
        effect: &'static str,
    },
    /// The equations of an effect are not in the notation of expressions.
    #[error("effect `{effect}` cannot be exported: its equations cannot be read")]
    Equations {
        /// Id of the effect.
        effect: &'static str,
        /// What is wrong with them.
        source: SyntaxError,
    },
    /// The last equation of an effect does not give its result.
    #[error("effect `{effect}` cannot be exported: its last equation does not give `out`")]
    NoResult {
        /// Id of the effect.
        effect: &'static str,
    },
    /// A file's name is not a name in its language.
    #[error("`{name}` is not a name in {language}: letters, digits and `_`, a letter first")]
    Name {
        /// The name, without its ending.
        name: String,
        /// The language.
        language: &'static str,
    },
    /// The archive of an FMU cannot be made.
    #[error("the archive cannot be made: {problem}")]
    Archive {
        /// What its writer says.
        problem: String,
    },
    /// The template of a language cannot be filled in.
    #[error("the template cannot be filled in: {problem}")]
    Template {
        /// What is wrong with it.
        problem: String,
    },
}
