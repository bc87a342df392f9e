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
    /// The errors after it.
    #[serde(flatten)]
    pub errors: RevisionErrors,
}

/// The errors of a revision, in output units: a row of the ladder of errors.
#[derive(Clone, Debug, Default, PartialEq, Deserialize)]
pub struct RevisionErrors {
    /// Root mean square of the error on the training part.
    pub train_rmse: Option<f64>,
    /// That on the validation part.
    pub validation_rmse: Option<f64>,
    /// That with nothing removed, each run from the measured output.
    pub rmse_raw: Option<f64>,
    /// That of a free run from the start of each trial.
    pub rmse_free: Option<f64>,
    /// The fit on the validation part, percent.
    pub fit_percent: Option<f64>,
    /// Whether a lack of fit was shown, in words.
    pub lack_of_fit: Option<String>,
}

impl RevisionErrors {
    /// The error by which the revision is judged: on the validation part where there is one.
    pub fn judged(&self) -> Option<f64> {
        self.validation_rmse.or(self.train_rmse)
    }
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
