//! The ladder of errors: how the error falls from revision to revision.

use crate::diagnosis::Comparison;

/// The error by which a revision is judged.
pub(crate) fn judged(comparison: &Comparison) -> f64 {
    comparison.validation.or(comparison.training).map_or(0.0, |error| error.rmse)
}
