//! Why a model file cannot be used.

use std::path::PathBuf;

use super::schema::SCHEMA;
use crate::effect::expression::DefinitionError;
use crate::effect::{UNLIMITED, UnknownEffect};

/// Why a model file cannot be used.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ModelError {
    /// It cannot be opened or read.
    #[error("{}: cannot be read", path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// What the system said.
        source: std::io::Error,
    },
    /// It is not TOML, or has a key that is not known.
    #[error("{}: not a model file", path.display())]
    Parse {
        /// The file.
        path: PathBuf,
        /// Line, column and cause.
        source: Box<toml::de::Error>,
    },
    /// It is of another schema.
    #[error("{}: schema `{found}` is not known; expected `{SCHEMA}`", path.display())]
    Schema {
        /// The file.
        path: PathBuf,
        /// What it says.
        found: String,
    },
    /// A joint has a structure that is not known.
    #[error(
        "{}, joint `{joint}`: structure `{found}` is not known; expected `integrator`",
        path.display()
    )]
    Structure {
        /// The file.
        path: PathBuf,
        /// The joint.
        joint: String,
        /// What it says.
        found: String,
    },
    /// An effect is not in the catalogue.
    #[error("{}, joint `{joint}`: `tauscope effects` lists the catalogue", path.display())]
    UnknownEffect {
        /// The file.
        path: PathBuf,
        /// The joint.
        joint: String,
        /// Its name, and the nearest one.
        source: UnknownEffect,
    },
    /// A parameter does not belong to its effect.
    #[error(
        "{}, joint `{joint}`: `{owner}` has no parameter `{name}`; it has {known}", path.display()
    )]
    UnknownParameter {
        /// The file.
        path: PathBuf,
        /// The joint.
        joint: String,
        /// The effect, or the structure.
        owner: String,
        /// What it says.
        name: String,
        /// The parameters there are.
        known: String,
    },
    /// A joint has more effects, or longer expressions, than any model.
    #[error("{}, {place}: {problem}", path.display())]
    TooLarge {
        /// The file.
        path: PathBuf,
        /// The joint, or the candidates.
        place: String,
        /// What there is too much of, and the most.
        problem: String,
    },
    /// A parameter of the structure is missing.
    #[error("{}, joint `{joint}`: parameter `{name}` is missing", path.display())]
    MissingParameter {
        /// The file.
        path: PathBuf,
        /// The joint.
        joint: String,
        /// The parameter.
        name: &'static str,
    },
    /// A value is not finite, or lies outside its bounds.
    #[error(
        "{}, joint `{joint}`: `{owner}.{name}` = {} is not {}",
        path.display(), plain(*value), allowed(*value, (*min, *max))
    )]
    OutOfBounds {
        /// The file.
        path: PathBuf,
        /// The joint.
        joint: String,
        /// The effect, or the structure.
        owner: String,
        /// The parameter.
        name: String,
        /// What it says.
        value: f64,
        /// Lowest value.
        min: f64,
        /// Highest value.
        max: f64,
    },
    /// An effect of the file's own has keys that do not go together.
    #[error("{}, {place}: effect `{effect}` {problem}", path.display())]
    Effect {
        /// The file.
        path: PathBuf,
        /// The joint, or the word for a candidate.
        place: String,
        /// Its id, or its kind where it has none.
        effect: String,
        /// What is wrong, and what to do.
        problem: String,
    },
    /// An effect of the file's own cannot be used.
    #[error("{}, {place}: effect `{effect}`", path.display())]
    Definition {
        /// The file.
        path: PathBuf,
        /// The joint, or the word for a candidate.
        place: String,
        /// Its id.
        effect: String,
        /// What is wrong with it.
        source: Box<DefinitionError>,
    },
    /// It cannot be edited.
    #[error("{}: cannot be revised", path.display())]
    Edit {
        /// The file.
        path: PathBuf,
        /// Line, column and cause.
        source: Box<toml_edit::TomlError>,
    },
    /// A joint stands in it in a way that cannot be edited.
    #[error(
        "{}, joint `{joint}`: cannot be revised as it is written; write it as `[joint.{joint}]`",
        path.display()
    )]
    Form {
        /// The file.
        path: PathBuf,
        /// The joint.
        joint: String,
    },
}

/// What a value may be.
fn allowed(value: f64, (min, max): (f64, f64)) -> String {
    if value.abs() > UNLIMITED && value.is_finite() {
        return format!("between -{UNLIMITED:e} and {UNLIMITED:e}");
    }
    match (min > -UNLIMITED, max < UNLIMITED) {
        (true, true) => format!("between {} and {}", plain(min), plain(max)),
        (true, false) => format!("{} or more", plain(min)),
        (false, true) => format!("{} or less", plain(max)),
        (false, false) => "a finite number".to_owned(),
    }
}

/// A number without rows of zeros.
fn plain(value: f64) -> String {
    if value.abs() < UNLIMITED { value.to_string() } else { format!("{value:e}") }
}
