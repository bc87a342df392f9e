//! What a race says of the model.

use serde::Serialize;

use super::Workers;
use super::candidate::Candidate;
use super::grow::{Change, Step, grow, ids, put_first};
use super::race::Options;
use super::separate::separate;
use crate::diagnosis::{Comparison, compare_knowing};
use crate::fit::{Fit, FitRecord};

/// What is to be said of a model.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Verdict {
    /// No lack of fit is shown: nothing to add.
    Adequate,
    /// The first of the ranking explains a significant part.
    MissingEffect,
    /// The model fails, and no effect accounts for it.
    Unexplained,
}

/// What is missing from a model.
#[derive(Clone, Debug)]
pub struct Explanation {
    /// The model as it is, fitted.
    pub base: Comparison,
    /// What is to be said of it.
    pub verdict: Verdict,
    /// The candidates, best first; none where the model is adequate.
    pub ranking: Vec<Candidate>,
}

/// The share of a misfit that an effect must take away to be named though the model with it
/// still fails.
const MOST_OF_IT: f64 = 0.9;

/// Effects that may come behind the first before the model is adequate.
const LOOK_AHEAD: usize = 3;

/// Says what is missing from the model of `fit`.
///
/// The first of the ranking is named when the model with it is adequate, or would be with
/// up to three more effects, or when it takes most of the misfit away.
pub fn explain(
    record: &FitRecord<'_>,
    fit: Fit,
    options: &Options,
    workers: &impl Workers,
) -> Explanation {
    let mut step = Step::new(record, Change::Start, fit);
    let lacks = step.look(record, options, workers);
    let Step { fit, lack_of_fit, mut ranking, .. } = step;
    let base = compare_knowing(record, fit, lack_of_fit);
    if !lacks {
        return Explanation { base, verdict: Verdict::Adequate, ranking };
    }
    let named = accounts_for_it(record, &mut ranking, options, workers);
    separate(record, &mut ranking, workers);
    let verdict = if named { Verdict::MissingEffect } else { Verdict::Unexplained };
    Explanation { base, verdict, ranking }
}

/// The candidates for what the model of `fit` lacks, best first, where the first is to be
/// named; else none.
pub(crate) fn named(
    record: &FitRecord<'_>,
    fit: Fit,
    options: &Options,
    workers: &impl Workers,
) -> Vec<Candidate> {
    let mut step = Step::new(record, Change::Start, fit);
    let lacks = step.look(record, options, workers);
    let is_named = lacks && accounts_for_it(record, &mut step.ranking, options, workers);
    if is_named { step.ranking } else { Vec::new() }
}

/// Whether the best candidate is to be named. An effect that further ones make useless
/// gives way to the first that remains.
fn accounts_for_it(
    record: &FitRecord<'_>,
    ranking: &mut [Candidate],
    options: &Options,
    workers: &impl Workers,
) -> bool {
    let Some(best) = ranking.first().filter(|best| best.is_significant()) else { return false };
    let id = best.effects.first().copied().unwrap_or_default();
    let first = Step::new(record, Change::Added(id), best.fit.clone());
    let given: Vec<_> = ids(&best.fit.model).into_iter().filter(|given| *given != id).collect();
    let ahead = Options { max_effects: 1 + LOOK_AHEAD, ..options.clone() };
    let mut last = Vec::new();
    let verdict = grow(record, first, &given, &ahead, workers, |step| {
        last = ids(&step.fit.model);
        true
    });
    let named = best.share_of_misfit >= MOST_OF_IT || verdict == Verdict::Adequate;
    if verdict == Verdict::Adequate {
        let remains = |candidate: &Candidate| candidate.effects.iter().all(|id| last.contains(id));
        if let Some(place) = ranking.iter().position(remains) {
            put_first(ranking, place);
        }
    }
    named
}
