//! Explain and add, until nothing significant is missing.

use super::attribution::{Grown, LeftOut};
use super::contribution::Attribution;
use super::decide::in_order;
use super::extension::ids;
use super::misfit::{Errors, Misfit};
use super::options::Options;
use super::outcome::FitOutcome;
use super::revision::{Change, Improvement, Revision};
use super::separate::separate;
use super::stepwise::{Ended, Step, add_stepwise};
use super::structures::{is_more_likely, most_promising, of_strokes};
use super::verdict::Verdict;
use super::workers::Workers;
use crate::delay::are_strokes;
use crate::diagnosis::compare_knowing;
use crate::fit::{Fit, FitRecord};

/// Adds what is missing from the model of `fit`, one effect after the other.
///
/// Where that ends far from the noise, the search starts anew from the usual
/// structures of such joints, and the more likely end counts: `done` then sees the first
/// revision once more.
///
/// After each effect, those that were added before and have become useless are removed. At the
/// end, unless [`Options::keeps_refinements`], those without practical consequence go, too: see
/// [`Attribution`]. `done` is called with each revision; where it says no, nothing more is tried.
pub fn improve(
    record: &FitRecord<'_>,
    fit: Fit,
    options: &Options,
    workers: &impl Workers,
    mut done: impl FnMut(&Revision) -> bool,
) -> Improvement {
    let options = &*options.of(record.joint());
    let start = FitOutcome::of(record, fit.clone());
    let given = ids(&start.model);
    let first = Step::new(record, Change::Start, fit);
    let mut revisions = Vec::new();
    let mut visit = |step: &Step| {
        let Step { change, fit, lack_of_fit, mut ranking, .. } = step.clone();
        separate(record, &mut ranking, workers);
        let comparison = compare_knowing(record, fit, lack_of_fit);
        let revision = Revision { change, comparison, ranking: in_order(ranking) };
        let goes_on = done(&revision);
        if step.change == Change::Start {
            revisions.clear();
        }
        if let Some(before) = revisions.last_mut().filter(|_| !options.keeps_series) {
            Revision::drop_series(before);
        }
        revisions.push(revision);
        goes_on
    };
    let misfit = Misfit::of(record, &start.errors);
    let makes_strokes = are_strokes(&record.joint().trials);
    let begin = first.clone();
    let usual =
        if makes_strokes { of_strokes(record, &first, options, misfit) } else { Vec::new() };
    let mut last = first;
    for next in usual {
        if !visit(&last) {
            let attribution = Attribution::default();
            return Improvement { revisions, verdict: Verdict::MissingEffect, attribution };
        }
        last = next;
    }
    let mut ended = add_stepwise(record, last, &given, options, workers, misfit, &mut visit);
    let is_far = misfit.is_far_from_noise(&Errors::of(record, &ended.fit));
    if !makes_strokes && is_far && !ended.was_stopped {
        /// Effects that are added to a structure, at most: what it has is most of what there is.
        const MORE: usize = 3;
        let mut steps = most_promising(record, &begin, options, misfit, workers);
        if let Some(start) = steps.pop() {
            let mut later = Vec::new();
            let mut keep = |step: &Step| {
                later.push(step.clone());
                true
            };
            let max_effects = options.max_effects.min(steps.len() + 1 + MORE);
            let options = &Options { max_effects, ..options.clone() };
            let other = add_stepwise(record, start, &given, options, workers, misfit, &mut keep);
            if is_more_likely(record, &other.fit, &ended.fit) {
                let mut all = std::iter::once(begin).chain(steps).chain(later);
                ended = Ended { was_stopped: !all.all(|step| visit(&step)), ..other };
            }
        }
    }
    let verdict = ended.verdict;
    let attribution = if ended.was_stopped {
        Attribution::default()
    } else {
        let grown = Grown { record, first: &start, whole: &ended.fit, misfit, options };
        attributed(&grown, ended.refinements, workers, visit)
    };
    Improvement { revisions, verdict, attribution }
}

/// What each effect of the whole model carries, without those of no consequence, which are removed
/// one after the other, the least first, and join the `refinements`, and with those in whose place a
/// simpler one leaves as little exchanged for it. `visit` sees each model on the way.
fn attributed(
    all: &Grown<'_, '_>,
    mut refinements: Vec<&'static str>,
    workers: &impl Workers,
    mut visit: impl FnMut(&Step) -> bool,
) -> Attribution {
    let mut whole = all.whole.clone();
    loop {
        let grown = Grown { whole: &whole, ..*all };
        let mut left_out = grown.left_out(workers);
        let may_go = |least: &LeftOut| !all.options.keeps_refinements && grown.is_refinement(least);
        // The least comes last.
        let least = left_out.iter().rposition(may_go).map(|index| left_out.remove(index));
        let changes = if let Some(least) = least {
            refinements.push(least.effect);
            vec![(Change::Removed(least.effect), least.fit)]
        } else {
            let exchanged = grown.exchanged(&left_out, workers);
            let changes = grown.simplified(&exchanged, workers);
            if changes.is_empty() {
                return grown.attribution_of(&left_out, &exchanged, refinements);
            }
            changes
        };
        for (change, fit) in changes {
            let fit = fit.on(all.record);
            if !visit(&Step::new(all.record, change, fit.clone())) {
                return Attribution::default();
            }
            whole = fit;
        }
    }
}
