//! The best experiment for each two candidates that a record cannot distinguish.

use super::contrast::Contrast;
use super::space::ExperimentSpace;
use crate::explain::candidate::{ALIKE, Candidate};
use crate::explain::separation::{Proposal, Separation};
use crate::explain::workers::Workers;
use crate::fit::FitRecord;

/// A difference of less than so many times the noise separates nothing: one that a person sees
/// in the log. Chosen.
const VISIBLE: f64 = 3.0;

/// Twice the difference in log-likelihood from which two models are separated: well above
/// that below which they are alike, because a fit may explain some of it. Chosen.
const CLEAR: f64 = 4.0 * ALIKE;

/// Gives each candidate that is worth a name the experiments that would separate it from those
/// that it cannot be distinguished from.
pub(in crate::explain) fn separate(
    record: &FitRecord<'_>,
    ranking: &mut [Candidate],
    workers: &impl Workers,
) {
    let index_of = |id: &str| ranking.iter().position(|c| c.effects == [id]);
    let of_one = |(one, candidate): (usize, &Candidate)| {
        let worthy = candidate.is_significant();
        let others = candidate.indistinguishable_from.iter().filter_map(|id| index_of(id));
        others.filter(move |_| worthy).map(move |other| (one, other)).collect::<Vec<_>>()
    };
    let pairs: Vec<_> = ranking.iter().enumerate().flat_map(of_one).collect();
    let space = ExperimentSpace::of(record);
    let best = |(one, other): &(usize, usize)| {
        Some((*one, best_experiment(&space, &ranking[*one], &ranking[*other])?))
    };
    let found = workers.map(&pairs, best);
    for (one, separation) in found.into_iter().flatten() {
        ranking[one].separated_by.push(separation);
    }
}

/// The best experiment: within the levels of the record, and beyond them only where none
/// within separates the two.
fn best_experiment(
    space: &ExperimentSpace,
    one: &Candidate,
    other: &Candidate,
) -> Option<Separation> {
    let &[id] = other.effects.as_slice() else { return None };
    let noise = space.sensor_noise.or(one.training.map(|error| error.rmse));
    let noise = noise.filter(|noise| *noise > 0.0)?;
    let (within, beyond) = space.proposals([one, other]);
    let separation = |proposal: Proposal| {
        let found = space.contrast(&proposal, [&one.fit.model, &other.fit.model], noise)?;
        let Contrast { times_noise, after_s, evidence } = found;
        let is_clear = times_noise >= VISIBLE && evidence >= CLEAR;
        let per_second = evidence / proposal.duration_s();
        let found = Separation { other: id, proposal, times_noise, after_s, is_clear };
        Some((found, per_second))
    };
    let best = |proposals: Vec<Proposal>| {
        let found = proposals.into_iter().filter_map(separation);
        let order = |a: &(Separation, f64), b: &(Separation, f64)| {
            a.0.is_clear.cmp(&b.0.is_clear).then(a.1.total_cmp(&b.1))
        };
        found.max_by(order).map(|(separation, _)| separation)
    };
    let inside = best(within);
    if inside.as_ref().is_some_and(|found| found.is_clear) {
        return inside;
    }
    best(beyond).filter(|found| found.is_clear).or(inside)
}
