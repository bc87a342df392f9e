//! What is hidden is as strong as it is said to be, by another measure than that which
//! sized it.

use crate::sample::size;
use tauscope::diagnosis::compare;
use tauscope::fit::{FitRecord, Horizon, Split, fit};
use tauscope::model::JointModel;
use tauscope::synthetic::effects::{CATALOGUE, FINER, OUTSIDE};
use tauscope::synthetic::scenario::{Noise, Scenario, Strength, draw};
use tauscope::synthetic::{PlantSpec, simulate};

/// Standard deviation of the noise, in degrees.
const NOISE: f64 = 0.05;

/// Error of a plain integrator that is fitted to the log, in deviations of the noise.
fn fitted_error(scenario: &Scenario) -> f64 {
    let made = simulate(&scenario.plant).unwrap();
    let record = FitRecord::new(&made.joints[0], Split::Time(1.0), Horizon::Steps);
    let gain = scenario.plant.joints[0].gain;
    let start = JointModel::integrator(gain, 0.15);
    let fitted = fit(&record, &start, &record.range(gain * 2.5)).unwrap();
    compare(&record, fitted).training.unwrap().rmse / NOISE
}

#[test]
fn a_fitted_integrator_is_as_wrong_as_was_promised() {
    for (name, strength) in [
        ("actuator_lag", Strength::Weak),
        ("gravity_load", Strength::Clear),
        ("sticky_spot", Strength::Weak),
    ] {
        let scenario = Scenario::new(&[name], strength, Noise::white(NOISE), 11).unwrap();
        // The noise is in the log, too, and in where each step begins. The fit restarts in
        // long holds, after which a slow error has grown.
        let expected = scenario.error_over_noise.hypot(1.0);
        let found = fitted_error(&scenario);
        assert!((0.7..1.1).contains(&(found / expected)), "{name}: {found}, not {expected}");
    }
}

#[test]
fn each_effect_can_be_hidden() {
    for (index, name) in
        CATALOGUE.into_iter().chain(OUTSIDE).chain(FINER).enumerate().step_by(size(5, 1))
    {
        let strength = if index % 2 == 0 { Strength::Weak } else { Strength::Clear };
        let scenario = Scenario::new(&[name], strength, Noise::white(NOISE), 5).unwrap();
        let allowed = if index % 2 == 0 { 1.5..=5.0 } else { 8.0..=f64::INFINITY };
        assert!(allowed.contains(&scenario.error_over_noise), "{name}");
        let made = simulate(&scenario.plant).unwrap();
        let output = made.joints[0].trials[0].output();
        assert!(output.iter().all(|y| y.abs() < 65.0), "{name}");
    }
}

#[test]
fn several_effects_are_hidden_together() {
    let names = draw(3, 2);
    let noise = Noise::correlated(NOISE, 0.9);
    let scenario = Scenario::new(&names, Strength::Weak, noise, 2).unwrap();
    assert_eq!(scenario.hidden, names);
    // Each alone makes 3 times the noise, about: together √3 times that, or, where they
    // add up or cancel, more or less.
    assert!((2.0..=12.0).contains(&scenario.error_over_noise), "{}", scenario.error_over_noise);
    let again = PlantSpec::from_toml(&scenario.plant.to_toml().unwrap()).unwrap();
    assert_eq!(again, scenario.plant);
}
