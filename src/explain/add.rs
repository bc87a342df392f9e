//! One effect more in a model, because a user says so.

use super::attribution::Grown;
use super::comparison::MUCH_LESS;
use super::evidence::NoiseMemory;
use super::misfit::Misfit;
use super::options::Options;
use super::outcome::FitOutcome;
use super::revision::{AddError, Addition};
use super::workers::Workers;
use crate::diagnosis::{ErrorFigures, NEAR_NOISE, compare, sensor_noise};
use crate::effect::{Effect, RecordRange};
use crate::fit::{Fit, FitRecord, fit};
use crate::model::{Component, JointModel};

/// Fits the model of `base` with `effect`, which starts where it changes nothing.
///
/// # Errors
/// [`AddError`] when the model has the effect, or cannot be fitted with it.
pub fn add(
    record: &FitRecord<'_>,
    base: Fit,
    effect: &'static dyn Effect,
    workers: &impl Workers,
) -> Result<Addition, AddError> {
    check(&base.model, effect)?;
    let model = base.model.with(Component::neutral(effect));
    let range = record.range_for(&model);
    let by_law = fit(record, &model, &range)?;
    let by_law = as_first_order(record, &base, &range, effect)
        .filter(|other| other.cost < by_law.cost)
        .unwrap_or(by_law);
    let measured = of_measured_delays(record, &base, &by_law, effect);
    let measured = measured.and_then(|model| fit(record, &model, &range).ok());
    let costs_less = |other: &&Fit| other.cost < by_law.cost;
    let noise = NoiseMemory::of(record, measured.as_ref().filter(costs_less).unwrap_or(&by_law));
    let evidence = |fit: &Fit| noise.evidence(record, fit);
    let law = evidence(&by_law).criterion();
    let better = measured.filter(|measured| {
        evidence(measured).criterion() < law && measured.cost < MUCH_LESS * MUCH_LESS * by_law.cost
    });
    let with = better.unwrap_or(by_law);
    let p_value = evidence(&with).p_value_against(&evidence(&base));
    let options = Options::default();
    let first = FitOutcome::of(record, base.clone());
    let misfit = Misfit::of(record, &first.errors);
    let grown = Grown { record, first: &first, whole: &with, misfit, options: &options };
    let attribution = grown.attribution(workers);
    Ok(Addition {
        before: compare(record, base),
        after: compare(record, with),
        p_value: effect.nests().then_some(p_value),
        attribution,
    })
}

/// The model of `base` as the first order that the output follows, fitted, where `effect` is what
/// makes it one: too far from an integrator for a descent to find it.
fn as_first_order(
    record: &FitRecord<'_>,
    base: &Fit,
    range: &RecordRange<'_>,
    effect: &'static dyn Effect,
) -> Option<Fit> {
    let (effects, model) = record.follower()?.started_at(&base.model)?;
    if effects != [effect.spec().id] {
        return None;
    }
    fit(record, &model, range).ok()
}

/// The model of `base` with `effect` in the form that takes measured delays, where it has one
/// and its law does not come near the noise.
fn of_measured_delays(
    record: &FitRecord<'_>,
    base: &Fit,
    by_law: &Fit,
    effect: &'static dyn Effect,
) -> Option<JointModel> {
    let model = base.model.with(Component::measured(effect)?);
    let error = ErrorFigures::of_record(record, &by_law.evaluation)?.rmse;
    let is_near =
        sensor_noise(&record.measured().trials).is_some_and(|floor| error <= NEAR_NOISE * floor);
    (!is_near && record.measured_delays(&model) > 0).then_some(model)
}

fn check(model: &JointModel, effect: &'static dyn Effect) -> Result<(), AddError> {
    let effect = effect.spec().id;
    let mut specs = model.components().iter().map(|component| component.effect().spec());
    if specs.clone().any(|spec| spec.id == effect) {
        return Err(AddError::AlreadyThere { effect });
    }
    match specs.find(|spec| spec.absorbs.contains(&effect)) {
        Some(whole) => Err(AddError::Contained { effect, whole: whole.id }),
        None => Ok(()),
    }
}
