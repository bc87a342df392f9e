//! Exchanges of effects for others that look like them.

use super::eligible::{could_be_missing, is_as_simple_a_form, is_due};
use super::extension::components_of;
use super::likeness::looks_like;
use super::options::Options;
use super::revision::Change;
use crate::effect::{Effect, by_id};
use crate::fit::FitRecord;
use crate::model::{Component, JointModel};

/// Changes that are made together: one, or that of an effect for two others, or of several for one.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Exchange(pub(super) Vec<Change>);

impl Exchange {
    pub(super) fn alone(change: Change) -> Self {
        Self(vec![change])
    }

    /// Whether it brings two effects for one, or a finer form of one: what is as likely keeps its usual
    /// name.
    pub(super) fn is_unusual(&self) -> bool {
        let new: Vec<_> = self.new_effects().collect();
        let is_finer = |id: &&str| by_id(id).is_some_and(|new| new.spec().refines.is_some());
        new.len() > 1 || new.iter().any(is_finer)
    }

    /// Whether it brings a curve of any form.
    pub(super) fn has_free_form(&self) -> bool {
        self.new_effects().any(is_free_form)
    }

    /// Whether it brings laws in the place of a curve of any form.
    pub(super) fn is_for_free_form(&self) -> bool {
        self.old().is_some_and(is_free_form)
    }

    /// The effect in whose place the others come.
    pub(super) fn old(&self) -> Option<&'static str> {
        self.0.iter().find_map(|change| match change {
            Change::Replaced { old, .. } => Some(*old),
            _ => None,
        })
    }

    /// The one effect in the place of one other.
    pub(super) fn one_for_one(&self) -> Option<(&'static str, &'static str)> {
        match self.0[..] {
            [Change::Replaced { old, new }] => Some((old, new)),
            _ => None,
        }
    }

    /// The effects that it brings.
    pub(super) fn new_effects(&self) -> impl Iterator<Item = &'static str> {
        self.0.iter().filter_map(|change| change.new_effect())
    }

    /// `model` after it, once for each start of what is new.
    pub(super) fn applied(&self, model: &JointModel) -> Vec<JointModel> {
        let then = |models: Vec<JointModel>, change: &Change| {
            models.iter().flat_map(|model| changed(model, *change)).collect()
        };
        self.0.iter().fold(vec![model.clone()], then)
    }
}

/// The exchanges of `old` for each effect that looks like it, and for each two that look like it together.
pub(super) fn exchanges_for(
    record: &FitRecord<'_>,
    model: &JointModel,
    old: &'static str,
    options: &Options,
) -> Vec<Exchange> {
    [replacements, by_two].into_iter().flat_map(|of| of(record, model, old, options)).collect()
}

/// The exchanges of `old` for two effects that look like it together.
pub(super) fn by_two(
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
pub(super) fn in_place_of_all(
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
) -> Vec<Exchange> {
    let alike = options.effects.iter();
    let alike = alike.filter(move |effect| looks_like(old, effect.spec().id));
    let rest = model.without(old);
    let able = alike.filter(|effect| {
        let spec = effect.spec();
        could_be_missing(record, &rest, **effect)
            && !spec.is_free_form
            && (is_free_form(old) || is_due(&rest, spec, options) || is_as_simple_a_form(spec, old))
    });
    let replaced = |effect: &&'static dyn Effect| {
        Exchange::alone(Change::Replaced { old, new: effect.spec().id })
    };
    able.map(replaced).collect()
}

/// Whether an effect is a curve of any form.
pub(super) fn is_free_form(id: &str) -> bool {
    by_id(id).is_some_and(|effect| effect.spec().is_free_form)
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
    use super::super::extension::ids;
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
