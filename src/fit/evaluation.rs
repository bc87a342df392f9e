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
    /// Where each trial began, for models near to this one; none where none will be asked for.
    pub(super) starts: Vec<Starts>,
}

impl Evaluation {
    /// An evaluation of which it is known how it was made, and no more.
    pub(crate) fn without_series(&self) -> Self {
        Self {
            horizon: self.horizon,
            simulated: Vec::new(),
            residuals: Vec::new(),
            starts: Vec::new(),
        }
    }
}

/// Where the windows of a trial begin.
#[derive(Clone, Debug)]
pub(super) struct Starts {
    /// The output at the start of each window.
    pub(super) outputs: Vec<f64>,
    /// Per sample, the slope of the output to it; `None` where it is 1.
    pub(super) slope: Option<Vec<f64>>,
}
