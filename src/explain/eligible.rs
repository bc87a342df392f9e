//! Which effects could be missing from a model.

use super::options::Options;
use crate::delay::InputMotion;
use crate::effect::{Effect, Spec, Stage, WithinTrials, by_id};
use crate::experiment::are_opposites;
use crate::fit::FitRecord;
use crate::model::JointModel;

/// The effects of `options` that could be missing from `model`.
pub(super) fn eligible(
    record: &FitRecord<'_>,
    model: &JointModel,
    options: &Options,
) -> Vec<&'static dyn Effect> {
    let is_eligible = |effect: &&&'static dyn Effect| {
        could_be_missing(record, model, **effect)
            && is_due(model, effect.spec(), options)
            && !effect.spec().is_free_form
    };
    options.effects.iter().filter(is_eligible).copied().collect()
}

/// The effects of `options` of a free form that could be missing from `model`.
pub(super) fn free_forms(
    record: &FitRecord<'_>,
    model: &JointModel,
    options: &Options,
) -> Vec<&'static dyn Effect> {
    let is_one = |effect: &&&'static dyn Effect| {
        effect.spec().is_free_form && could_be_missing(record, model, **effect)
    };
    options.effects.iter().filter(is_one).copied().collect()
}

/// The effects of `options` that could be missing from `model`, are a steady law, and
/// [refine](Spec::refines) one that is not in it.
pub(super) fn steady_refinements(
    record: &FitRecord<'_>,
    model: &JointModel,
    options: &Options,
) -> Vec<&'static dyn Effect> {
    let refines = |effect: &&&'static dyn Effect| {
        effect.is_steady()
            && could_be_missing(record, model, **effect)
            && !is_due(model, effect.spec(), options)
    };
    options.effects.iter().filter(refines).copied().collect()
}

/// Whether `effect` could be missing: it is not there already, nor contained in one that is,
/// and the record could show it.
pub(super) fn could_be_missing(
    record: &FitRecord<'_>,
    model: &JointModel,
    effect: &'static dyn Effect,
) -> bool {
    let id = effect.spec().id;
    let is_it = |spec: &Spec| spec.id == id || spec.absorbs.contains(&id);
    let has_steps = || !InputMotion::of(&record.joint().trials).is_continuous();
    !has(model, is_it)
        && (!effect.depends_on_others() || record.has_others())
        && effect.measured_signal().is_none_or(|name| record.has_signal(name))
        && effect.within_trials().is_none_or(|of| shows_condition(record, model, of))
        && (!effect.depends_on_steps() || has_steps())
}

/// Whether `record` can show what an effect does in the trials of its condition: not where the
/// model has it in all the other trials.
fn shows_condition(record: &FitRecord<'_>, model: &JointModel, of: WithinTrials<'_>) -> bool {
    let is_opposite = |other: WithinTrials<'_>| {
        std::ptr::eq(other.effect.spec(), of.effect.spec())
            && are_opposites(&record.joint().trials, [other.word, of.word])
    };
    let components = model.components().iter();
    let mut others = components.filter_map(|component| component.effect().within_trials());
    record.shows_condition(of.word) && !others.any(is_opposite)
}

/// Whether it is time to look for `effect`: what it refines is in the model, or is not to be
/// looked for; or it needs no more parameters, and the model has a curve of the valve: a lag before that
/// curve is another effect than one after it.
pub(super) fn is_due(model: &JointModel, effect: &Spec, options: &Options) -> bool {
    let is_sought = |id| options.effects.iter().any(|effect| effect.spec().id == id);
    let has_curve = || has(model, |spec| spec.stage == Stage::Input && spec.is_steady);
    effect.refines.is_none_or(|id| {
        has(model, |spec| spec.id == id)
            || !is_sought(id)
            || is_as_simple_a_form(effect, id) && has_curve()
    })
}

/// Whether one is a finer form of the other that needs no more parameters: the same on the other side of
/// the valve.
pub(super) fn are_as_simple(one: &str, other: &str) -> bool {
    let is_form = |of: &str, simple| {
        by_id(of).is_some_and(|effect| is_as_simple_a_form(effect.spec(), simple))
    };
    is_form(one, other) || is_form(other, one)
}

/// Whether an effect is a finer form of `simple` that needs no more parameters.
pub(super) fn is_as_simple_a_form(of: &Spec, simple: &str) -> bool {
    let parameters = by_id(simple).map(|simple| simple.spec().parameters.len());
    of.refines == Some(simple) && parameters == Some(of.parameters.len())
}

fn has(model: &JointModel, is_it: impl Fn(&Spec) -> bool) -> bool {
    model.components().iter().any(|component| is_it(component.effect().spec()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effect::{ActuatorLag, DeadBand, DirectionGain, SpoolLag};
    use crate::model::Component;

    #[test]
    fn a_lag_before_the_valve_is_due_where_a_curve_tells_it_from_one_behind() {
        let options = Options::default();
        let integrator = JointModel::integrator(1.0, 0.1);
        let is_due = |model: &JointModel| is_due(model, SpoolLag.spec(), &options);
        let with = |effect| integrator.clone().with(Component::neutral(effect));
        assert!(!is_due(&integrator));
        assert!(is_due(&with(&DeadBand)) && is_due(&with(&DirectionGain)));
        assert!(is_due(&with(&ActuatorLag)));
    }

    #[test]
    fn the_other_side_of_the_valve_is_as_simple() {
        assert!(are_as_simple("spool_lag", "actuator_lag"));
        assert!(are_as_simple("rate_limit", "spool_rate_limit"));
        assert!(!are_as_simple("asymmetric_friction", "coulomb_friction"), "it has one more");
        assert!(!are_as_simple("dead_band", "flow_curve"));
    }
}
