//! A model beside the measurement: all figures of it.

use super::shapes::shapes;
use super::{ErrorFigures, LackOfFit, TestColumns, lack_of_fit, noise_floor};
use crate::fit::{Evaluation, Fit, Part, Record};
use crate::model::{JointModel, arrivals};

/// A fitted model beside the measurement.
#[derive(Clone, Debug)]
pub struct Comparison {
    /// The model, its parameters and what it simulates.
    pub fit: Fit,
    /// The error on the part it was fitted to.
    pub training: Option<ErrorFigures>,
    /// The error on the part it was not fitted to.
    pub validation: Option<ErrorFigures>,
    /// Standard deviation of the measurement noise, output units.
    pub noise_floor: Option<f64>,
    /// Whether the residual of the training part is more than noise; `None` where there
    /// are too few samples to tell.
    pub lack_of_fit: Option<LackOfFit>,
}

/// Sets all figures of `fit` on `record` beside one another.
pub fn compare(record: &Record<'_>, fit: Fit) -> Comparison {
    let error = |part| ErrorFigures::of(record, &fit.evaluation, part);
    let arriving: Vec<_> =
        record.joint().trials.iter().map(|trial| arrivals(&fit.model, trial, None)).collect();
    let noise_floor = noise_floor(record.joint().trials.iter().zip(&arriving));
    let columns = TestColumns {
        residuals: cut(record, &fit.evaluation),
        own: sensitivities(record, &fit),
        shapes: shapes(record, &fit.evaluation, Part::Training),
    };
    Comparison {
        training: error(Part::Training),
        validation: error(Part::Validation),
        noise_floor,
        lack_of_fit: lack_of_fit(&columns),
        fit,
    }
}

/// Residuals of the training windows, one list per window.
fn cut(record: &Record<'_>, evaluation: &Evaluation) -> Vec<Vec<f64>> {
    let windows = record.part(Part::Training);
    let values = windows.filter_map(|w| evaluation.residuals.get(w.trial)?.get(w.start..w.end));
    values.map(<[f64]>::to_vec).collect()
}

/// Derivatives of the residual to each parameter, by central differences.
fn sensitivities(record: &Record<'_>, fit: &Fit) -> Vec<Vec<Vec<f64>>> {
    /// Part of a value, or of one unit where the value is small, that is stepped.
    const STEP: f64 = 1e-4;
    let values: Vec<f64> = fit.model.values().iter().map(|value| value.value).collect();
    let column = |index: usize| {
        let value = values.get(index).copied().unwrap_or_default();
        let step = STEP * value.abs().max(0.1);
        let [above, below] = [step, -step].map(|shift| {
            let mut values = values.clone();
            if let Some(value) = values.get_mut(index) {
                *value += shift;
            }
            let model: JointModel = fit.model.with_values(&values);
            cut(record, &record.evaluate(&model))
        });
        let pairs = above.into_iter().zip(below);
        pairs
            .map(|(a, b)| a.iter().zip(&b).map(|(a, b)| (a - b) / (2.0 * step)).collect())
            .collect()
    };
    (0..values.len()).map(column).collect()
}
