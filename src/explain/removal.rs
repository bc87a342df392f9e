//! What can be removed from a model, or exchanged, after an effect was added.

use super::eligible::{could_be_missing, is_due, signal_range};
use super::evidence::NoiseMemory;
use super::extension::ids;
use super::misfit::Misfit;
use super::options::Options;
use super::revision::Change;
use super::screening::fit_best;
use super::workers::Workers;
use crate::effect::{Effect, by_id};
use crate::fit::{Fit, FitRecord, survey};
use crate::model::{Component, JointModel};

/// The p-value below which windows show that a change does harm, whatever the criterion says.
/// Chosen: the usual 1 %.
const HARM: f64 = 0.01;

/// What the cost of a changed model may be after its survey, in parts of the whole model's.
/// Chosen: what is worse by more does not become better by a fit.
const WORSE: f64 = 1.3;

/// Changes that are fitted, at most. Chosen: each more costs a fit.
const FINALISTS: usize = 6;

/// What may be made simpler or better of a model with a new effect.
pub(super) struct Removal<'a> {
    /// Effects that stay: those of the model that was given.
    pub(super) given: &'a [&'static str],
    /// Effects that stay: they were chosen with all others in the model.
    pub(super) kept: Vec<&'static str>,
    pub(super) options: &'a Options,
    pub(super) misfit: Misfit,
}

impl Removal<'_> {
    /// A model that is as likely without one of the effects of `whole`, or more with another
    /// in the place of one.
    pub(super) fn better(
        &mut self,
        record: &FitRecord<'_>,
        whole: &Fit,
        workers: &impl Workers,
    ) -> Option<(Change, Fit)> {
        let tried = fitted_after(record, whole, &self.changes(record, &whole.model), workers);
        let noise = NoiseMemory::of(record, whole);
        let of_whole = noise.evidence(record, whole);
        let judged = tried.into_iter().filter_map(|(change, fit)| {
            let evidence = noise.evidence(record, &fit);
            let does_harm = of_whole.p_value_over_windows(&evidence) < HARM
                || !self.misfit.generalizes(record, whole, &fit);
            let behind = evidence.criterion() - of_whole.criterion();
            (behind < 0.0 && !does_harm).then_some((behind, (change, fit)))
        });
        let (_, better) = judged.min_by(|a, b| a.0.total_cmp(&b.0))?;
        if let Change::Replaced { new, .. } = better.0 {
            self.kept.push(new);
        }
        Some(better)
    }

    /// Removals of effects that may go, and exchanges for those that look like them.
    fn changes(&self, record: &FitRecord<'_>, model: &JointModel) -> Vec<Change> {
        let may_go = |id: &&'static str| !self.given.contains(id) && !self.kept.contains(id);
        let others = |old: &'static str| replacements(record, model, old, self.options);
        let old: Vec<&'static str> = ids(model).into_iter().filter(may_go).collect();
        let removals = old.iter().map(|id| Change::Removed(id));
        removals.chain(old.iter().flat_map(|old| others(old))).collect()
    }
}

/// Exchanges of `old` for each effect that looks like it and could be in its place.
pub(super) fn replacements(
    record: &FitRecord<'_>,
    model: &JointModel,
    old: &'static str,
    options: &Options,
) -> Vec<Change> {
    let alike = options.effects.iter();
    let alike = alike.filter(move |effect| looks_like(old, effect.spec().id));
    let rest = model.without(old);
    let able = alike.filter(|effect| {
        could_be_missing(record, &rest, **effect) && is_due(&rest, effect.spec(), options)
    });
    let replaced = |effect: &&'static dyn Effect| Change::Replaced { old, new: effect.spec().id };
    able.map(replaced).collect()
}

/// Whether one effect is taken for the other, or contains it.
fn looks_like(one: &str, other: &str) -> bool {
    let near = |a: &str, b: &str| {
        let spec = by_id(a).map(Effect::spec);
        spec.is_some_and(|spec| spec.confused_with.contains(&b) || spec.absorbs.contains(&b))
    };
    one != other && (near(one, other) || near(other, one))
}

/// The models after the best few of `changes` that a survey does not rule out, fitted.
pub(super) fn fitted_after(
    record: &FitRecord<'_>,
    whole: &Fit,
    changes: &[Change],
    workers: &impl Workers,
) -> Vec<(Change, Fit)> {
    if changes.is_empty() {
        return Vec::new();
    }
    let levels = record.input_levels();
    let range = signal_range(record, &whole.model, &levels);
    let thinned = record.thinned();
    let Ok(of_whole) = survey(&thinned, &whole.model, &range) else { return Vec::new() };
    let with = |change: &Change| Some((*change, changed(&whole.model, *change)?));
    let models: Vec<_> = changes.iter().filter_map(with).collect();
    let kept = |costs: &[f64]| {
        costs.iter().filter(|cost| **cost < WORSE * of_whole.cost).count().min(FINALISTS)
    };
    fit_best(record, &thinned, &models, &range, kept, workers)
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
