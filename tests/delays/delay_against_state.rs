//! What the delay depends on: planted laws are found, and nothing else.

use tauscope::batch::Threads;
use tauscope::delay::{AgainstState, Method, Settings};
use tauscope::experiment::{Joint, Signal, Trial};
use tauscope::report::{EstimatedJoint, against_table};
use tauscope::study::estimate_joints;
use tauscope::synthetic::{DelayLaw, InputSpec, JointSpec, PlantSpec, simulate};

fn joint(law: DelayLaw, duration_s: f64) -> Joint {
    let levels = vec![-3.0, -1.5, 0.0, 1.0, 2.5, 4.0];
    let input = InputSpec::Levels { levels, hold_s: [0.8, 1.6] };
    let spec =
        JointSpec { noise: 0.01, range: Some([-40.0, 40.0]), ..JointSpec::new("boom", input, law) };
    simulate(&PlantSpec::new(3, duration_s, vec![spec])).unwrap().joints.remove(0)
}

fn found(joint: &Joint) -> AgainstState {
    let settings = Settings { low_pass: None, beta: 1, ..Settings::of(Method::TWO_LINE) };
    let estimates = estimate_joints(std::slice::from_ref(joint), &settings, || (), &Threads);
    let estimate = estimates[0].as_ref().unwrap();
    EstimatedJoint { joint, estimate }.against_state()
}

/// The variables that the delay is said to depend on.
fn depends_on(found: &AgainstState) -> Vec<&str> {
    let correlations = found.correlations.iter().filter(|one| one.significant);
    correlations.map(|one| one.variable.as_str()).collect()
}

fn rho(found: &AgainstState, variable: &str) -> f64 {
    let one = found.correlations.iter().find(|one| one.variable == variable);
    one.unwrap().rho.unwrap()
}

#[test]
fn a_delay_that_falls_with_the_step_is_seen_to() {
    let found = found(&joint(DelayLaw::StepSize { min: 0.05, max: 0.5, scale: 3.0 }, 120.0));
    assert!(rho(&found, "step_size") < -0.9, "{:?}", found.correlations);
    assert!(depends_on(&found).contains(&"step_size"));
    assert!(!depends_on(&found).contains(&"time"));
}

#[test]
fn a_delay_that_falls_with_time_is_seen_to() {
    let found = found(&joint(DelayLaw::Warming { first: 0.4, last: 0.1 }, 120.0));
    assert!(rho(&found, "time") < -0.95);
    assert_eq!(depends_on(&found), ["time"]);
}

#[test]
fn a_delay_of_each_direction_is_seen() {
    let found = found(&joint(DelayLaw::Direction { rising: 0.1, falling: 0.3 }, 120.0));
    assert!(depends_on(&found).contains(&"direction"));
    assert!(rho(&found, "direction") < -0.8);
}

#[test]
fn a_drawn_delay_depends_on_nothing() {
    assert_eq!(
        depends_on(&found(&joint(DelayLaw::Uniform { min: 0.1, max: 0.4 }, 120.0))),
        [""; 0]
    );
}

#[test]
fn a_further_signal_is_compared_where_it_was_measured() {
    let mut joint = joint(DelayLaw::Warming { first: 0.4, last: 0.1 }, 120.0);
    joint.covariates = vec![Signal { name: "oil".into(), unit: Some("degC".into()) }];
    let trial = joint.trials[0].clone();
    let oil = |sample: usize| if sample < 3000 { f64::NAN } else { 20.0 + sample as f64 / 600.0 };
    let oil = (0..trial.len()).map(oil).collect();
    joint.trials = [trial.with_covariates(vec![oil]).unwrap()].into();
    let found = found(&joint);
    let oil = found.correlations.last().unwrap();
    assert_eq!((oil.variable.as_str(), oil.unit.as_deref()), ("oil", Some("degC")));
    assert!(oil.steps < found.steps.len() && oil.rho.unwrap() < -0.9 && oil.significant);
    assert!(found.steps[0].covariates[0].is_none());
}

#[test]
fn variables_that_go_together_are_said_not_to_be_told_apart() {
    let mut joint = joint(DelayLaw::Warming { first: 0.4, last: 0.1 }, 120.0);
    joint.covariates = vec![Signal { name: "oil".to_owned(), unit: Some("degC".to_owned()) }];
    let warming = |trial: Trial| {
        let oil = (0..trial.len()).map(|k| 20.0 + 0.001 * k as f64).collect();
        trial.with_covariates(vec![oil]).unwrap()
    };
    joint.trials = joint.trials.into_iter().map(warming).collect();
    let found = found(&joint);
    let pairs: Vec<_> = found.kinds.iter().flat_map(|kind| &kind.confounded).collect();
    assert!(!pairs.is_empty());
    assert!(pairs.iter().all(|pair| **pair == ["time", "oil"]), "{pairs:?}");
    let text = against_table([("boom", &found)]);
    assert!(text.contains("time and oil are correlated"), "{text}");
}

#[test]
fn steps_have_the_state_of_their_joint() {
    let joint = joint(DelayLaw::Constant { seconds: 0.2 }, 60.0);
    let found = found(&joint);
    let trial = &joint.trials[0];
    for step in &found.steps {
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "few")]
        let sample = (step.time_s / 0.01).round() as usize;
        let change = trial.input()[sample] - trial.input()[sample - 1];
        assert!((step.input_change - change).abs() < 1e-12);
        assert!((step.average_speed - 10.0 * trial.input()[sample].abs()).abs() < 0.2);
        assert!((step.delay_s - 0.2).abs() < 0.021);
        assert!(step.dwell_s.is_some_and(|dwell| (0.79..1.61).contains(&dwell)));
    }
}

#[test]
fn the_table_says_what_is_not_known() {
    let few = found(&joint(DelayLaw::Constant { seconds: 0.2 }, 4.0));
    let table = against_table([("boom", &few)]);
    let lines: Vec<&str> = table.lines().map(str::trim_end).collect();
    assert!(few.steps.len() < 4 && few.correlations.iter().all(|one| one.rho.is_none()));
    assert!(lines[1].contains("rank correlation"), "{table}");
    assert!(lines[3].contains("too few steps") && lines[3].contains("not known"), "{table}");
    let law = DelayLaw::StepSize { min: 0.05, max: 0.5, scale: 3.0 };
    let table = against_table([("boom", &found(&joint(law, 120.0)))]);
    let rows: Vec<&str> = table.lines().filter(|line| line.contains("step size [V]")).collect();
    assert_eq!(rows.len(), 4, "{table}");
    let reversals = rows.iter().find(|row| row.contains("reversal")).unwrap();
    assert!(reversals.contains("< 0.001") && reversals.contains("yes"), "{table}");
    println!("{table}");
}

#[test]
fn kinds_of_steps_are_compared_each_among_themselves() {
    let joint = joint(DelayLaw::StepSize { min: 0.05, max: 0.5, scale: 3.0 }, 120.0);
    let found = found(&joint);
    let steps: usize = found.kinds.iter().map(|kind| kind.steps).sum();
    assert_eq!((found.kinds.len(), steps), (4, found.steps.len()));
    for kind in &found.kinds {
        let same = found.steps.iter().filter(|step| step.transition == kind.transition);
        assert_eq!(same.count(), kind.steps);
        assert!(kind.correlations[1].rho.unwrap() < -0.8, "{kind:?}");
    }
}
