//! How much of what a model lacked an effect explains, and when that is of consequence.

use crate::diagnosis::{ErrorFigures, sensor_noise};
use crate::fit::{Fit, FitRecord, Part};

/// The share of the misfit from which an effect has a practical consequence.
pub(super) const CONSEQUENCE: f64 = 0.01;

/// The part of the misfit below which what a model leaves is explained.
const HARDLY: f64 = 0.05;

/// How far the model was off to which effects are added: what shares are parts of.
#[derive(Clone, Copy, Debug)]
pub(super) struct Misfit {
    /// The error of that model on the whole record.
    first: f64,
    /// The same on the part that was not fitted, where there is one.
    unseen: Option<f64>,
    noise: f64,
}

impl Misfit {
    pub(super) fn of(record: &FitRecord<'_>, first: &Fit) -> Self {
        let unseen = unseen_error(record, first);
        let first = error(record, first);
        let noise = sensor_noise(&record.joint().trials).unwrap_or(0.0).min(first);
        Self { first, unseen, noise }
    }

    /// What the error of `worse` is larger than that of `better`, in parts of the misfit.
    pub(super) fn share(self, record: &FitRecord<'_>, worse: &Fit, better: &Fit) -> f64 {
        self.part_of(self.first, error(record, worse) - error(record, better))
    }

    /// The same on the whole record or on the part that was not fitted, whichever is more: an
    /// effect that only the unseen part needs is needed.
    pub(super) fn share_of_either(self, record: &FitRecord<'_>, worse: &Fit, better: &Fit) -> f64 {
        let grown = unseen_error(record, worse).zip(unseen_error(record, better));
        let unseen = self.unseen.zip(grown);
        let unseen = unseen.map(|(first, (worse, better))| self.part_of(first, worse - better));
        self.share(record, worse, better).max(unseen.unwrap_or(f64::NEG_INFINITY))
    }

    /// Whether an effect has a practical consequence with which the error falls from that of
    /// `worse` to that of `better`.
    pub(super) fn has_consequence(self, record: &FitRecord<'_>, worse: &Fit, better: &Fit) -> bool {
        self.share(record, worse, better) >= CONSEQUENCE
    }

    /// Whether what `fit` leaves beside the noise is hardly a part of the misfit.
    pub(super) fn is_explained(self, record: &FitRecord<'_>, fit: &Fit) -> bool {
        self.part_of(self.first, error(record, fit) - self.noise) < HARDLY
    }

    /// `error` in parts of that of the first model beyond the noise.
    fn part_of(self, first: f64, error: f64) -> f64 {
        error / (first - self.noise).max(f64::MIN_POSITIVE)
    }
}

/// The error on the whole record.
fn error(record: &FitRecord<'_>, fit: &Fit) -> f64 {
    ErrorFigures::of_record(record, &fit.evaluation).map_or(f64::NAN, |error| error.rmse)
}

/// The error on the part that was not fitted.
fn unseen_error(record: &FitRecord<'_>, fit: &Fit) -> Option<f64> {
    Some(ErrorFigures::of(record, &fit.evaluation, Part::Validation)?.rmse)
}
