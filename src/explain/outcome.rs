//! What a fit came to, without the series that it was judged by.

use std::ops::Deref;
use std::sync::Arc;

use super::misfit::Errors;
use crate::effect::RecordRange;
use crate::fit::{AssessedModel, Assessment, Fit, FitRecord, Termination, fit_to_compare};
use crate::model::JointModel;

/// A fitted model and its errors, without what it simulates.
///
/// The series of a model are four times as long as the record. Of the many models that are tried
/// few are looked at again, and what these simulate is found again from them.
#[derive(Clone, Debug)]
pub struct FitOutcome {
    /// The model at the fitted values.
    pub assessed: AssessedModel,
    /// The sum of squared errors that was minimised: see [`Fit::cost`].
    pub cost: f64,
    /// Why it stopped.
    pub termination: Termination,
    pub(super) errors: Errors,
}

impl Deref for FitOutcome {
    type Target = AssessedModel;

    fn deref(&self) -> &AssessedModel {
        &self.assessed
    }
}

impl FitOutcome {
    /// What `fit` came to on `record`.
    pub(super) fn of(record: &FitRecord<'_>, fit: Fit) -> Self {
        let errors = Errors::of(record, &fit);
        let Fit { assessment: Assessment { assessed, .. }, cost, termination } = fit;
        Self { assessed, cost, termination, errors }
    }

    /// What a fit of `model` comes to; none where it cannot be fitted.
    pub(super) fn fitted(
        record: &FitRecord<'_>,
        model: &JointModel,
        range: &RecordRange<'_>,
    ) -> Option<Self> {
        Some(Self::of(record, fit_to_compare(record, model, range).ok()?))
    }

    /// The fit with its series on `record`, the one to which it was fitted.
    pub(super) fn on(&self, record: &FitRecord<'_>) -> Fit {
        let evaluation = Arc::new(record.evaluate(&self.model));
        let assessment = Assessment { assessed: self.assessed.clone(), evaluation };
        Fit { assessment, cost: self.cost, termination: self.termination }
    }
}
