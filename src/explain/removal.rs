//! What can be removed from a model, or exchanged, after an effect was added.

use super::candidate::ALIKE;
use super::comparison::MUCH_LESS;
use super::decide::is_founded;
use super::eligible::{could_be_missing, is_as_simple_a_form, is_due};
use super::evidence::NoiseMemory;
use super::extension::{components_of, ids};
use super::likeness::looks_like;
use super::misfit::{Errors, Misfit, generalizes};
use super::options::Options;
use super::outcome::FitOutcome;
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

/// Changes that are made together: one, or that of an effect for two others, or of several for one.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Exchange(pub(super) Vec<Change>);

impl Exchange {
    fn alone(change: Change) -> Self {
        Self(vec![change])
    }

    /// Whether it brings two effects for one, or a finer form of one: what is as likely keeps its usual
    /// name.
    fn is_unusual(&self) -> bool {
        let new: Vec<_> = self.new_effects().collect();
        let is_finer = |id: &&str| by_id(id).is_some_and(|new| new.spec().refines.is_some());
        new.len() > 1 || new.iter().any(is_finer)
    }

    /// Whether it brings a curve of any form.
    fn has_free_form(&self) -> bool {
        self.new_effects().any(is_free_form)
    }

    /// Whether it brings laws in the place of a curve of any form.
    fn is_for_free_form(&self) -> bool {
        let mut changes = self.0.iter();
        changes.any(|change| matches!(change, Change::Replaced { old, .. } if is_free_form(old)))
    }

    /// The effects that it brings.
    fn new_effects(&self) -> impl Iterator<Item = &'static str> {
        self.0.iter().filter_map(|change| change.new_effect())
    }

    /// `model` after it, once for each start of what is new.
    fn applied(&self, model: &JointModel) -> Vec<JointModel> {
        let then = |models: Vec<JointModel>, change: &Change| {
            models.iter().flat_map(|model| changed(model, *change)).collect()
        };
        self.0.iter().fold(vec![model.clone()], then)
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
        let own = Errors::of(record, whole);
        let exchanges = self.changes(record, &whole.model);
        let with = |(index, exchange): (usize, &Exchange)| {
            exchange.applied(&whole.model).into_iter().map(move |model| (index, model))
        };
        let models: Vec<_> = exchanges.iter().enumerate().flat_map(with).collect();
        let tried = fitted_after(record, whole, &models, workers);
        let noise = NoiseMemory::of(record, whole);
        let of_whole = noise.evidence(record, whole);
        let judged = tried.into_iter().filter_map(|(index, fit)| {
            let exchange = &exchanges[index];
            let evidence = noise.evidence(record, &fit.on(record));
            let does_harm =
                of_whole.is_nearer_over_windows(&evidence, HARM) || !generalizes(&own, &fit.errors);
            // More parameters in the place of an effect are worth as much as a further effect.
            let is_worth_it = fit.parameters.len() <= whole.parameters.len()
                || self.options.keeps_refinements
                || self.misfit.has_consequence(&own, &fit.errors);
            // Two effects with fewer parameters than one are the simpler explanation.
            let is_unusual =
                exchange.is_unusual() && fit.parameters.len() >= whole.parameters.len();
            let leaves_less = if exchange.has_free_form() {
                fit.cost < MUCH_LESS * MUCH_LESS * whole.cost
            } else {
                !is_unusual || fit.cost < LESS * whole.cost
            };
            // Two in the place of one have to be ahead of the one, too.
            let hurdle = if is_unusual { ALIKE } else { 0.0 };
            let behind = evidence.criterion() - of_whole.criterion() + hurdle;
            let new: Vec<&str> = exchange.new_effects().collect();
            let is_founded = is_founded(record, &fit, &new, self.options);
            let is_better = behind < 0.0 && leaves_less && !does_harm && is_worth_it;
            // Laws need not be as likely as a curve of any form.
            let is_law = exchange.is_for_free_form()
                && fit.parameters.len() < whole.parameters.len()
                && !self.misfit.has_consequence(&fit.errors, &own);
            ((is_better || is_law) && is_founded).then_some((behind, (exchange, fit)))
        });
        let (_, (exchange, fit)) = judged.min_by(|a, b| a.0.total_cmp(&b.0))?;
        self.kept.extend(exchange.new_effects());
        Some((exchange.clone(), fit.on(record)))
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
        let of_all = in_place_of_all(record, model, &added, self.options);
        single.chain(of_two).chain(of_all).collect()
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
    let exchange = |[new, then]: &[&'static str; 2]| {
        Exchange(vec![Change::Replaced { old, new }, Change::Added(then)])
    };
    pairs.filter(|both| both.iter().all(is_able)).map(exchange).collect()
}

