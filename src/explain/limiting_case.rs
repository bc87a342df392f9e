//! Effects of which a record shows no more than their limiting case.
//!
//! A friction whose inertia is over within a sample, or is not known to be more than none, moves the joint
//! as an overlap does. Which of the two it is the record does not say; the one without the inertia is
//! named, and the other as what could be in its place.

use super::candidate::{ALIKE, Candidate};
use super::determined::{DISTINCT, distance_from_neutral, fitted};
use super::extension::components_of;
use super::options::Options;
use crate::effect::{Dimension, LimitingCase};
use crate::fit::{AssessedModel, FitRecord, Status};
use crate::model::Component;

/// What the error with a limiting case may be, in parts of that with the whole effect, to take its
/// place. Chosen: 2 % of the error, as a single effect has to explain; between samples the times of the
/// steps are not known, which likelihoods do not count.
const AS_LITTLE: f64 = 1.02;

/// The limiting case of an effect of a fitted model, where the record shows no more than that and
/// `options` have all its effects.
pub(super) fn limiting_case(
    record: &FitRecord<'_>,
    fit: &AssessedModel,
    component: &Component,
    options: &Options,
) -> Option<LimitingCase> {
    let case = component.effect().spec().limiting_case?;
    let (parameter, found) = fitted(fit, component).find(|(one, _)| one.name == case.parameter)?;
    let trials = record.joint().trials.iter();
    let period_s = trials.map(|trial| trial.period().seconds()).fold(0.0, f64::max);
    let is_within_a_sample = parameter.dimension == Dimension::Seconds && found.value < period_s;
    let is_shown = match found.status {
        Status::Fixed => true,
        _ if is_within_a_sample => false,
        Status::Fitted => distance_from_neutral(parameter, found).is_none_or(|far| far > DISTINCT),
        Status::AtBound | Status::Undetermined | Status::BeyondReach => false,
    };
    let is_tried = |id: &&str| options.effects.iter().any(|effect| effect.spec().id == *id);
    (!is_shown && case.effects.iter().all(is_tried)).then_some(case)
}

/// The limiting case that one of the effects `new` of a fitted model is no more than.
pub(super) fn limiting_case_of(
    record: &FitRecord<'_>,
    fit: &AssessedModel,
    new: &[&'static str],
    options: &Options,
) -> Option<LimitingCase> {
    components_of(&fit.model, new).find_map(|one| limiting_case(record, fit, one, options))
}

/// Puts the limiting case of a candidate, where that is all that the record shows of it, in its place.
pub(super) fn put_limiting_cases_first(
    record: &FitRecord<'_>,
    candidates: &mut [Candidate],
    options: &Options,
) {
    for index in (0..candidates.len()).rev() {
        if let Some(case) = as_good_a_case(record, candidates, index, options) {
            candidates[case].behind = candidates[index].behind;
            candidates[index..=case].rotate_right(1);
        }
    }
}

/// The place of the limiting case of the candidate at `index`, where that comes later and explains as
/// much.
fn as_good_a_case(
    record: &FitRecord<'_>,
    candidates: &[Candidate],
    index: usize,
    options: &Options,
) -> Option<usize> {
    let whole = &candidates[index];
    let [component] = whole.added().collect::<Vec<_>>()[..] else { return None };
    let case = limiting_case(record, &whole.fit, component, options)?;
    let at = candidates.iter().position(|other| other.effects == case.effects)?;
    let limit = &candidates[at];
    let errors = limit.training.zip(whole.training);
    let leaves_as_little =
        errors.is_some_and(|(of_limit, of_whole)| of_limit.rmse < AS_LITTLE * of_whole.rmse);
    let is_as_good = leaves_as_little || limit.deviance - whole.deviance < ALIKE;
    (at > index && is_as_good).then_some(at)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effect::{CoulombFriction, DeadBand, Effect};
    use crate::experiment::{Joint, Trial};
    use crate::fit::{Horizon, Parameter, Split};
    use crate::model::JointModel;
    use crate::units::SamplePeriod;

    /// What is said of a friction with this time constant, in a record at 100 Hz.
    fn case_of(value: f64, std_error: f64, status: Status, options: &Options) -> bool {
        let period = SamplePeriod::from_seconds(0.01).unwrap();
        let trial = Trial::new("1", 0.0, period, vec![0.0; 20], vec![0.0; 20]).unwrap();
        let joint = Joint::new("boom", vec![trial]);
        let record = FitRecord::new(&joint, Split::Trials, Horizon::FreeRun);
        let component = Component::neutral(&CoulombFriction);
        let model = JointModel::integrator(1.0, 0.1).with(component.clone());
        let name = "coulomb_friction.time_constant".to_owned();
        let std_error = Some(std_error);
        let parameters = vec![Parameter { name, value, std_error, status }];
        let fit = AssessedModel { model, parameters };
        limiting_case(&record, &fit, &component, options).is_some()
    }

    #[test]
    fn an_inertia_is_shown_beyond_a_sample_and_two_standard_errors() {
        let all = Options::default();
        assert!(!case_of(0.05, 0.01, Status::Fitted, &all));
        assert!(case_of(0.05, 0.03, Status::Fitted, &all), "it may be none");
        assert!(case_of(0.009, 0.001, Status::Fitted, &all), "it is over within a sample");
        assert!(case_of(0.0, 0.001, Status::AtBound, &all));
        assert!(!case_of(0.0, 0.0, Status::Fixed, &all), "it was asked for");
    }

    #[test]
    fn what_is_not_tried_takes_no_place() {
        let of = |effects: &[&'static dyn Effect]| Options {
            effects: effects.to_vec(),
            ..Options::default()
        };
        assert!(!case_of(0.0, 0.001, Status::AtBound, &of(&[&CoulombFriction])));
        assert!(case_of(0.0, 0.001, Status::AtBound, &of(&[&CoulombFriction, &DeadBand])));
    }
}
