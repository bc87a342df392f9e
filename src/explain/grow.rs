//! A model that grows effect by effect, until nothing significant is left.

use super::Workers;
use super::candidate::Candidate;
use super::evidence::Noise;
use super::race::{Field, Options, is_due, race, range, takes_part};
use super::verdict::Verdict;
use crate::diagnosis::{LackOfFit, floor_of, lack_of};
use crate::effect::{Effect, by_id};
use crate::fit::{Fit, FitRecord, Survey, fit_to_compare, survey};
use crate::model::{Component, JointModel};

/// What a revision changed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Change {
    /// Nothing: the model as it was given.
    Start,
    /// An effect was added.
    Added(&'static str),
    /// An effect that others made useless was removed.
    Removed(&'static str),
    /// An effect gave way to one that does the same better, now that others are there.
    Replaced {
        /// What was removed.
        old: &'static str,
        /// What was added.
        new: &'static str,
    },
}

/// A model on the way.
#[derive(Clone, Debug)]
pub(super) struct Step {
    pub(super) change: Change,
    pub(super) fit: Fit,
    pub(super) lack_of_fit: Option<LackOfFit>,
    /// The candidates for what comes next, best first; none where none was looked for.
    pub(super) ranking: Vec<Candidate>,
}

impl Step {
    pub(super) fn new(record: &FitRecord<'_>, change: Change, fit: Fit) -> Self {
        Self { change, lack_of_fit: lack_of(record, &fit), fit, ranking: Vec::new() }
    }

    /// Whether no lack of fit is shown.
    pub(super) fn is_adequate(&self) -> bool {
        self.lack_of_fit.is_none_or(|test| test.adequate)
    }

    /// Whether there is nothing to look for: the residual is hardly more than the noise.
    fn is_at_the_end(&self) -> bool {
        self.lack_of_fit.is_none_or(|test| test.adequate && test.is_near_noise())
    }

    /// Looks for what is missing, where that is not done; whether anything is. The first of
    /// the ranking is then one that is significant, if any is.
    ///
    /// A model that passes the test lacks something still when an effect shows it beyond
    /// doubt: the test knows shapes, the effects know physics.
    pub(super) fn look(
        &mut self,
        record: &FitRecord<'_>,
        options: &Options,
        workers: &impl Workers,
    ) -> bool {
        if self.is_at_the_end() {
            return false;
        }
        if self.ranking.is_empty() {
            let floor = floor_of(record, &self.fit).unwrap_or(0.0);
            let field = if self.is_adequate() { Field::OneByOne } else { Field::All };
            self.ranking = race(record, &self.fit, floor, options, field, workers);
        }
        let lacks = !self.is_adequate() || self.ranking.iter().any(Candidate::is_beyond_doubt);
        match self.ranking.iter().position(Candidate::is_significant) {
            _ if !lacks => self.ranking.clear(),
            Some(place) => put_first(&mut self.ranking, place),
            None => {}
        }
        lacks
    }
}

/// Adds to `first` what it lacks, one effect after the other, and removes what has become
/// useless. `visit` sees each step once; where it says no, nothing more is tried.
///
/// Effects of `given` stay.
pub(super) fn grow(
    record: &FitRecord<'_>,
    first: Step,
    given: &[&'static str],
    options: &Options,
    workers: &impl Workers,
    mut visit: impl FnMut(&Step) -> bool,
) -> Verdict {
    let mut step = first;
    loop {
        if !step.look(record, options, workers) {
            visit(&step);
            return Verdict::Adequate;
        }
        let found = step.ranking.first().filter(|best| best.is_significant()).cloned();
        let explained = found.is_some();
        let added = ids(&step.fit.model).len().saturating_sub(given.len());
        let goes_on = visit(&step) && added < options.max_effects;
        let Some(found) = found.filter(|_| goes_on) else {
            return if explained { Verdict::MissingEffect } else { Verdict::Unexplained };
        };
        if let Some(alone) = first_of_several(record, &found) {
            step = alone;
            if !visit(&step) {
                return Verdict::MissingEffect;
            }
        }
        let newest = found.effects.last().copied().unwrap_or_default();
        step = Step::new(record, Change::Added(newest), found.fit);
        let mut tidying = Tidying { given, settled: found.effects, options };
        while let Some((change, fit)) = tidying.better(record, &step.fit, workers) {
            if !visit(&step) {
                return if step.is_adequate() { Verdict::Adequate } else { Verdict::MissingEffect };
            }
            step = Step::new(record, change, fit);
        }
    }
}

/// The model with the first effect of a pair alone: a step on the way, which need not be better.
fn first_of_several(record: &FitRecord<'_>, found: &Candidate) -> Option<Step> {
    let [first, second] = found.effects.as_slice() else { return None };
    let model = found.fit.model.without(second);
    let levels = record.input_levels();
    let fit = fit_to_compare(record, &model, &range(record, &model, &levels)).ok()?;
    Some(Step::new(record, Change::Added(first), fit))
}

/// Moves the candidate at `place` to the front.
pub(super) fn put_first(ranking: &mut [Candidate], place: usize) {
    if let Some(front) = ranking.get_mut(..=place) {
        front.rotate_right(1);
    }
}

/// What may be made simpler or better of a model that grew.
struct Tidying<'a> {
    /// Effects that stay.
    given: &'a [&'static str],
    /// Effects that were chosen with all others in sight.
    settled: Vec<&'static str>,
    options: &'a Options,
}