/// The exchanges of several of the `added` effects for one that looks like each of them: what one effect
/// does, several follow together that were added before it could show.
fn in_place_of_all(
    record: &FitRecord<'_>,
    model: &JointModel,
    added: &[&'static str],
    options: &Options,
) -> Vec<Exchange> {
    let exchange = |effect: &&'static dyn Effect| {
        let spec = effect.spec();
        let is_like = |id: &&&'static str| {
            let simple = spec.refines.and_then(by_id).map(Effect::spec);
            std::iter::once(spec).chain(simple).any(|form| {
                looks_like(form.id, id) || form.looks_like_both.iter().any(|two| two.contains(id))
            })
        };
        let (first, others) = match added.iter().filter(is_like).collect::<Vec<_>>()[..] {
            [first, ref others @ ..] if !others.is_empty() => (*first, others.to_vec()),
            _ => return None,
        };
        let rest = others.iter().fold(model.without(first), |rest, id| rest.without(id));
        let replaced = Change::Replaced { old: first, new: spec.id };
        // What the new effect contains goes with its arrival.
        let stay = others.into_iter().filter(|id| !spec.absorbs.contains(*id));
        let removed = stay.map(|id| Change::Removed(id));
        could_be_missing(record, &rest, *effect)
            .then(|| Exchange(std::iter::once(replaced).chain(removed).collect()))
    };
    options.effects.iter().filter_map(exchange).collect()
}

/// Exchanges of `old` for each effect that looks like it and could be in its place; of a curve of any form
/// for finer forms, too, whose simple one is not in the model.
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
            && !spec.is_free_form
            && (is_free_form(old) || is_due(&rest, spec, options) || is_as_simple_a_form(spec, old))
    });
    let replaced = |effect: &&'static dyn Effect| Change::Replaced { old, new: effect.spec().id };
    able.map(replaced).collect()
}

/// Whether an effect is a curve of any form.
pub(super) fn is_free_form(id: &str) -> bool {
    by_id(id).is_some_and(|effect| effect.spec().is_free_form)
}

/// The models with the best few of `changes`.
pub(super) fn fitted_with(
    record: &FitRecord<'_>,
    whole: &Fit,
    changes: &[Change],
    workers: &impl Workers,
) -> Vec<(Change, FitOutcome)> {
    let with = |change: &Change| {
        let change = *change;
        changed(&whole.model, change).into_iter().map(move |model| (change, model))
    };
    let models: Vec<_> = changes.iter().flat_map(with).collect();
    fitted_after(record, whole, &models, workers)
}

/// The best few of the `models` that came of `whole`, of those that a survey does not rule out,
/// fitted; of each change once.
fn fitted_after<K: Copy + PartialEq + Send + Sync>(
    record: &FitRecord<'_>,
    whole: &Fit,
    models: &[(K, JointModel)],
    workers: &impl Workers,
) -> Vec<(K, FitOutcome)> {
    if models.is_empty() {
        return Vec::new();
    }
    let range = record.range_for(&whole.model);
    let Ok(of_whole) = survey(record, &whole.model, &range) else { return Vec::new() };
    let kept = |costs: &[f64]| {
        costs.iter().filter(|cost| **cost < WORSE * of_whole.cost).count().min(FINALISTS)
    };
    fit_best(record, models, &range, kept, workers)
}

/// `model` after a change: with a new effect at its neutral values, and, in another's place, at those
/// that do what the other does.
pub(super) fn changed(model: &JointModel, change: Change) -> Vec<JointModel> {
    let neutral = |id| by_id(id).map(Component::neutral);
    let (rest, new) = match change {
        Change::Start => return vec![model.clone()],
        Change::Removed(id) => return vec![model.without(id)],
        Change::Added(id) => (model.clone(), vec![neutral(id)]),
        Change::Replaced { old, new } => {
            let alike = by_id(new).and_then(|new| {
                components_of(model, &[old]).next().and_then(|old| old.replaced_by(new))
            });
            (model.without(old), vec![neutral(new), alike])
        }
    };
    new.into_iter().flatten().flat_map(|component| rest.placements(&component)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effect::{DeadBand, DirectionGain, SpoolLag, ThermalDrift};
    use crate::experiment::{Joint, Trial};
    use crate::fit::{Horizon, Split};
    use crate::units::SamplePeriod;

    #[test]
    fn one_effect_is_tried_in_the_place_of_all_that_look_like_it() {
        let period = SamplePeriod::from_seconds(0.01).unwrap();
        let trial = Trial::new("1", 0.0, period, vec![0.0; 40], vec![0.0; 40]).unwrap();
        let joint = Joint::new("boom", vec![trial]);
        let record = FitRecord::new(&joint, Split::Trials, Horizon::FreeRun);
        let effects: [&'static dyn Effect; 4] =
            [&DeadBand, &SpoolLag, &ThermalDrift, &DirectionGain];
        let with = |model: JointModel, effect: &&'static dyn Effect| {
            model.with(Component::neutral(*effect))
        };
        let model = effects.iter().fold(JointModel::integrator(1.0, 0.1), with);
        let added = effects.map(|effect| effect.spec().id);
        let all = in_place_of_all(&record, &model, &added, &Options::default());
        let replaced = Change::Replaced { old: "dead_band", new: "asymmetric_friction" };
        let removed = ["spool_lag", "direction_gain"].map(Change::Removed);
        let exchange = Exchange([&[replaced][..], &removed].concat());
        assert!(all.contains(&exchange), "{all:?}");
        assert!(in_place_of_all(&record, &model, &["dead_band"], &Options::default()).is_empty());
        let models = exchange.applied(&model);
        let is_left = |model: &JointModel| {
            let mut left = ids(model);
            left.sort_unstable();
            left == ["asymmetric_friction", "thermal_drift"]
        };
        assert!(!models.is_empty() && models.iter().all(is_left));
    }
}
