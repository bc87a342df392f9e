//! How large the error of a model is.

use crate::fit::{Evaluation, FitRecord, Part, Window, is_rounding};

/// The error of a model on one part of a record, without isolated spikes of the sensor.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ErrorFigures {
    /// Root of the mean squared residual, output units: what a fit minimises, in which each run
    /// between restarts starts where its own error is least.
    pub rmse: f64,
    /// `100 · (1 − ‖y − ŷ‖ / ‖y − mean(y)‖)`: 100 for a perfect model, 0 for one that is
    /// no better than the mean of each run; −∞ of an output that stands still.
    pub fit_percent: f64,
    /// Largest residual, output units.
    pub max: f64,
}

impl ErrorFigures {
    /// The error of an evaluated model on `part`; `None` where it has no sample.
    pub fn of(record: &FitRecord<'_>, evaluation: &Evaluation, part: Part) -> Option<Self> {
        Self::over(record, &evaluation.residuals, record.part(part))
    }

    /// The error of an evaluated model on both parts together.
    pub(crate) fn of_record(record: &FitRecord<'_>, evaluation: &Evaluation) -> Option<Self> {
        Self::over(record, &evaluation.residuals, record.windows().iter())
    }

    fn over<'w>(
        record: &FitRecord<'_>,
        all: &[Vec<f64>],
        windows: impl Iterator<Item = &'w Window>,
    ) -> Option<Self> {
        let (mut samples, mut squares, mut spread, mut max) = (0_usize, 0.0, 0.0, 0.0_f64);
        let windows: Vec<&Window> = windows.collect();
        for run in windows.chunk_by(|a, b| a.trial == b.trial && !b.restarts) {
            let mut measured = Vec::new();
            for window in run {
                let residuals = all.get(window.trial)?.get(window.start..window.end)?;
                let output = record.joint().trials.get(window.trial)?.output();
                let weights = record.weights_of(window.trial);
                let counts =
                    |k: &usize| weights.is_none_or(|all| all.get(window.start + k) != Some(&0.0));
                for k in (0..residuals.len()).filter(counts) {
                    samples += 1;
                    squares += residuals[k] * residuals[k];
                    max = max.max(residuals[k].abs());
                    measured.push(output[window.start + k]);
                }
            }
            let mean = measured.iter().sum::<f64>() / measured.len().max(1) as f64;
            spread += measured.iter().map(|y| (y - mean) * (y - mean)).sum::<f64>();
        }
        // Of an output that stands still nothing but rounding is left without its mean.
        let stands_still =
            is_rounding(&record.joint().trials, (spread / samples.max(1) as f64).sqrt());
        let fit_percent = if stands_still {
            f64::NEG_INFINITY
        } else {
            100.0 * (1.0 - (squares / spread).sqrt())
        };
        (samples > 0).then(|| Self { rmse: (squares / samples as f64).sqrt(), fit_percent, max })
    }
}

/// Root-mean-square errors of simulations from which nothing is removed, output units; none for a
/// part without samples.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct RawErrors {
    /// On the part that was fitted.
    pub training: Option<f64>,
    /// On the part that was not.
    pub validation: Option<f64>,
}

impl RawErrors {
    /// Of these residuals, judged on the parts of `record`.
    pub(super) fn of(record: &FitRecord<'_>, residuals: &[Vec<f64>]) -> Self {
        let on = |part| Some(ErrorFigures::over(record, residuals, record.part(part))?.rmse);
        Self { training: on(Part::Training), validation: on(Part::Validation) }
    }

    /// That by which a model is judged: on the part that was not fitted, where there is one.
    pub fn judged(self) -> Option<f64> {
        self.validation.or(self.training)
    }
}