impl Tidying<'_> {
    /// A model that is as likely without one of the effects of `whole`, or more with another
    /// in the place of one.
    fn better(
        &mut self,
        record: &FitRecord<'_>,
        whole: &Fit,
        workers: &impl Workers,
    ) -> Option<(Change, Fit)> {
        /// Probability below which windows show that a change does harm, whatever the criterion
        /// says.
        const HARM: f64 = 0.01;
        let tried = promising(record, whole, &self.changes(record, &whole.model), workers);
        let noise = Noise::of(record, whole);
        let of_whole = noise.evidence(record, whole);
        let judged = tried.into_iter().filter_map(|(change, fit)| {
            let evidence = noise.evidence(record, &fit);
            let does_harm = of_whole.over_windows(&evidence) < HARM;
            let behind = evidence.criterion() - of_whole.criterion();
            (behind < 0.0 && !does_harm).then_some((behind, (change, fit)))
        });
        let (_, better) = judged.min_by(|a, b| a.0.total_cmp(&b.0))?;
        if let Change::Replaced { new, .. } = better.0 {
            self.settled.push(new);
        }
        Some(better)
    }

    /// Removals of effects that may go, and exchanges for those that look like them.
    fn changes(&self, record: &FitRecord<'_>, model: &JointModel) -> Vec<Change> {
        let may_go = |id: &&'static str| !self.given.contains(id) && !self.settled.contains(id);
        let others = |old: &'static str| {
            let effects = self.options.effects.iter().map(|effect| effect.spec());
            let alike = effects.filter(move |spec| looks_like(old, spec.id));
            let rest = model.without(old);
            let able = alike.filter(|spec| {
                takes_part(record, &rest, spec) && is_due(&rest, spec, self.options)
            });
            able.map(move |spec| Change::Replaced { old, new: spec.id }).collect::<Vec<_>>()
        };
        let old: Vec<&'static str> = ids(model).into_iter().filter(may_go).collect();
        let removals = old.iter().map(|id| Change::Removed(id));
        removals.chain(old.iter().flat_map(|old| others(old))).collect()
    }
}

/// Whether one effect is taken for the other, or contains it.
fn looks_like(one: &str, other: &str) -> bool {
    let near = |a: &str, b: &str| {
        let spec = by_id(a).map(Effect::spec);
        spec.is_some_and(|spec| spec.confused_with.contains(&b) || spec.absorbs.contains(&b))
    };
    one != other && (near(one, other) || near(other, one))
}

/// The models after the best few of `changes` that a glance does not rule out, fitted.
fn promising(
    record: &FitRecord<'_>,
    whole: &Fit,
    changes: &[Change],
    workers: &impl Workers,
) -> Vec<(Change, Fit)> {
    /// What the error may be after a glance, in parts of that of the whole model.
    const MOST: f64 = 1.3;
    /// Changes that are fitted.
    const FEW: usize = 6;
    if changes.is_empty() {
        return Vec::new();
    }
    let levels = record.input_levels();
    let range = range(record, &whole.model, &levels);
    let thinned = record.thinned();
    let Ok(of_whole) = survey(&thinned, &whole.model, &range) else { return Vec::new() };
    let glance = |change: &Change| {
        let found = survey(&thinned, &changed(&whole.model, *change)?, &range).ok()?;
        (found.cost < MOST * of_whole.cost).then_some((*change, found))
    };
    let mut glances: Vec<_> = workers.map(changes, glance).into_iter().flatten().collect();
    glances.sort_by(|a, b| a.1.cost.total_cmp(&b.1.cost));
    glances.truncate(FEW);
    let fit = |(change, found): &(Change, Survey)| {
        Some((*change, fit_to_compare(record, &found.model, &range).ok()?))
    };
    workers.map(&glances, fit).into_iter().flatten().collect()
}

/// `model` after a change.
fn changed(model: &JointModel, change: Change) -> Option<JointModel> {
    match change {
        Change::Start => Some(model.clone()),
        Change::Added(id) => Some(model.with(Component::neutral(by_id(id)?))),
        Change::Removed(id) => Some(model.without(id)),
        Change::Replaced { old, new } => {
            Some(model.without(old).with(Component::neutral(by_id(new)?)))
        }
    }
}

/// Ids of the effects of `model`.
pub(super) fn ids(model: &JointModel) -> Vec<&'static str> {
    model.components().iter().map(|component| component.effect().spec().id).collect()
}
