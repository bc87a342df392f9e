//! Effects that look like one another in a record.

use super::determined::{BESIDE_ITS_LIKE, is_distinct};
use crate::effect::{Effect, Moment, RecordRange, by_id};
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

/// Whether each of the effects `new` of a fitted model is distinguished from what looks like it beside
/// it: it is known to do something, and shows the feature after which it is named. Of two steady effects
/// both must show it: beside one whose feature is not seen, the other may only correct its form. Of two
/// curves it must be seen at levels at which a valve that sticks beside them moves.
///
/// What was there before may no longer be: that is for a removal to judge.
pub(super) fn are_distinguished(
    fit: &AssessedModel,
    new: &[&str],
    range: &RecordRange<'_>,
) -> bool {
    let is_fitted = |component: &&Component| component.parameters().iter().any(|p| !p.fixed);
    let fitted: Vec<&Component> = fit.model.components().iter().filter(is_fitted).collect();
    let id = |component: &Component| component.effect().spec().id;
    let moving: Vec<f64> =
        range.input_levels.iter().copied().filter(|level| !stick(&fitted, *level)).collect();
    let moving = RecordRange { input_levels: &moving, ..*range };
    let mut added = fitted.iter().filter(|one| new.contains(&id(one)));
    added.all(|one| {
        let mut alike = fitted.iter().filter(|other| looks_like(id(one), id(other)));
        alike.all(|other| {
            let both = |is: fn(&Component) -> bool| is(one) && is(other);
            let seen = if both(is_curve) { &moving } else { range };
            let shows_its_form = |one: &Component| one.effect().shows_its_form(&one.plain(), seen);
            is_distinct(fit, one, BESIDE_ITS_LIKE)
                && shows_its_form(one)
                && (!both(|one| one.effect().is_steady()) || shows_its_form(other))
        })
    })
}

/// Whether an effect is a curve: steady, and without memory.
fn is_curve(one: &Component) -> bool {
    one.effect().is_steady() && one.effect().spec().memory == 0
}

/// Whether a joint at rest stays there at a command of this magnitude because of one of the `effects` that
/// remember whether it moves.
fn stick(effects: &[&Component], magnitude: f64) -> bool {
    let sticks = |one: &&Component, command: f64| {
        let (effect, values) = (one.effect(), one.plain());
        let mut memory = vec![0.0; effect.spec().memory];
        let at = Moment::of(command);
        effect.settle(&values, &mut memory, &at);
        effect.step(&values, &mut memory, &at).abs() <= 0.0
    };
    let mut remembering = effects.iter().filter(|one| one.effect().is_steady() && !is_curve(one));
    magnitude > 0.0
        && remembering.any(|one| [magnitude, -magnitude].iter().all(|level| sticks(one, *level)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effect::{
        CoulombFriction, DeadBand, FlowCurve, InputOffset, InputSaturation, Stiction,
    };
    use crate::fit::{Parameter, Status};
    use crate::model::{JointModel, Value};

    /// A model with `effects`, the first parameter of each so many standard errors from where it does
    /// nothing.
    fn fitted(effects: &[(&'static dyn Effect, f64)]) -> AssessedModel {
        let component = |(effect, errors): &(&'static dyn Effect, f64)| {
            let mut values = effect.spec().neutral();
            values[0] += errors * 0.1;
            Component::new(*effect, values.into_iter().map(Value::from).collect()).unwrap()
        };
        let integrator = JointModel::integrator(1.0, 0.1);
        let model = effects.iter().map(component).fold(integrator, |model, one| model.with(one));
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

    /// Whether they are distinguished in a record with levels within every band.
    fn is_told(fit: &AssessedModel, new: &[&str]) -> bool {
        let record = RecordRange { input_levels: &[0.02, 0.04], ..RecordRange::default() };
        are_distinguished(fit, new, &record)
    }

    #[test]
    fn beside_an_overlap_a_friction_is_distinguished_by_three_standard_errors() {
        let with = |friction| fitted(&[(&DeadBand, -9.0), (&CoulombFriction, friction)]);
        assert!(is_told(&with(4.0), &["coulomb_friction"]));
        assert!(!is_told(&with(2.5), &["coulomb_friction"]));
        assert!(!is_told(&with(2.5), &["dead_band", "coulomb_friction"]), "each of both");
        assert!(is_told(&with(2.5), &["dead_band"]));
        // Not beside it, less will do here.
        let mut alone = fitted(&[(&CoulombFriction, 2.5)]);
        assert!(is_told(&alone, &["coulomb_friction"]));
        // A neutral that is known is no friction.
        let mut offset = Component::neutral(&InputOffset).parameters().to_vec();
        offset[0].fixed = true;
        alone.model = alone.model.with(Component::new(&InputOffset, offset).unwrap());
        assert!(is_told(&alone, &["coulomb_friction"]));
    }

    #[test]
    fn an_overlap_that_a_stiction_hides_is_not_told_from_a_bend_of_the_flow_curve() {
        let with = |start: f64| {
            let mut fit = fitted(&[(&DeadBand, -9.0), (&FlowCurve, 9.0)]);
            let sticky = Component::new(&Stiction, [start, start].map(Value::from).to_vec());
            fit.model = fit.model.with(sticky.unwrap());
            fit
        };
        // The overlap ends at 0.9.
        let record =
            RecordRange { input_levels: &[0.3, 0.6, 0.8, 1.0, 2.0], ..RecordRange::default() };
        let is_told = |start| are_distinguished(&with(start), &["dead_band"], &record);
        assert!(is_told(0.4), "it does not move at 0.6 and 0.8 either");
        assert!(!is_told(0.95));
    }

    #[test]
    fn a_limit_is_told_from_a_flow_curve_only_where_the_input_passes_its_knee() {
        let with_limit = |limit: f64| {
            let mut fit = fitted(&[(&FlowCurve, 9.0), (&InputSaturation, -9.0)]);
            let values = [limit, 0.2].map(Value::from);
            let component = Component::new(&InputSaturation, values.to_vec()).unwrap();
            fit.model = fit.model.without("input_saturation").with(component);
            fit
        };
        let record = RecordRange { input_abs_max: 2.0, ..RecordRange::default() };
        let is_told = |limit, new| are_distinguished(&with_limit(limit), &[new], &record);
        assert!(is_told(1.5, "flow_curve") && is_told(1.5, "input_saturation"));
        assert!(!is_told(1.8, "flow_curve") && !is_told(1.8, "input_saturation"));
    }
}
