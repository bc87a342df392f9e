//! Usual structures of hydraulic joints, from which a search starts where one effect after the other
//! does not come near the noise.
//!
//! A single effect may only show once several others are there, and the one that explains most by
//! itself is then a stand-in for several. What an engineer would try instead is data here: the valve
//! with its overlap, limit and directions; the same with a spool that slews or lags before them, or
//! sticks; and the linkage and weight of an arm behind it.
//!
//! # References
//! Merritt, H. E., 1967, Hydraulic Control Systems (valves and cylinders); Jelali, M., and Kroll, A.,
//! 2003, Hydraulic Servo-systems (spools); Koivo, A. J., 1994, Journal of Aerospace Engineering 7
//! (linkages of excavators).

use super::eligible::could_be_missing;
use super::evidence::NoiseMemory;
use super::misfit::{Errors, Misfit, generalizes};
use super::options::Options;
use super::revision::Change;
use super::stepwise::Step;
use super::workers::Workers;
use crate::effect::{
    ActuatorLag, DeadBand, DirectionGain, Effect, GravityLoad, InputSaturation, PositionGain,
    SpoolLag, SpoolRateLimit, Stiction, ValveHysteresis,
};
use crate::fit::{Fit, FitRecord, fit_to_compare, survey};
use crate::model::{Component, JointModel};

/// The structures, each in the order in which its effects are added.
const STRUCTURES: [&[&'static dyn Effect]; 6] = [
    &[&DeadBand, &DirectionGain, &InputSaturation],
    &[&DeadBand, &DirectionGain, &InputSaturation, &SpoolRateLimit],
    &[&DeadBand, &DirectionGain, &InputSaturation, &SpoolLag],
    &[&ValveHysteresis, &DeadBand, &DirectionGain, &ActuatorLag],
    &[&Stiction, &DirectionGain, &InputSaturation],
    &[&DeadBand, &DirectionGain, &PositionGain, &GravityLoad],
];

/// The steps from `first` to the structure that a survey finds most promising, each effect added where
/// it predicts what was not fitted no worse; none where no structure is allowed or gains anything.
pub(super) fn structured(
    record: &FitRecord<'_>,
    first: &Step,
    options: &Options,
    misfit: Misfit,
    workers: &impl Workers,
) -> Vec<Step> {
    let allowed = STRUCTURES.map(|structure| {
        let is_allowed = |effect: &&&'static dyn Effect| {
            let id = effect.spec().id;
            options.effects.iter().any(|known| known.spec().id == id)
                && could_be_missing(record, &first.fit.model, **effect)
        };
        let allowed = structure.iter().filter(is_allowed).copied();
        allowed.take(options.max_effects).collect::<Vec<_>>()
    });
    let surveyed = workers.map(&allowed, |effects| surveyed(record, &first.fit.model, effects));
    let costs =
        surveyed.into_iter().zip(allowed).filter_map(|(cost, effects)| Some((cost?, effects)));
    let best = costs.min_by(|a, b| a.0.total_cmp(&b.0));
    best.map_or_else(Vec::new, |(_, effects)| climbed(record, first, &effects, misfit))
}

/// The cost of `model` with all of `effects`, surveyed one after the other.
fn surveyed(
    record: &FitRecord<'_>,
    model: &JointModel,
    effects: &[&'static dyn Effect],
) -> Option<f64> {
    let range = record.range_for(model);
    let mut found = survey(record, model, &range).ok()?;
    for effect in effects {
        let with = found.model.with(Component::neutral(*effect));
        let better = survey(record, &with, &range).ok();
        found = better.filter(|better| better.cost < found.cost).unwrap_or(found);
    }
    Some(found.cost)
}

/// The steps from `first` on, an effect each.
fn climbed(
    record: &FitRecord<'_>,
    first: &Step,
    effects: &[&'static dyn Effect],
    misfit: Misfit,
) -> Vec<Step> {
    let mut fit = first.fit.clone();
    let mut steps = Vec::new();
    for effect in effects {
        let with = fit.model.with(Component::neutral(*effect));
        let Ok(next) = fit_to_compare(record, &with, &record.range_for(&with)) else { continue };
        let (before, after) = (Errors::of(record, &fit), Errors::of(record, &next));
        if generalizes(before, after) && misfit.has_consequence(before, after) {
            let change = Change::between(&fit.model, &next.model, effect.spec().id);
            steps.push(Step::new(record, change, next.clone()));
            fit = next;
        }
    }
    steps
}

/// Whether `one` is clearly more likely than `other`.
pub(super) fn is_more_likely(record: &FitRecord<'_>, one: &Fit, other: &Fit) -> bool {
    let noise = NoiseMemory::of(record, if one.cost < other.cost { one } else { other });
    let criterion = |fit| noise.evidence(record, fit).criterion();
    criterion(one) + super::candidate::ALIKE < criterion(other)
}
