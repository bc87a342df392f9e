//! Delays that follow no law are taken from the record, and do not hide what else is missing.

use tauscope::batch::Threads;
use tauscope::delay::{EstimateError, Settings};
use tauscope::effect::VariableDelay;
use tauscope::experiment::Joint;
use tauscope::explain::{Options, Verdict};
use tauscope::fit::Horizon;
use tauscope::study::{
    JointEstimate, Mode, Protocol, add_to_joints, estimate_joints, explain_joints, improve_joints,
};
use tauscope::synthetic::{DelayLaw, InputSpec, JointSpec, PlantSpec, simulate};

const NOISE: f64 = 0.05;

const PROTOCOL: Protocol =
    Protocol { mode: Mode::Integrator, split: None, horizon: Horizon::Steps };

type Estimates = Vec<Result<JointEstimate, EstimateError>>;

/// An effect and its numbers.
type Hidden<'a> = (&'a str, &'a [(&'a str, f64)]);

/// A joint with these delays and effects.
fn made(seed: u64, delay: DelayLaw, hidden: &[Hidden<'_>]) -> (Vec<Joint>, Estimates) {
    let levels = vec![-3.0, -2.0, -1.0, -0.4, 0.0, 0.4, 1.0, 2.0, 3.0];
    let input = InputSpec::Levels { levels, hold_s: [0.6, 2.0] };
    let mut joint = JointSpec {
        gain: 8.0,
        range: Some([-50.0, 50.0]),
        noise: NOISE,
        ..JointSpec::new("boom", input, delay)
    };
    for (name, numbers) in hidden {
        let numbers: Vec<_> = numbers.iter().map(|(key, x)| ((*key).to_owned(), *x)).collect();
        joint.hide(name, &numbers).unwrap();
    }
    let joints = simulate(&PlantSpec::new(seed, 90.0, vec![joint])).unwrap().joints;
    let estimates = estimate_joints(&joints, &Settings::default(), || (), &Threads);
    (joints, estimates)
}

/// Delays that are drawn anew for each step.
const RANDOM: DelayLaw = DelayLaw::Uniform { min: 0.05, max: 0.35 };

fn ids(model: &tauscope::model::JointModel) -> Vec<&'static str> {
    model.components().iter().map(|component| component.effect().spec().id).collect()
}

#[test]
fn random_delays_are_told_and_taken_from_the_record() {
    let (joints, estimates) = made(11, RANDOM, &[]);
    let options = Options::default();
    let found = explain_joints(&joints, &estimates, |_| None, PROTOCOL, &options, &Threads);
    let found = found.into_iter().next().unwrap().unwrap().unwrap();
    assert_eq!(found.verdict, Verdict::MissingEffect);
    assert_eq!(found.ranking[0].name(), "variable_delay");
    assert!(found.ranking[0].fit.model.takes_measured_delays());
    assert!(found.ranking[0].validation.unwrap().rmse < 1.15 * NOISE);

    let added = add_to_joints(&joints, &estimates, |_| None, PROTOCOL, &VariableDelay, &Threads);
    let added = added.into_iter().next().unwrap().unwrap().unwrap();
    assert!(added.after.fit.model.takes_measured_delays());
    assert!(added.after.validation.unwrap().rmse < 1.15 * NOISE);
}

#[test]
fn what_random_delays_hide_is_found_behind_them() {
    let banded = [("dead_band", &[("lower", -0.6), ("upper", 0.5)][..])];
    let (joints, estimates) = made(13, RANDOM, &banded);
    let goes_on = |_: usize, _: &_| true;
    let options = Options::default();
    let found =
        improve_joints(&joints, &estimates, |_| None, PROTOCOL, &options, goes_on, &Threads);
    let found = found.into_iter().next().unwrap().unwrap().unwrap();
    let last = &found.revisions.last().unwrap().comparison;
    let mut effects = ids(&last.fit.model);
    effects.sort_unstable();
    assert_eq!(effects, ["dead_band", "variable_delay"], "{:?}", found.verdict);
    assert!(last.validation.unwrap().rmse < 1.15 * NOISE);
}

#[test]
fn a_law_is_preferred_to_measured_delays_where_it_does_as_well() {
    let law = [("variable_delay", &[("falling_s", 0.1)][..])];
    let (joints, estimates) = made(12, DelayLaw::Constant { seconds: 0.1 }, &law);
    let found =
        explain_joints(&joints, &estimates, |_| None, PROTOCOL, &Options::default(), &Threads);
    let found = found.into_iter().next().unwrap().unwrap().unwrap();
    assert_eq!(found.ranking[0].name(), "variable_delay");
    assert!(!found.ranking[0].fit.model.takes_measured_delays());
}
