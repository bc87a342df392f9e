//! Explain and add, until nothing significant is missing.

use super::extension::ids;
use super::options::Options;
use super::revision::{Change, Improvement, Revision};
use super::separate::separate;
use super::stepwise::{Step, add_stepwise};
use super::workers::Workers;
use crate::diagnosis::compare_knowing;
use crate::fit::{Fit, FitRecord};

/// Adds what is missing from the model of `fit`, one effect after the other.
///
/// After each effect, those that were added before and have become useless are removed.
/// `done` is called with each revision; where it says no, nothing more is tried.
pub fn improve(
    record: &FitRecord<'_>,
    fit: Fit,
    options: &Options,
    workers: &impl Workers,
    mut done: impl FnMut(&Revision) -> bool,
) -> Improvement {
    let given = ids(&fit.model);
    let first = Step::new(record, Change::Start, fit);
    let mut revisions = Vec::new();
    let verdict = add_stepwise(record, first, &given, options, workers, |step| {
        let Step { change, fit, lack_of_fit, mut ranking } = step.clone();
        separate(record, &mut ranking, workers);
        let comparison = compare_knowing(record, fit, lack_of_fit);
        let revision = Revision { change, comparison, ranking };
        let goes_on = done(&revision);
        revisions.push(revision);
        goes_on
    });
    Improvement { revisions, verdict }
}
