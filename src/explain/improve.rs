//! Explain and add, until nothing significant is left.

use super::Workers;
use super::candidate::Candidate;
use super::grow::{Change, Step, grow, ids};
use super::race::Options;
use super::separate::separate;
use super::verdict::Verdict;
use crate::diagnosis::{Comparison, compare_knowing};
use crate::fit::{Fit, FitRecord};

/// A model and its error.
#[derive(Clone, Debug)]
pub struct Revision {
    /// What changed.
    pub change: Change,
    /// The model, fitted.
    pub comparison: Comparison,
    /// The candidates for what comes next, best first; none where none was looked for.
    pub ranking: Vec<Candidate>,
}

/// A model that was improved.
#[derive(Clone, Debug)]
pub struct Improvement {
    /// The model as it was given, and after each change.
    pub revisions: Vec<Revision>,
    /// What is to be said of the last.
    pub verdict: Verdict,
}

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
    let verdict = grow(record, first, &given, options, workers, |step| {
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
