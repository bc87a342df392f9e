//! Pairs of effects, for where no single one shows.
//!
//! An effect may only show once another one is there: a dead band behind a gain that was
//! fitted without it, or two that take each other back. All pairs are surveyed on a part of
//! the record, and the best few are fitted to the end.

use super::Workers;
use super::race::{Entry, takes_part};
use crate::effect::{Effect, RecordRange};
use crate::fit::{Fit, Record, Survey, fit_to_compare, survey};
use crate::model::{Component, JointModel};

/// Pairs that are fitted to the end.
const FINALISTS: usize = 3;

/// `base` with two of `effects` more: the best few.
pub(super) fn pairs(
    record: &Record<'_>,
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
    let all: Vec<_> = of_two(effects).collect();
    let mut glances: Vec<_> = workers.map(&all, glance).into_iter().flatten().collect();
    glances.sort_by(|a, b| a.1.cost.total_cmp(&b.1.cost));
    glances.truncate(FINALISTS);
    let to_the_end = |(ids, survey): &([&'static str; 2], Survey)| {
        let fit = fit_to_compare(record, &survey.model, range).ok()?;
        Some(Entry { effects: ids.to_vec(), fit })
    };
    workers.map(&glances, to_the_end).into_iter().flatten().collect()
}

/// Each two of `effects`, once.
fn of_two<'e>(
    effects: &'e [&'static dyn Effect],
) -> impl Iterator<Item = [&'static dyn Effect; 2]> + 'e {
    let behind = |place: usize| effects.iter().skip(place + 1);
    effects.iter().enumerate().flat_map(move |(place, one)| behind(place).map(|two| [*one, *two]))
}

/// `model` with both effects; `None` where one has no place beside the other.
fn with_both(
    record: &Record<'_>,
    model: &JointModel,
    [one, two]: [&'static dyn Effect; 2],
) -> Option<JointModel> {
    let first = model.with(Component::neutral(one));
    let has_place =
        takes_part(record, &first, two.spec().id) && !two.spec().absorbs.contains(&one.spec().id);
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
