//! What the history of a model says of one change.

use serde::de::Error as _;
use serde::{Deserialize, Deserializer};

/// A change of a joint's model.
#[derive(Clone, Debug, Default, PartialEq, Deserialize)]
pub struct Revision {
    /// Its number, from 1.
    #[serde(deserialize_with = "number")]
    pub revision: u32,
    /// Id of the effect that came.
    pub added: Option<String>,
    /// Id of the effect that went.
    pub removed: Option<String>,
    /// Root mean square of the error on the validation part after it, in output units.
    pub validation_rmse: Option<f64>,
}

/// The number of a revision, after which there are others.
fn number<'de, D: Deserializer<'de>>(from: D) -> Result<u32, D::Error> {
    const MOST: u32 = 1_000_000_000;
    let number = u32::deserialize(from)?;
    if number > MOST {
        return Err(D::Error::custom(format!("revision {number}; the last one is {MOST}")));
    }
    Ok(number)
}
