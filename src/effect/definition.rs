//! What a user writes down of an effect of their own.

use super::{Dimension, Stage};

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
}
