//! What the history of a model says of one change.

use serde::Deserialize;

/// A change of a joint's model.
#[derive(Clone, Debug, Default, PartialEq, Deserialize)]
pub struct Revision {
    /// Its number, from 1.
    pub revision: u32,
    /// Id of the effect that came.
    pub added: Option<String>,
    /// Id of the effect that went.
    pub removed: Option<String>,
    /// Root mean square of the error on the validation part after it, in output units.
    pub validation_rmse: Option<f64>,
}
