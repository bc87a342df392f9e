//! Which of the candidates is to be named: the verdict on a model.

use super::attribution::Grown;
use super::candidate::Candidate;
use super::contribution::Attribution;
use super::extension::ids;
use super::misfit::Misfit;
use super::options::Options;
use super::revision::Change;
use super::separate::separate;
use super::stepwise::{Step, add_stepwise};
use super::verdict::{Explanation, Verdict};
use super::workers::Workers;
use crate::diagnosis::compare_knowing;
use crate::fit::{Fit, FitRecord};

/// The share of a misfit that an effect must explain to be named though the model with it
/// still fails. Chosen: nearly all of it.
const MOST_OF_IT: f64 = 0.9;

/// Effects that may be added after the first before the model is adequate. Chosen: each more
/// lets a wrong first effect be mended by later ones, and costs another ranking.
const LOOK_AHEAD: usize = 3;

/// Says what is missing from the model of `fit`.
///
/// The first of the ranking is named when the model with it is adequate, or would be with
/// up to three more effects, or when it explains most of the misfit.
pub fn explain(
    record: &FitRecord<'_>,
    fit: Fit,
    options: &Options,
    workers: &impl Workers,
) -> Explanation {
    let mut step = Step::new(record, Change::Start, fit);
    let lacks = step.rank_missing(record, options, workers);
    let Step { fit, lack_of_fit, mut ranking, .. } = step;
    let base = compare_knowing(record, fit.clone(), lack_of_fit);
    let attribution = Attribution::default();
    if !lacks {
        return Explanation { base, verdict: Verdict::Adequate, ranking, attribution };
    }
    let named = accounts_for_it(record, &mut ranking, options, workers);
    separate(record, &mut ranking, workers);
    let best = ranking.first().filter(|_| named);
    let attribution = best.map_or(attribution, |best| {
        let misfit = Misfit::of(record, &fit);
        Grown { record, first: &fit, whole: &best.fit, misfit, options }.attribution(workers)
    });
    let verdict = if named { Verdict::MissingEffect } else { Verdict::Unexplained };
    Explanation { base, verdict, ranking, attribution }
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
    let lacks = step.rank_missing(record, options, workers);
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
    let id = best.effects[0];
    let first = Step::new(record, Change::Added(id), best.fit.clone());
    let given: Vec<_> = ids(&best.fit.model).into_iter().filter(|given| *given != id).collect();
    let ahead = Options { max_effects: 1 + LOOK_AHEAD, keeps_refinements: true, ..options.clone() };
    let misfit = Misfit::of(record, &best.fit);
    let mut last = Vec::new();
    let ended = add_stepwise(record, first, &given, &ahead, workers, misfit, |step| {
        last = ids(&step.fit.model);
        true
    });
    let is_adequate = ended.verdict == Verdict::Adequate;
    let named = best.share_of_misfit >= MOST_OF_IT || is_adequate;
    if is_adequate {
        let remains = |candidate: &Candidate| candidate.effects.iter().all(|id| last.contains(id));
        if let Some(index) = ranking.iter().position(remains) {
            ranking[..=index].rotate_right(1);
        }
    }
    named
}
