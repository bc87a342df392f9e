//! The error of a model from one step of the input to the next.

use crate::fit::{Evaluation, FitRecord, Part};

/// The error of a model between two steps of the input, at the first of which it was restarted.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StepError {
    /// Index of the trial.
    pub trial: usize,
    /// Index of its first sample.
    pub start: usize,
    /// Samples.
    pub samples: usize,
    /// Whether the model was fitted to it.
    pub part: Part,
    /// Sum of the squared residuals, output units squared.
    pub squared_error: f64,
}

impl StepError {
    /// Root mean square of the residual, output units.
    pub fn rmse(&self) -> f64 {
        (self.squared_error / self.samples.max(1) as f64).sqrt()
    }
}

/// The errors of `evaluation`, the simulations of which `record` restarts at every step.
pub(super) fn step_errors(record: &FitRecord<'_>, evaluation: &Evaluation) -> Vec<StepError> {
    let windows = record.windows().iter().filter_map(|window| {
        let residual = evaluation.residuals.get(window.trial)?.get(window.start..window.end)?;
        Some(StepError {
            trial: window.trial,
            start: window.start,
            samples: residual.len(),
            part: window.part,
            squared_error: residual.iter().map(|residual| residual * residual).sum(),
        })
    });
    windows.collect()
}
