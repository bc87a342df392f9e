//! Fitted parameters: what is found, what is not, and what is said about it.

use nalgebra::{DMatrix, DVector};
use tauscope::effect::find;
use tauscope::experiment::{Joint, Record, Trial};
use tauscope::fit::{Fit, FitError, FitRecord, Horizon, Parameter, Split, Status, fit};
use tauscope::model::{Component, JointModel, Surroundings, Value, simulate_input};
use tauscope::units::SamplePeriod;

const PERIOD_S: f64 = 0.02;

/// Standard deviation of the noise in the output of [`joint`].
const NOISE: f64 = 0.05;

/// Reproducible numbers from −1 to 1.
struct Random(u64);

impl Random {
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963);
        (self.0 >> 40) as f64 / f64::from(1u32 << 23) - 1.0
    }

    /// Four levels of either sign, each held for half a second to two seconds.
    fn input(&mut self, samples: usize) -> Vec<f64> {
        let (mut level, mut until) = (0.0, 25.0);
        let next = |sample| {
            if f64::from(sample) >= until {
                level = (2.0 * self.next()).round() + 0.5;
                until += 62.0 + 37.0 * self.next();
            }
            level
        };
        (0..i32::try_from(samples).unwrap()).map(next).collect()
    }
}

fn with(effects: &[(&str, &[f64])]) -> JointModel {
    let component = |(id, values): &(&str, &[f64])| {
        let values = values.iter().map(|value| (*value).into()).collect();
        Component::new(find(id).unwrap(), values).unwrap()
    };
    let plain = JointModel::integrator(8.0, 0.15);
    effects.iter().map(component).fold(plain, |model, component| model.with(component))
}

fn plus(model: &JointModel, id: &str) -> JointModel {
    model.with(Component::neutral(find(id).unwrap()))
}

fn start() -> JointModel {
    JointModel::integrator(7.0, 0.1)
}

/// Trials of `model` at the times `starts_s`, with noise.
fn joint(model: &JointModel, starts_s: &[f64], seed: u64) -> Joint {
    let mut random = Random(seed);
    let period = SamplePeriod::from_seconds(PERIOD_S).unwrap();
    let trial = |start_s: &f64| {
        let input = random.input(1500);
        let since = start_s - starts_s[0];
        let surroundings =
            Surroundings { start_s: since, radians_per_output_unit: 0.02, ..<_>::default() };
        let simulated = simulate_input(model, &input, PERIOD_S, 4.0, &surroundings);
        let output = simulated.output.iter().map(|y| y + NOISE * 3f64.sqrt() * random.next());
        Trial::new(format!("at {start_s}"), *start_s, period, input, output.collect()).unwrap()
    };
    Joint::new("joint", starts_s.iter().map(trial).collect::<Record>())
}

fn record(joint: &Joint, horizon: Horizon) -> FitRecord<'_> {
    FitRecord::new(joint, Split::Time(1.0), horizon)
}

fn fitted(joint: &Joint, start: &JointModel, horizon: Horizon) -> Fit {
    let record = record(joint, horizon);
    fit(&record, start, &record.range(20.0)).unwrap()
}

fn parameter<'a>(fit: &'a Fit, name: &str) -> &'a Parameter {
    fit.parameters.iter().find(|parameter| parameter.name == name).unwrap()
}

/// Cramér and Rao's bound: the least standard error that any estimator can have of each of the
/// parameters of `truth` that `fit` fitted, `√ diag σ² (JᵀJ)⁻¹` with the derivatives `J` of the
/// residuals at the truth and the noise `σ` that was put in.
fn least_errors(record: &FitRecord<'_>, truth: &JointModel, fit: &Fit) -> Vec<f64> {
    let values: Vec<f64> = truth.values().iter().map(|value| value.value).collect();
    let is_free = |index: &usize| fit.parameters[*index].status != Status::Fixed;
    let free: Vec<usize> = (0..values.len()).filter(is_free).collect();
    let residuals = |index: usize, step: f64| {
        let mut values = values.clone();
        values[index] += step;
        DVector::from_vec(record.evaluate(&truth.with_values(&values)).residuals.concat())
    };
    let column = |index: &usize| {
        let step = 1e-4 * values[*index].abs().max(0.01);
        (residuals(*index, step) - residuals(*index, -step)) / (2.0 * step)
    };
    let jacobian = DMatrix::from_columns(&free.iter().map(column).collect::<Vec<_>>());
    let covariance = jacobian.tr_mul(&jacobian).try_inverse().unwrap() * NOISE.powi(2);
    let mut errors = vec![0.0; values.len()];
    free.iter().enumerate().for_each(|(k, index)| errors[*index] = covariance[(k, k)].sqrt());
    errors
}

/// Each parameter of `truth` was fitted, and is found: within 4.5 of the least standard errors
/// that there can be, which normal errors exceed once in 100,000. What the fit says of its own
/// error is near the least, too.
fn assert_all_found(record: &FitRecord<'_>, fit: &Fit, truth: &JointModel) {
    let least = least_errors(record, truth, fit);
    for ((found, truth), least) in fit.parameters.iter().zip(truth.values()).zip(least) {
        assert_eq!(found.status, Status::Fitted, "{found:?}");
        let deviation = (found.value - truth.value).abs();
        assert!(deviation < 4.5 * least, "{found:?}, not {} ± {least}", truth.value);
        let error = found.std_error.unwrap() / least;
        assert!((0.5..2.0).contains(&error), "{found:?}: {error} of {least}");
    }
}

