//! What an engineer tries first where a joint makes strokes between its stops.
//!
//! In a stroke the input has one level, and the joint runs over its whole way. So few levels
//! are matched by many curves, and errors are far beyond the noise, where every effect is
//! significant: the one that explains most by itself is then often a stand-in for several
//! usual ones. These come first, in the order in which the oil meets them: the overlap of the
//! valve and its largest flow, the areas of the cylinder, its ends; then the linkage, and the
//! largest flow of each direction. Which of them have no consequence is seen at the end.
//!
//! # References
//! Merritt, H. E., 1967, Hydraulic Control Systems (valves and cylinders); Koivo, A. J., 1994,
//! Journal of Aerospace Engineering 7 (linkages of excavators).

use super::eligible::{could_be_missing, is_due};
use super::misfit::{Errors, Misfit, generalizes};
use super::options::Options;
use super::revision::Change;
use super::stepwise::Step;
use crate::effect::{
    AsymmetricSaturation, DeadBand, DirectionGain, Effect, EndStop, InputSaturation, PositionGain,
};
use crate::fit::{FitRecord, fit_to_compare};
use crate::model::Component;

static LADDER: [&dyn Effect; 6] =
    [&DeadBand, &InputSaturation, &DirectionGain, &EndStop, &PositionGain, &AsymmetricSaturation];

/// Effects that a search adds at least where the usual ones come first: of a few the best are
/// wanted, not the usual ones.
const ENOUGH: usize = 5;

/// The model of `first` with the usual effects that the options allow, one after the other.
/// `visit` sees each step but the last; none where it says no.
pub(super) fn climbed(
    record: &FitRecord<'_>,
    first: Step,
    options: &Options,
    misfit: Misfit,
    visit: &mut impl FnMut(&Step) -> bool,
) -> Option<Step> {
    let mut step = first;
    let usual = usual(options).filter(|_| options.max_effects >= ENOUGH);
    for effect in usual {
        let (model, spec) = (&step.fit.model, effect.spec());
        if !could_be_missing(record, model, effect) || !is_due(model, spec, options) {
            continue;
        }
        let with = model.with(Component::neutral(effect));
        let Ok(fit) = fit_to_compare(record, &with, &record.range_for(&with)) else {
            continue;
        };
        let (own, with_effect) = (Errors::of(record, &step.fit), Errors::of(record, &fit));
        if !generalizes(own, with_effect) {
            continue;
        }
        // A finer form is worth its parameters or not; whether an effect is, is seen at the end.
        if spec.refines.is_some() && !misfit.has_consequence(own, with_effect) {
            continue;
        }
        if !visit(&step) {
            return None;
        }
        step = Step::new(record, Change::between(model, &fit.model, spec.id), fit);
    }
    Some(step)
}

/// Whether an engineer tries it first.
pub(super) fn is_usual(id: &&'static str) -> bool {
    LADDER.iter().any(|effect| effect.spec().id == *id)
}

/// The usual effects among those that may be added.
fn usual(options: &Options) -> impl Iterator<Item = &'static dyn Effect> {
    let is_allowed = |id: &str| options.effects.iter().any(|effect| effect.spec().id == id);
    LADDER.into_iter().filter(move |effect| is_allowed(effect.spec().id))
}
