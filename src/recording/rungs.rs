//! The ladder of errors: how the error falls from revision to revision.

use crate::diagnosis::Comparison;
use crate::explain::Revision;

/// A revision of a model on the ladder.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Rung<'r> {
    pub(crate) revision: &'r Revision,
    /// The root mean square error by which the revision is judged.
    pub(crate) error: f64,
}

/// All rungs, the first revision being the first.
pub(crate) fn rungs<'r>(revisions: &'r [Revision]) -> Vec<Rung<'r>> {
    let rung = |revision: &'r Revision| Rung { revision, error: judged(&revision.comparison) };
    revisions.iter().map(rung).collect()
}

/// The largest error.
pub(crate) fn largest(rungs: &[Rung<'_>]) -> f64 {
    rungs.iter().map(|rung| rung.error).fold(0.0, f64::max)
}

/// The error by which a revision is judged: on data that were not fitted, where there are any.
pub(crate) fn judged(comparison: &Comparison) -> f64 {
    comparison.judged().map_or(0.0, |error| error.rmse)
}
