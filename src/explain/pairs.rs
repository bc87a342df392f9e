//! Pairs of effects, for where no single one shows.
//!
//! An effect may only show once another one is there: a dead band behind a gain that was
//! fitted without it, or two that take each other back. Scores on a part of the record tell
//! which pairs are worth a survey, and the best few of these are fitted to the end.

use super::Workers;
use super::race::{Entry, takes_part};
use crate::effect::{Effect, RecordRange};
use crate::fit::{Directions, Fit, FitRecord, Score, Survey, fit_to_compare, survey};
use crate::model::{Component, JointModel};

/// Pairs that are surveyed. Of 23 records that hid two effects of the catalogue their pair was
/// among the first 17 of 136 by its score in 22, and the 48th in the other.
const SURVEYED: usize = 48;

/// Pairs that are fitted to the end.
const FINALISTS: usize = 3;

/// `base` with two of `effects` more: the best few.
pub(super) fn pairs(
    record: &FitRecord<'_>,
    base: &Fit,
    effects: &[&'static dyn Effect],
    range: &RecordRange<'_>,
    workers: &impl Workers,
) -> Vec<Entry> {
    let surveyed = record.thinned();
    let glance = |pair: &[&'static dyn Effect; 2]| {
        let model = with_both(record, &base.model, *pair)?;
        Some((pair.map(|effect| effect.spec().id), survey(&surveyed, &model, range).ok()?))
    };
    let all = best_scored(&surveyed, base, effects, range, workers);
    let mut glances: Vec<_> = workers.map(&all, glance).into_iter().flatten().collect();
    glances.sort_by(|a, b| a.1.cost.total_cmp(&b.1.cost));
    glances.truncate(FINALISTS);
    let to_the_end = |(ids, survey): &([&'static str; 2], Survey)| {
        let fit = fit_to_compare(record, &survey.model, range).ok()?;
        Some(Entry { effects: ids.to_vec(), fit })
    };
    workers.map(&glances, to_the_end).into_iter().flatten().collect()
}

/// The pairs of `effects` that would take most of the residual of `base` at a glance.
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
    let known: Vec<(&'static dyn Effect, Directions)> =
        effects.iter().copied().zip(directions).collect();
    let indices: Vec<usize> = (0..known.len()).collect();
    let pairs: Vec<_> = of_two(&indices).collect();
    let share = |pair: &[usize; 2]| {
        let [one, two] = pair.map(|index| known.get(index));
        one.zip(two).map_or(0.0, |(one, two)| one.1.share_with(&two.1))
    };
    let mut scored: Vec<_> = workers.map(&pairs, share).into_iter().zip(pairs).collect();
    scored.sort_by(|a, b| b.0.total_cmp(&a.0));
    let effect = |index: usize| known.get(index).map(|(effect, _)| *effect);
    let pair = |(_, [one, two]): (f64, [usize; 2])| Some([effect(one)?, effect(two)?]);
    scored.into_iter().take(SURVEYED).filter_map(pair).collect()
}

/// Each two of `all`, once.
fn of_two<T: Copy>(all: &[T]) -> impl Iterator<Item = [T; 2]> + '_ {
    let behind = |place: usize| all.iter().skip(place + 1);
    all.iter().enumerate().flat_map(move |(place, one)| behind(place).map(|two| [*one, *two]))
}

/// `model` with both effects; `None` where one has no place beside the other.
fn with_both(
    record: &FitRecord<'_>,
    model: &JointModel,
    [one, two]: [&'static dyn Effect; 2],
) -> Option<JointModel> {
    let first = model.with(Component::neutral(one));
    let has_place =
        takes_part(record, &first, two.spec()) && !two.spec().absorbs.contains(&one.spec().id);
    has_place.then(|| first.with(Component::neutral(two)))
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
