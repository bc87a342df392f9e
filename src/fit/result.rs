//! What comes of a fit, and why there is none.

use std::fmt;
use std::ops::Deref;
use std::sync::Arc;

use serde::Serialize;

use super::evaluation::Evaluation;
use crate::effect::UNLIMITED;
use crate::model::JointModel;

/// A model, fitted or as it was given, with how sure its parameters are.
#[derive(Clone, Debug)]
pub struct AssessedModel {
    /// The model.
    pub model: JointModel,
    /// Its parameters, in the order of [`JointModel::values`].
    pub parameters: Vec<Parameter>,
}

/// A model on a record, with how sure its parameters are.
#[derive(Clone, Debug)]
pub struct Assessment {
    /// The model and its parameters.
    pub assessed: AssessedModel,
    /// The model on the record. Copies of the assessment share it, as it is long.
    pub evaluation: Arc<Evaluation>,
}

impl Deref for Assessment {
    type Target = AssessedModel;

    fn deref(&self) -> &AssessedModel {
        &self.assessed
    }
}

/// A fitted model: its assessment at the fitted values, and how the fit went.
#[derive(Clone, Debug)]
pub struct Fit {
    /// The model at the fitted values.
    pub assessment: Assessment,
    /// The sum of squared errors of the training windows that was minimised, without isolated spikes
    /// of the sensor.
    pub cost: f64,
    /// Why it stopped.
    pub termination: Termination,
}

impl Deref for Fit {
    type Target = Assessment;

    fn deref(&self) -> &Assessment {
        &self.assessment
    }
}

/// A parameter of a fitted model.
#[derive(Clone, Debug, PartialEq)]
pub struct Parameter {
    /// `gain`, or `dead_band.lower`.
    pub name: String,
    /// Its value.
    pub value: f64,
    /// Its standard error, where the data determine it.
    pub std_error: Option<f64>,
    /// What the fit could do with it.
    pub status: Status,
}

/// What a fit could do with a parameter.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Status {
    /// It was fitted.
    Fitted,
    /// It was not to be changed.
    Fixed,
    /// It came to lie on a bound: its standard error says little.
    AtBound,
    /// The data do not determine it: the error is the same over a wide range.
    Undetermined,
    /// It lies beyond what the record reaches: a level above all of the input, or a limit of the
    /// output where it never comes. The data do not determine it.
    #[serde(rename = "undetermined")]
    BeyondReach,
}

/// Why a fit stopped.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Termination {
    /// The gradient of the sum of squared errors is small: a linear step could not make it less
    /// by more than a hundredth of what a standard error does.
    Converged,
    /// No step made the error less, or by next to nothing, though its gradient is not small: a
    /// corner or a jump.
    NoDescent,
    /// There was nothing to fit.
    NothingToFit,
    /// It took too many simulations; the parameters may not be the best.
    OutOfPatience,
    /// The simulation gave no numbers any more.
    Numerical,
}

impl fmt::Display for Termination {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Converged => "converged",
            Self::NoDescent => {
                "stopped: no step lowers the error, which is not smooth there; other initial values may give a smaller error"
            }
            Self::NothingToFit => "nothing to fit",
            Self::OutOfPatience => "stopped after too many simulations",
            Self::Numerical => "the simulation gave no numbers",
        })
    }
}

/// Why a model cannot be fitted at all.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum FitError {
    /// There are fewer samples for training than parameters.
    #[error("{samples} training samples are too few for {parameters} parameters")]
    TooFewSamples {
        /// Samples there are.
        samples: usize,
        /// Parameters to fit.
        parameters: usize,
    },
    /// The input or the output has one value throughout.
    #[error("its {signal} never changes: no model can be fitted to it")]
    NeverChanges {
        /// Which of them.
        signal: &'static str,
    },
    /// What the model says is no number, or beyond what double precision can square.
    #[error(
        "the outputs of its model are not finite, or their squares are beyond double precision; \
         check its parameters and the unit of the log"
    )]
    NotFinite,
    /// Outputs beyond the largest value that a parameter may have.
    #[error(
        "its outputs go beyond {UNLIMITED:e}, the largest value of a model parameter; log it in a \
         larger unit"
    )]
    BeyondParameters,
}
