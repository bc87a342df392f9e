//! What can be removed from a model, or exchanged, after an effect was added.

use super::candidate::ALIKE;
use super::eligible::{could_be_missing, is_due, signal_range};
use super::evidence::NoiseMemory;
use super::extension::ids;
use super::misfit::{Errors, Misfit};
use super::options::Options;
use super::outcome::FitOutcome;
use super::revision::Change;
use super::screening::fit_best;
use super::workers::Workers;
use crate::effect::{Effect, Spec, by_id};
use crate::fit::{Fit, FitRecord, survey};
use crate::model::{Component, JointModel};

/// The p-value below which windows show that a change does harm, whatever the criterion says.
/// Chosen: the usual 1 %.
const HARM: f64 = 0.01;

/// What the cost of a changed model may be after its survey, in parts of the whole model's.
/// Chosen: what is worse by more does not become better by a fit.
const WORSE: f64 = 1.3;

/// What the cost with two effects in the place of one, or with a finer form of one, must be in parts
/// of the cost without, whatever the criterion says, which is less sure where more is missing. Chosen:
/// 2 % of the error, as a single effect has to explain.
const LESS: f64 = 0.96;

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

/// A change of one effect, with a further effect that is then added or without.
#[derive(Clone, Copy, Debug)]
pub(super) struct Exchange {
    pub(super) change: Change,
    pub(super) then: Option<&'static str>,
}

impl Exchange {
    fn alone(change: Change) -> Self {
        Self { change, then: None }
    }

    /// Whether it brings two effects for one, or a finer form of one: what is as likely keeps its usual
    /// name.
    fn is_unusual(self) -> bool {
        let is_finer = match self.change {
            Change::Replaced { new, .. } => {
                by_id(new).is_some_and(|new| new.spec().refines.is_some())
            }
            _ => false,
        };
        is_finer || self.then.is_some()
    }

    /// `model` after it.
    fn applied(self, model: &JointModel) -> Option<JointModel> {
        let model = changed(model, self.change)?;
        self.then.map_or_else(|| Some(model.clone()), |id| changed(&model, Change::Added(id)))
    }
}

impl Removal<'_> {
    /// A model that is as likely without one of the effects of `whole`, or more with one other
    /// or two in the place of one.
    pub(super) fn better(
        &mut self,
        record: &FitRecord<'_>,
        whole: &Fit,
        workers: &impl Workers,
    ) -> Option<(Exchange, Fit)> {
        let exchanges = self.changes(record, &whole.model);
        let with = |exchange: &Exchange| Some((*exchange, exchange.applied(&whole.model)?));
        let models: Vec<_> = exchanges.iter().filter_map(with).collect();
        let tried = fitted_after(record, whole, &models, workers);
        let noise = NoiseMemory::of(record, whole);
        let own = Errors::of(record, whole);
        let of_whole = noise.evidence(record, whole);
        let judged = tried.into_iter().filter_map(|(change, fit)| {
            let evidence = noise.evidence(record, &fit.on(record));
            let does_harm = of_whole.is_nearer_over_windows(&evidence, HARM)
                || !self.misfit.generalizes(own, fit.errors);
            // More parameters in the place of an effect are worth as much as a further effect.
            let is_worth_it = fit.parameters.len() <= whole.parameters.len()
                || self.options.keeps_refinements
                || self.misfit.has_consequence(own, fit.errors);
            let behind = evidence.criterion() - of_whole.criterion();
            let leaves_less = !change.is_unusual() || fit.cost < LESS * whole.cost;
            let hurdle = if change.is_unusual() { ALIKE } else { 0.0 };
            (behind < -hurdle && leaves_less && !does_harm && is_worth_it)
                .then_some((behind, (change, fit)))
        });
        let (_, better) = judged.min_by(|a, b| a.0.total_cmp(&b.0))?;
        if let Change::Replaced { new, .. } = better.0.change {
            self.kept.extend([Some(new), better.0.then].into_iter().flatten());
        }
        let (exchange, fit) = better;
        Some((exchange, fit.on(record)))
    }

    /// Removals of effects that may go, and exchanges for those that look like them.
    ///
    /// The effect that was chosen last was chosen among all single ones, but not among pairs.
    fn changes(&self, record: &FitRecord<'_>, model: &JointModel) -> Vec<Exchange> {
        let was_added = |id: &&'static str| !self.given.contains(id);
        let may_go = |id: &&'static str| was_added(id) && !self.kept.contains(id);
        let others = |old: &'static str| replacements(record, model, old, self.options);
        let added: Vec<&'static str> = ids(model).into_iter().filter(was_added).collect();
        let old: Vec<&'static str> = added.iter().copied().filter(may_go).collect();
        let removals = old.iter().map(|id| Change::Removed(id));
        let single = removals.chain(old.iter().flat_map(|old| others(old))).map(Exchange::alone);
        let of_two = added.iter().flat_map(|old| by_two(record, model, old, self.options));
        single.chain(of_two).collect()
    }
}

