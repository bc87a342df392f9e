//! Usual structures of hydraulic joints, from which a search starts.
//!
//! A single effect may only show once several others are there, and the one that explains most by
//! itself is then a stand-in for several. What an engineer would try instead is data here.
//!
//! In a stroke between stops the input has one level, and the joint runs over its whole way. So few
//! levels are matched by many curves, and errors are far beyond the noise, where every effect is
//! significant: there a search starts from what the oil meets, in its order: the overlap of the valve
//! and its largest flow, the areas of the cylinder, its ends; then the linkage, and the largest flow of
//! each direction. Elsewhere it starts so where one effect after the other does not come near the noise:
//! from the valve with its overlap, limit and directions; the same with a spool that slews or lags before
//! them, or sticks; or with the linkage and weight of an arm after it.
//!
//! # References
//! Merritt, H. E., 1967, Hydraulic Control Systems (valves and cylinders); Jelali, M., and Kroll, A.,
//! 2003, Hydraulic Servo-systems (spools); Koivo, A. J., 1994, Journal of Aerospace Engineering 7
//! (linkages of excavators).

use super::candidate::ALIKE;
use super::eligible::{could_be_missing, is_due};
use super::evidence::NoiseMemory;
use super::misfit::{Errors, Misfit, generalizes};
use super::options::Options;
use super::revision::Change;
use super::workers::Workers;
use crate::effect::{
    ActuatorLag, AsymmetricSaturation, DeadBand, DirectionGain, Effect, EndStop, GravityLoad,
    InputSaturation, PositionGain, SpoolLag, SpoolRateLimit, Stiction, ValveHysteresis,
};
use crate::fit::{Fit, FitRecord, fit_to_compare, survey};
use crate::model::{Component, JointModel};

/// Effects in the order in which they are added.
type Structure = &'static [&'static dyn Effect];

/// That of a joint that makes strokes.
const OF_STROKES: Structure =
    &[&DeadBand, &InputSaturation, &DirectionGain, &EndStop, &PositionGain, &AsymmetricSaturation];

/// Those of other joints.
const STRUCTURES: [Structure; 6] = [
    &[&DeadBand, &DirectionGain, &InputSaturation],
    &[&DeadBand, &DirectionGain, &InputSaturation, &SpoolRateLimit],
    &[&DeadBand, &DirectionGain, &InputSaturation, &SpoolLag],
    &[&ValveHysteresis, &DeadBand, &DirectionGain, &ActuatorLag],
    &[&Stiction, &DirectionGain, &InputSaturation],
    &[&DeadBand, &DirectionGain, &PositionGain, &GravityLoad],
];

/// Whether a joint that makes strokes usually has the effect.
pub(super) fn is_usual_of_strokes(id: &&'static str) -> bool {
    OF_STROKES.iter().any(|effect| effect.spec().id == *id)
}

/// The changes that make of the model of `first` that of a joint that makes strokes, each with its fit; none
/// where fewer effects may be added than that has: of a few the best are wanted, not the usual ones.
pub(super) fn of_strokes(
    record: &FitRecord<'_>,
    first: &Fit,
    options: &Options,
    misfit: Misfit,
) -> Vec<(Change, Fit)> {
    // A limit by direction takes the place of one for both.
    if options.max_effects + 1 < OF_STROKES.len() {
        return Vec::new();
    }
    climbed(record, first, OF_STROKES, options, misfit)
}

/// The changes that make of the model of `first` the structure that a survey finds most promising, each with
/// its fit.
pub(super) fn most_promising(
    record: &FitRecord<'_>,
    first: &Fit,
    options: &Options,
    misfit: Misfit,
    workers: &impl Workers,
) -> Vec<(Change, Fit)> {
    let costs =
        workers.map(&STRUCTURES, |structure| surveyed(record, &first.model, structure, options));
    let found = costs.into_iter().zip(STRUCTURES);
    let found = found.filter_map(|(cost, structure)| Some((cost?, structure)));
    let best = found.min_by(|a, b| a.0.total_cmp(&b.0));
    best.map_or_else(Vec::new, |(_, best)| climbed(record, first, best, options, misfit))
}

/// The cost of `model` with the effects of `structure`, surveyed one after the other.
fn surveyed(
    record: &FitRecord<'_>,
    model: &JointModel,
    structure: Structure,
    options: &Options,
) -> Option<f64> {
    let range = record.range_for(model);
    let mut found = survey(record, model, &range).ok()?;
    for effect in structure {
        let Some(with) = extended(record, &found.model, *effect, options) else { continue };
        let better = survey(record, &with, &range).ok();
        found = better.filter(|better| better.cost < found.cost).unwrap_or(found);
    }
    Some(found.cost)
}

/// The changes from `first` on, one for each effect of `structure` that has a practical consequence and
/// predicts what was not fitted no worse.
fn climbed(
    record: &FitRecord<'_>,
    first: &Fit,
    structure: Structure,
    options: &Options,
    misfit: Misfit,
) -> Vec<(Change, Fit)> {
    let mut fit = first.clone();
    let mut steps = Vec::new();
    for effect in structure {
        if steps.len() == options.max_effects {
            break;
        }
        let Some(with) = extended(record, &fit.model, *effect, options) else { continue };
        let Ok(next) = fit_to_compare(record, &with, &record.range_for(&with)) else { continue };
        let (before, after) = (Errors::of(record, &fit), Errors::of(record, &next));
        if generalizes(&before, &after) && misfit.has_consequence(&before, &after) {
            let change = Change::between(&fit.model, &next.model, effect.spec().id);
            steps.push((change, next.clone()));
            fit = next;
        }
    }
    steps
}

/// `model` with `effect`, which is neutral there, where that may be added.
fn extended(
    record: &FitRecord<'_>,
    model: &JointModel,
    effect: &'static dyn Effect,
    options: &Options,
) -> Option<JointModel> {
    let spec = effect.spec();
    let is_allowed = options.effects.iter().any(|known| known.spec().id == spec.id)
        && could_be_missing(record, model, effect)
        && is_due(model, spec, options);
    is_allowed.then(|| model.with(Component::neutral(effect)))
}

/// Whether `one` is clearly more likely than `other`.
pub(super) fn is_more_likely(record: &FitRecord<'_>, one: &Fit, other: &Fit) -> bool {
    let noise = NoiseMemory::of(record, if one.cost < other.cost { one } else { other });
    let criterion = |fit| noise.evidence(record, fit).criterion();
    criterion(one) + ALIKE < criterion(other)
}
