//! Explain and add, until nothing significant is missing.

use super::attribution::{Grown, LeftOut};
use super::contribution::Attribution;
use super::decide::in_order;
use super::exchange::{Exchange, is_free_form};
use super::extension::ids;
use super::judgement::Refusal;
use super::misfit::{Errors, Misfit};
use super::options::Options;
use super::outcome::FitOutcome;
use super::revision::{Change, Improvement, Revision};
use super::separate::separate;
use super::stepwise::{Ended, Step, add_stepwise, steps_to};
use super::structures::{is_more_likely, most_promising, of_strokes};
use super::verdict::Verdict;
use super::workers::Workers;
use crate::delay::are_strokes;
use crate::diagnosis::compare_knowing;
use crate::fit::{Fit, FitRecord, fit_to_compare};

/// Adds what is missing from the model of `fit`, one effect after the other.
///
/// Where that ends far from the noise, the search starts anew from the usual
/// structures of such joints, and the more likely end counts: `done` then sees the first
/// revision once more. Where it ends with a curve of any form, effects with a law are sought in its place.
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
        if makes_strokes { of_strokes(record, &first.fit, options, misfit) } else { Vec::new() };
    let mut last = first;
    for (change, fit) in usual {
        if !visit(&last) {
            let attribution = Attribution::default();
            return Improvement { revisions, verdict: Verdict::MissingEffect, attribution };
        }
        last = Step::new(record, change, fit);
    }
    let mut ended = add_stepwise(record, last, &given, options, workers, misfit, &mut visit);
    let again = Restart { record, begin, given: &given, options, misfit, workers };
    let mut turn_to = |ended: &mut Ended, (steps, other): (Vec<Step>, Ended)| {
        *ended = Ended { was_stopped: !steps.iter().all(&mut visit), ..other };
    };
    let is_far = misfit.is_far_from_noise(&Errors::of(record, &ended.fit));
    if !makes_strokes
        && is_far
        && !ended.was_stopped
        && let Some(other) = again.by_structures(&ended)
    {
        turn_to(&mut ended, other);
    }
    if !ended.was_stopped
        && let Some(other) = again.by_laws(&ended)
    {
        turn_to(&mut ended, other);
    }
    let verdict = ended.verdict;
    let attribution = if ended.was_stopped {
        Attribution::default()
    } else {
        let grown = Grown { record, first: &start, whole: &ended.fit, misfit, options };
        attributed(&grown, ended.refinements, workers, visit)
    };
    credible(Improvement { revisions, verdict, attribution })
}

/// `found`, unexplained where as many effects as may be added were, and each of them may only imitate one
/// from outside the catalogue: the next one would, too.
fn credible(mut found: Improvement) -> Improvement {
    if found.verdict == Verdict::MissingEffect && found.attribution.is_doubtful_throughout() {
        found.verdict = Verdict::Unexplained;
        let last = found.revisions.iter_mut().rfind(|revision| !revision.ranking.is_empty());
        let next = last.into_iter().flat_map(|revision| &mut revision.ranking);
        for one in next.filter(|one| one.judgement.is_added()) {
            one.judgement.refusal = Some(Refusal::NotTheWhole);
        }
    }
    found
}

/// A search that starts anew from elsewhere; its steps are those from the first model on.
struct Restart<'a, 'r, W> {
    record: &'a FitRecord<'r>,
    begin: Step,
    given: &'a [&'static str],
    options: &'a Options,
    misfit: Misfit,
    workers: &'a W,
}

impl<W: Workers> Restart<'_, '_, W> {
    /// From the most promising of the usual structures; its steps, and where it ends, where that is more
    /// likely than where a search `ended`.
    fn by_structures(&self, ended: &Ended) -> Option<(Vec<Step>, Ended)> {
        /// Effects that are added to a structure, at most: what it has is most of what there is.
        const MORE: usize = 3;
        let Self { record, options, misfit, workers, .. } = *self;
        let structure = most_promising(record, &self.begin.fit, options, misfit, workers);
        let step = |(change, fit)| Step::new(record, change, fit);
        let mut steps: Vec<Step> = structure.into_iter().map(step).collect();
        let start = steps.pop()?;
        let max_effects = options.max_effects.min(steps.len() + 1 + MORE);
        steps.insert(0, self.begin.clone());
        let other = self.started(steps, start, &Options { max_effects, ..options.clone() });
        is_more_likely(record, &other.1.fit, &ended.fit).then_some(other)
    }

    /// From the model in which a search `ended` without its curve of any form, by effects with a law alone;
    /// its steps, and where it ends, where the curve is not more likely than that.
    fn by_laws(&self, ended: &Ended) -> Option<(Vec<Step>, Ended)> {
        let added = ids(&ended.fit.model).into_iter().filter(|id| !self.given.contains(id));
        let curve = added.into_iter().find(|id| is_free_form(id))?;
        let model = ended.fit.model.without(curve);
        let fit = fit_to_compare(self.record, &model, &self.record.range_for(&model)).ok()?;
        let mut lawful = self.options.clone();
        lawful.effects.retain(|effect| !effect.spec().is_free_form);
        let others = ids(&model).into_iter().filter(|id| !self.given.contains(id));
        let changes: Vec<Change> = others.map(Change::Added).collect();
        let (mut steps, mut start) = steps_to(self.record, &self.begin.fit.model, &changes, fit);
        if changes.is_empty() {
            start = self.begin.clone();
        } else {
            steps.insert(0, self.begin.clone());
        }
        let other = self.started(steps, start, &lawful);
        (!is_more_likely(self.record, &ended.fit, &other.1.fit)).then_some(other)
    }

    /// `steps` and those from `start` on, and where these end.
    fn started(&self, mut steps: Vec<Step>, start: Step, options: &Options) -> (Vec<Step>, Ended) {
        let Self { record, given, misfit, workers, .. } = *self;
        let keep = |step: &Step| {
            steps.push(step.clone());
            true
        };
        let ended = add_stepwise(record, start, given, options, workers, misfit, keep);
        (steps, ended)
    }
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
        let exchanges = if let Some(least) = least {
            refinements.push(least.effect);
            vec![(Exchange::alone(Change::Removed(least.effect)), least.fit)]
        } else {
            let exchanged = grown.exchanged(&left_out, workers);
            let exchanges = grown.simplified(&exchanged, workers);
            if exchanges.is_empty() {
                return grown.attribution_of(&left_out, &exchanged, refinements);
            }
            exchanges
        };
        for (exchange, fit) in exchanges {
            let fit = fit.on(all.record);
            let (between, last) = steps_to(all.record, &whole.model, &exchange.0, fit.clone());
            if !between.iter().chain([&last]).all(&mut visit) {
                return Attribution::default();
            }
            whole = fit;
        }
    }
}