/// The exchanges of `old` for two effects that look like it together.
fn by_two(
    record: &FitRecord<'_>,
    model: &JointModel,
    old: &'static str,
    options: &Options,
) -> Vec<Exchange> {
    let rest = model.without(old);
    let is_able = |id: &&str| {
        let effect = options.effects.iter().find(|effect| effect.spec().id == *id);
        effect.is_some_and(|effect| could_be_missing(record, &rest, *effect))
    };
    let pairs = by_id(old).map_or(&[][..], |effect| effect.spec().looks_like_both).iter();
    let exchange = |[new, then]: &[&'static str; 2]| Exchange {
        change: Change::Replaced { old, new },
        then: Some(*then),
    };
    pairs.filter(|both| both.iter().all(is_able)).map(exchange).collect()
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
        let spec = effect.spec();
        could_be_missing(record, &rest, **effect)
            && (is_due(&rest, spec, options) || is_as_simple_a_form(spec, old))
    });
    let replaced = |effect: &&'static dyn Effect| Change::Replaced { old, new: effect.spec().id };
    able.map(replaced).collect()
}

/// Whether an effect is a finer form of `old` that needs no more parameters.
fn is_as_simple_a_form(of: &Spec, old: &str) -> bool {
    let parameters = by_id(old).map(|old| old.spec().parameters.len());
    of.refines == Some(old) && parameters == Some(of.parameters.len())
}

/// Whether one effect is taken for the other, or contains it.
fn looks_like(one: &str, other: &str) -> bool {
    let near = |a: &str, b: &str| {
        let spec = by_id(a).map(Effect::spec);
        spec.is_some_and(|spec| spec.confused_with.contains(&b) || spec.absorbs.contains(&b))
    };
    one != other && (near(one, other) || near(other, one))
}

/// The models with the best few of `changes`.
pub(super) fn fitted_with(
    record: &FitRecord<'_>,
    whole: &Fit,
    changes: &[Change],
    workers: &impl Workers,
) -> Vec<(Change, FitOutcome)> {
    let with = |change: &Change| Some((*change, changed(&whole.model, *change)?));
    let models: Vec<_> = changes.iter().filter_map(with).collect();
    fitted_after(record, whole, &models, workers)
}

/// The best few of the `models` that came of `whole`, of those that a survey does not rule out,
/// fitted.
fn fitted_after<K: Copy + Send + Sync>(
    record: &FitRecord<'_>,
    whole: &Fit,
    models: &[(K, JointModel)],
    workers: &impl Workers,
) -> Vec<(K, FitOutcome)> {
    if models.is_empty() {
        return Vec::new();
    }
    let levels = record.input_levels();
    let range = signal_range(record, &whole.model, &levels);
    let thinned = record.thinned();
    let Ok(of_whole) = survey(&thinned, &whole.model, &range) else { return Vec::new() };
    let kept = |costs: &[f64]| {
        costs.iter().filter(|cost| **cost < WORSE * of_whole.cost).count().min(FINALISTS)
    };
    fit_best(record, &thinned, models, &range, kept, workers)
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
