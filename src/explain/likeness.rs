//! Effects that look like one another in a record.

use super::determined::{BESIDE_ITS_LIKE, is_distinct};
use crate::effect::{Effect, by_id};
use crate::fit::AssessedModel;
use crate::model::Component;

/// Whether one effect is taken for the other, or contains it.
pub(super) fn looks_like(one: &str, other: &str) -> bool {
    let near = |a: &str, b: &str| {
        let spec = by_id(a).map(Effect::spec);
        spec.is_some_and(|spec| spec.confused_with.contains(&b) || spec.absorbs.contains(&b))
    };
    one != other && (near(one, other) || near(other, one))
}

/// Whether each of the effects `new` of a fitted model is told from what looks like it beside it, and
/// whatever was told before, in the model of `base`, still is.
pub(super) fn are_told_apart(fit: &AssessedModel, base: &AssessedModel, new: &[&str]) -> bool {
    let is_fitted = |component: &&Component| component.parameters().iter().any(|p| !p.fixed);
    let fitted: Vec<&Component> = fit.model.components().iter().filter(is_fitted).collect();
    let id = |component: &Component| component.effect().spec().id;
    let is_confused = |one: &Component, other: &Component| {
        let concerns_new = new.contains(&id(one)) || new.contains(&id(other));
        concerns_new && looks_like(id(one), id(other))
    };
    let is_known = |fit, one: &Component| is_distinct(fit, one, BESIDE_ITS_LIKE);
    let was_known = |one: &Component| {
        let before = base.model.components().iter().find(|before| id(before) == id(one));
        before.is_none_or(|before| is_known(base, before))
    };
    let beside = fitted.iter().filter(|one| fitted.iter().any(|other| is_confused(one, other)));
    let mut lost = beside.filter(|one| !is_known(fit, one) && was_known(one));
    lost.next().is_none()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effect::{CoulombFriction, DeadBand, InputOffset};
    use crate::fit::{Parameter, Status};
    use crate::model::JointModel;

    /// A model with `effects`, the first parameter of each so many standard errors from where it does
    /// nothing.
    fn fitted(effects: &[(&'static dyn Effect, f64)]) -> AssessedModel {
        let neutral = effects.iter().map(|(effect, _)| Component::neutral(*effect));
        let model = neutral.fold(JointModel::integrator(1.0, 0.1), |model, one| model.with(one));
        let parameter = |(effect, errors): &(&'static dyn Effect, f64)| {
            let spec = effect.spec();
            Parameter {
                name: format!("{}.{}", spec.id, spec.parameters[0].name),
                value: spec.parameters[0].neutral + errors * 0.1,
                std_error: Some(0.1),
                status: Status::Fitted,
            }
        };
        AssessedModel { model, parameters: effects.iter().map(parameter).collect() }
    }

    #[test]
    fn beside_an_overlap_a_friction_is_told_by_three_standard_errors() {
        let base = fitted(&[(&DeadBand, 9.0)]);
        let with = |friction| fitted(&[(&DeadBand, 9.0), (&CoulombFriction, friction)]);
        assert!(are_told_apart(&with(4.0), &base, &["coulomb_friction"]));
        assert!(!are_told_apart(&with(2.5), &base, &["coulomb_friction"]));
        // Not beside it, less will do here.
        let alone = fitted(&[(&CoulombFriction, 2.5)]);
        assert!(are_told_apart(&alone, &fitted(&[]), &["coulomb_friction"]));
        // A neutral that is known is no friction.
        let mut beside_known = fitted(&[(&CoulombFriction, 2.5)]);
        let mut offset = Component::neutral(&InputOffset).parameters().to_vec();
        offset[0].fixed = true;
        let known = Component::new(&InputOffset, offset).unwrap();
        beside_known.model = beside_known.model.with(known);
        assert!(are_told_apart(&beside_known, &fitted(&[]), &["coulomb_friction"]));
    }

    #[test]
    fn what_was_told_before_has_to_be_told_still() {
        let with = |overlap| fitted(&[(&DeadBand, overlap), (&CoulombFriction, 4.0)]);
        let new = ["coulomb_friction"];
        assert!(!are_told_apart(&with(2.5), &fitted(&[(&DeadBand, 9.0)]), &new));
        // What was not is for a removal to judge.
        assert!(are_told_apart(&with(2.5), &fitted(&[(&DeadBand, 2.6)]), &new));
    }
}
