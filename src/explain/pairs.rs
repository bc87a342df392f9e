//! Pairs of effects, for where no single one shows.
//!
//! An effect may only show once another one is there: a dead band masked by a gain that was
//! fitted without it, or two that cancel each other. Scores on a part of the record say which
//! pairs are worth a survey, and the best few of these are fitted.

use super::eligible::could_be_missing;
use super::extension::Extension;
use super::screening::fit_best;
use super::workers::Workers;
use crate::effect::{Effect, RecordRange};
use crate::fit::{Directions, Fit, FitRecord, Score};
use crate::model::{Component, JointModel};

/// Pairs that are surveyed. Of 23 records that hid two effects of the catalogue their pair was
/// among the first 17 of 136 by its score in 22, and the 48th in the other. On measured records
/// the surveys of 48 took half of the whole time.
const SURVEYED: usize = 24;

/// Pairs that are fitted. Chosen: each more costs a fit.
const FINALISTS: usize = 3;

/// `base` with two of `effects` more: the best few.
pub(super) fn pairs(
    record: &FitRecord<'_>,
    base: &Fit,
    effects: &[&'static dyn Effect],
    range: &RecordRange<'_>,
    workers: &impl Workers,
) -> Vec<Extension> {
    let scored = best_scored(record, base, effects, range, workers);
    let with = |pair: &[&'static dyn Effect; 2]| {
        Some((pair.map(|effect| effect.spec().id), with_both(record, &base.model, *pair)?))
    };
    let models: Vec<_> = scored.iter().filter_map(with).collect();
    let fits = fit_best(record, &models, range, |_| FINALISTS, workers);
    fits.into_iter().map(|(ids, fit)| Extension { effects: ids.to_vec(), fit }).collect()
}

/// The pairs of `effects` that would explain most of the residual of `base`, to first order.
fn best_scored(
    record: &FitRecord<'_>,
    base: &Fit,
    effects: &[&'static dyn Effect],
    range: &RecordRange<'_>,
    workers: &impl Workers,
) -> Vec<[&'static dyn Effect; 2]> {
    let Some(score) = Score::of(record, &base.model, range) else {
        return of_two(effects).take(SURVEYED).collect();
    };
    let directions = |effect: &&'static dyn Effect| {
        score.directions(&base.model.with(Component::neutral(*effect)), range)
    };
    let directions = workers.map(effects, directions);
    let known: Vec<(&'static dyn Effect, &Directions)> =
        effects.iter().copied().zip(&directions).collect();
    let pairs: Vec<_> = of_two(&known).collect();
    let share = |[one, two]: &[(&'static dyn Effect, &Directions); 2]| one.1.share_with(two.1);
    let mut scored: Vec<_> = workers.map(&pairs, share).into_iter().zip(pairs).collect();
    scored.sort_by(|a, b| b.0.total_cmp(&a.0));
    scored.truncate(SURVEYED);
    scored.into_iter().map(|(_, pair)| pair.map(|(effect, _)| effect)).collect()
}

/// Each two of `all`, once.
fn of_two<T: Copy>(all: &[T]) -> impl Iterator<Item = [T; 2]> + '_ {
    let pairs_of = |(index, one): (usize, &T)| {
        let one = *one;
        all[index + 1..].iter().map(move |two| [one, *two])
    };
    all.iter().enumerate().flat_map(pairs_of)
}

/// `model` with both effects; `None` where one makes the other useless.
fn with_both(
    record: &FitRecord<'_>,
    model: &JointModel,
    [one, two]: [&'static dyn Effect; 2],
) -> Option<JointModel> {
    let first = model.with(Component::neutral(one));
    let is_useful =
        could_be_missing(record, &first, two) && !two.spec().absorbs.contains(&one.spec().id);
    is_useful.then(|| first.with(Component::neutral(two)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effect::REGISTRY;

    #[test]
    fn each_two_are_there_once() {
        let pairs: Vec<_> = of_two(&REGISTRY[..5]).collect();
        assert_eq!(pairs.len(), 10);
        let mut ids: Vec<_> = pairs.iter().map(|pair| pair.map(|e| e.spec().id)).collect();
        ids.sort_unstable();
        ids.dedup();
        assert!(ids.len() == 10 && ids.iter().all(|[one, two]| one != two));
    }
}
