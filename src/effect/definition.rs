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
    /// The signal after it, as a function of signals, parameters and states.
    pub expression: String,
    /// What it remembers from moment to moment.
    pub states: Vec<OwnState>,
    /// Its parameters.
    pub parameters: Vec<OwnParameter>,
}

/// A number that a [`Definition`] remembers: a state of a discrete-time system.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct OwnState {
    /// Its name in the expressions.
    pub name: String,
    /// What it is where the signal was held for long, as a function of signals and parameters.
    pub start: String,
    /// What it is at the next moment, as a function of signals, parameters and all states as they
    /// are.
    pub next: String,
}

impl OwnState {
    /// A state that follows the signal: it is the signal itself where that was held for long.
    pub fn new(name: &str, next: &str) -> Self {
        Self { name: name.to_owned(), start: "signal".to_owned(), next: next.to_owned() }
    }
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
