//! Effects that look like one another in a record, and what one must carry beside another.

use super::misfit::CONSEQUENCE;
use crate::effect::{Effect, by_id};
use crate::model::{Component, JointModel};

/// The share of the misfit from which an effect has a consequence beside one that looks like it: two
/// frictions and an overlap together follow many a curve that is none of them. Chosen: on a measured
/// boom a friction and a stiction beside the overlap carry 4 and 3 %, each known to two standard
/// errors or less.
const BESIDE_ITS_LIKE: f64 = 0.05;

/// Whether one effect is taken for the other, or contains it.
pub(super) fn looks_like(one: &str, other: &str) -> bool {
    let near = |a: &str, b: &str| {
        let spec = by_id(a).map(Effect::spec);
        spec.is_some_and(|spec| spec.confused_with.contains(&b) || spec.absorbs.contains(&b))
    };
    one != other && (near(one, other) || near(other, one))
}

/// The share of the misfit that the effects `new` of `model` have to carry to be of consequence: more
/// beside one that is fitted, too, and looks like one of them.
pub(super) fn least_share(model: &JointModel, new: &[&str]) -> f64 {
    let is_fitted = |component: &&Component| component.parameters().iter().any(|p| !p.fixed);
    let fitted = model.components().iter().filter(is_fitted);
    let ids = fitted.map(|component| component.effect().spec().id);
    let mut beside = ids.filter(|id| !new.contains(id));
    let is_beside = beside.any(|old| new.iter().any(|new| looks_like(old, new)));
    if is_beside { BESIDE_ITS_LIKE } else { CONSEQUENCE }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effect::{CoulombFriction, DeadBand, InputOffset};

    #[test]
    fn a_friction_has_to_carry_more_beside_an_overlap_than_by_itself() {
        let with = |effects: &[&'static dyn Effect]| {
            let neutral = effects.iter().map(|effect| Component::neutral(*effect));
            neutral.fold(JointModel::integrator(1.0, 0.1), |model, one| model.with(one))
        };
        let share = |model: &JointModel| least_share(model, &["coulomb_friction"]);
        let beside = with(&[&DeadBand, &CoulombFriction]);
        assert!(share(&with(&[&CoulombFriction])) < share(&beside));
        // A neutral that is known is no friction.
        let mut offset = Component::neutral(&InputOffset).parameters().to_vec();
        offset[0].fixed = true;
        let known = Component::new(&InputOffset, offset).unwrap();
        let beside_it = with(&[&CoulombFriction]).with(known);
        assert!(share(&beside_it) < share(&beside));
    }
}