#[test]
fn outliers_hardly_move_what_is_found() {
    let mut joint = joint(&with(&[("dead_band", &[-0.3, 0.3])]), &[0.0], 1);
    let clean = fitted(&joint, &plus(&start(), "dead_band"), Horizon::FreeRun);
    let trial = &joint.trials[0];
    let wild = |(k, y): (usize, &f64)| if k % 50 == 7 { y + 30.0 } else { *y };
    let output = trial.output().iter().enumerate().map(wild).collect();
    let period = trial.period();
    let wild = Trial::new("", 0.0, period, trial.input().to_vec(), output).unwrap();
    joint.trials = [wild].into();
    let dirty = fitted(&joint, &plus(&start(), "dead_band"), Horizon::FreeRun);
    for (clean, dirty) in clean.parameters.iter().zip(&dirty.parameters) {
        let error = clean.std_error.unwrap();
        assert!((clean.value - dirty.value).abs() < 3.0 * error, "{clean:?} {dirty:?}");
        // A fiftieth of the samples tell little, and the rest as much as before.
        assert!(dirty.std_error.unwrap() < 2.0 * error, "{clean:?} {dirty:?}");
    }
}

#[test]
fn what_the_record_cannot_tell_is_said_to_be_undetermined() {
    // No level lies above 2.5, so nothing is limited; two offsets are one.
    let joint = joint(&with(&[]), &[0.0], 2);
    let offsets = plus(&plus(&start(), "input_offset"), "input_offset");
    let fit = fitted(&joint, &offsets, Horizon::FreeRun);
    assert_eq!(parameter(&fit, "input_offset.offset").status, Status::Undetermined);
    assert_eq!(parameter(&fit, "input_offset.offset").std_error, None);
    let one = fitted(&joint, &plus(&start(), "input_offset"), Horizon::FreeRun);
    assert_all_found(&record(&joint, Horizon::FreeRun), &one, &with(&[("input_offset", &[0.0])]));
    let [gain, alone] = [&fit, &one].map(|fit| parameter(fit, "gain"));
    assert!((gain.value - alone.value).abs() < 0.1 * alone.std_error.unwrap(), "{gain:?}");
}

#[test]
fn an_effect_that_is_not_there_stays_at_its_bound() {
    let (plain, neutral) = (with(&[]), plus(&start(), "backlash"));
    let least = 0.02;
    let mut at_bound = 0;
    for seed in 3..9 {
        let joint = joint(&plain, &[0.0], seed);
        let fit = fitted(&joint, &neutral, Horizon::FreeRun);
        let width = parameter(&fit, "backlash.width");
        match width.status {
            Status::AtBound => at_bound += 1,
            Status::Fitted => assert!(width.value < 4.5 * least, "{width:?}"),
            Status::Fixed | Status::Undetermined | Status::BeyondReach => {
                panic!("{width:?} was not fitted")
            }
        }
    }
    // Noise has the best width below zero every other time.
    assert!(at_bound >= 1, "{at_bound} of 6");
}

#[test]
fn what_is_fixed_stays_and_what_has_limits_keeps_them() {
    let joint = joint(&with(&[("actuator_lag", &[0.1])]), &[0.0], 4);
    let mut model = plus(&start(), "actuator_lag");
    model.gain = Value { fixed: true, ..8.0.into() };
    model.delay.max = Some(0.12);
    let fit = fitted(&joint, &model, Horizon::FreeRun);
    assert_eq!(parameter(&fit, "gain").status, Status::Fixed);
    assert_eq!(parameter(&fit, "gain").value.to_bits(), 8.0_f64.to_bits());
    assert_eq!(parameter(&fit, "delay").status, Status::AtBound);
    assert!(parameter(&fit, "delay").value <= 0.12);
}

#[test]
fn time_goes_on_from_one_trial_to_the_next_whenever_the_log_begins() {
    // Two hours into a clock's day, and half a minute between the trials.
    for begin_s in [0.0, 7200.0] {
        let truth = with(&[("thermal_drift", &[0.01, 30.0])]);
        let joint = joint(&truth, &[begin_s, begin_s + 60.0], 5);
        let fit = fitted(&joint, &plus(&start(), "thermal_drift"), Horizon::FreeRun);
        assert_all_found(&record(&joint, Horizon::FreeRun), &fit, &truth);
    }
}

#[test]
fn horizons_find_the_same() {
    let truth = with(&[("actuator_lag", &[0.1]), ("leakage", &[0.1, 20.0]), ("backlash", &[1.0])]);
    let joint = joint(&truth, &[0.0, 40.0], 6);
    for horizon in [Horizon::FreeRun, Horizon::Steps, Horizon::Seconds(3.0)] {
        let fit = fitted(&joint, &truth, horizon);
        assert_all_found(&record(&joint, horizon), &fit, &truth);
    }
}

#[test]
fn four_samples_are_too_few() {
    let period = SamplePeriod::from_seconds(PERIOD_S).unwrap();
    let trial = Trial::new("", 0.0, period, vec![1.0; 3], vec![0.0; 3]).unwrap();
    let joint = Joint::new("joint", [trial]);
    let record = record(&joint, Horizon::FreeRun);
    let error = fit(&record, &start(), &record.range(20.0)).unwrap_err();
    assert_eq!(error, FitError::TooFewSamples { samples: 3, parameters: 2 });
}
