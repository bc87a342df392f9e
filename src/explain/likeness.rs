//! Effects that look like one another in a record.

use crate::effect::{Effect, by_id};
use crate::model::{Component, JointModel};

/// Whether one effect is taken for the other, or contains it.
pub(super) fn looks_like(one: &str, other: &str) -> bool {
    let near = |a: &str, b: &str| {
        let spec = by_id(a).map(Effect::spec);
        spec.is_some_and(|spec| spec.confused_with.contains(&b) || spec.absorbs.contains(&b))
    };
    one != other && (near(one, other) || near(other, one))
}

/// Whether one of the effects `new` of `model` looks like another one that is fitted beside it.
pub(super) fn is_beside_its_like(model: &JointModel, new: &[&str]) -> bool {
    let is_fitted = |component: &&Component| component.parameters().iter().any(|p| !p.fixed);
    let fitted = model.components().iter().filter(is_fitted);
    let ids = fitted.map(|component| component.effect().spec().id);
    let mut beside = ids.filter(|id| !new.contains(id));
    beside.any(|old| new.iter().any(|new| looks_like(old, new)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effect::{CoulombFriction, DeadBand, InputOffset};

    #[test]
    fn a_friction_is_beside_its_like_where_an_overlap_is_fitted() {
        let with = |effects: &[&'static dyn Effect]| {
            let neutral = effects.iter().map(|effect| Component::neutral(*effect));
            neutral.fold(JointModel::integrator(1.0, 0.1), |model, one| model.with(one))
        };
        let is_beside = |model: &JointModel| is_beside_its_like(model, &["coulomb_friction"]);
        assert!(is_beside(&with(&[&DeadBand, &CoulombFriction])));
        assert!(!is_beside(&with(&[&CoulombFriction])));
        // A neutral that is known is no friction.
        let mut offset = Component::neutral(&InputOffset).parameters().to_vec();
        offset[0].fixed = true;
        let known = Component::new(&InputOffset, offset).unwrap();
        assert!(!is_beside(&with(&[&CoulombFriction]).with(known)));
    }
}
