//! What a model makes of a record.

use super::window::Horizon;
use crate::model::Simulated;

/// A model on a record: what it simulates, and the residuals.
#[derive(Clone, Debug)]
pub struct Evaluation {
    /// How long each simulation ran before it was set right.
    pub horizon: Horizon,
    /// One simulation per trial.
    pub simulated: Vec<Simulated>,
    /// Measured minus simulated, per trial and sample, output units. Each window is
    /// simulated from the output that makes its own error least.
    pub residuals: Vec<Vec<f64>>,
    /// Per trial, the output at the start of each window.
    pub(super) starts: Vec<Vec<f64>>,
    /// Per trial and sample, the slope of the output to it; `None` where it is 1.
    pub(super) slopes: Vec<Option<Vec<f64>>>,
}
