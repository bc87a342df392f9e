//! Which of the candidates is to be named: the verdict on a model.

use super::attribution::Grown;
use super::candidate::Candidate;
use super::contribution::Attribution;
use super::decide::{Judge, in_order};
use super::extension::ids;
use super::judgement::Refusal;
use super::misfit::{Errors, Misfit};
use super::options::Options;
use super::outcome::FitOutcome;
use super::revision::Change;
use super::separate::separate;
use super::stepwise::{Step, add_stepwise};
use super::structures::{is_usual_of_strokes, of_strokes};
use super::verdict::{Explanation, Verdict};
use super::workers::Workers;
use crate::delay::are_strokes;
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
/// The first of the ranking that nothing speaks against is named when the model with it is adequate, or
/// would be with up to three more effects, or when it explains most of the misfit. Of a joint that is
/// driven in strokes, the best of the usual effects is named when these explain most of it together.
pub fn explain(
    record: &FitRecord<'_>,
    fit: Fit,
    options: &Options,
    workers: &impl Workers,
) -> Explanation {
    let options = &*options.of(record.joint());
    let misfit = Misfit::of(record, &Errors::of(record, &fit));
    let mut step = Step::new(record, Change::Start, fit);
    let lacks = step.rank_missing(record, misfit, options, workers);
    let Step { fit, lack_of_fit, mut ranking, .. } = step;
    let base = compare_knowing(record, fit.clone(), lack_of_fit);
    let attribution = Attribution::default();
    if !lacks {
        let ranking = in_order(ranking);
        return Explanation { base, verdict: Verdict::Adequate, ranking, attribution };
    }
    let named = is_named(record, &fit, &mut ranking, options, workers);
    let verdict = if named { Verdict::MissingEffect } else { Verdict::Unexplained };
    decided(&mut ranking, verdict);
    separate(record, &mut ranking, workers);
    let best = ranking.first().filter(|_| named);
    let attribution = best.map_or(attribution, |best| {
        let first = FitOutcome::of(record, fit);
        let misfit = Misfit::of(record, &first.errors);
        Grown { record, first: &first, whole: &best.fit.on(record), misfit, options }
            .attribution(workers)
    });
    Explanation { base, verdict, ranking: in_order(ranking), attribution }
}

/// Refuses those that nothing speaks against but the first of a ranking where that is named, and all where
/// none is.
fn decided(ranking: &mut [Candidate], verdict: Verdict) {
    let (why_not, named) = match ranking.first() {
        Some(first) if verdict == Verdict::MissingEffect => (Refusal::Behind(first.name()), 1),
        _ => (Refusal::NotTheWhole, 0),
    };
    for other in ranking.iter_mut().skip(named).filter(|other| other.judgement.is_added()) {
        other.judgement.refusal = Some(why_not.clone());
    }
}

/// The candidates for what the model of `fit` lacks, best first, where the first is to be
/// named; else none.
pub(crate) fn named(
    record: &FitRecord<'_>,
    fit: Fit,
    options: &Options,
    workers: &impl Workers,
) -> Vec<Candidate> {
    let misfit = Misfit::of(record, &Errors::of(record, &fit));
    let mut step = Step::new(record, Change::Start, fit);
    let lacks = step.rank_missing(record, misfit, options, workers);
    let is_named = lacks && is_named(record, &step.fit, &mut step.ranking, options, workers);
    if is_named { step.ranking } else { Vec::new() }
}

/// Judges each candidate; whether the best that nothing speaks against is to be named, which comes first
/// then; of strokes, the best of the usual ones.
fn is_named(
    record: &FitRecord<'_>,
    fit: &Fit,
    ranking: &mut [Candidate],
    options: &Options,
    workers: &impl Workers,
) -> bool {
    let misfit = Misfit::of(record, &Errors::of(record, fit));
    let judge = Judge::new(record, fit, misfit, options);
    for candidate in &mut *ranking {
        candidate.judgement = judge.judge(candidate);
    }
    let is_usual = |one: &Candidate| one.effects.iter().all(is_usual_of_strokes);
    let usual = are_strokes(&record.joint().trials)
        && usual_account_for_most(record, &judge)
        && brought_forward(ranking, is_usual);
    usual
        || brought_forward(ranking, |_| true) && accounts_for_it(record, ranking, options, workers)
}

/// Whether the usual effects together explain most of what the model lacks that `judge` adds to.
fn usual_account_for_most(record: &FitRecord<'_>, judge: &Judge<'_, '_>) -> bool {
    /// The share of the misfit that is most of it.
    const MOST: f64 = 0.5;
    let Judge { base, ref own, misfit, options, .. } = *judge;
    let with_all = of_strokes(record, base, options, misfit).pop();
    with_all.is_some_and(|(_, all)| misfit.share(own, &Errors::of(record, &all)) >= MOST)
}

/// Puts the first candidate that nothing speaks against and that `is_it` in front; whether there is one.
fn brought_forward(ranking: &mut [Candidate], is_it: impl Fn(&Candidate) -> bool) -> bool {
    let found = ranking.iter().position(|one| one.judgement.is_added() && is_it(one));
    if let Some(index) = found {
        ranking[..=index].rotate_right(1);
    }
    found.is_some()
}

/// Whether the best candidate is to be named. An effect that further ones make useless
/// gives way to the first that remains.
fn accounts_for_it(
    record: &FitRecord<'_>,
    ranking: &mut [Candidate],
    options: &Options,
    workers: &impl Workers,
) -> bool {
    let Some(best) = ranking.first() else { return false };
    // What is to be added to an effect that explains nearly all by itself, as no other does, would
    // not change its name.
    let explains_most = |one: &&Candidate| one.share_of_misfit >= MOST_OF_IT;
    if explains_most(&best) && ranking.iter().filter(explains_most).count() == 1 {
        return true;
    }
    let id = best.effects[0];
    let first = Step::new(record, Change::Added(id), best.fit.on(record));
    let given: Vec<_> = ids(&best.fit.model).into_iter().filter(|given| *given != id).collect();
    let ahead = Options { max_effects: 1 + LOOK_AHEAD, keeps_refinements: true, ..options.clone() };
    let misfit = Misfit::of(record, &best.fit.errors);
    let mut last = Vec::new();
    let ended = add_stepwise(record, first, &given, &ahead, workers, misfit, |step| {
        last = ids(&step.fit.model);
        true
    });
    let is_adequate = ended.verdict == Verdict::Adequate;
    let named = best.share_of_misfit >= MOST_OF_IT || is_adequate;
    if is_adequate {
        brought_forward(ranking, |candidate| candidate.effects.iter().all(|id| last.contains(id)));
    }
    named
}
