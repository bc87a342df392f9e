//! With an effect added a fit never ends with a larger training error than without it, nor than
//! where it started; and the sum that it makes least is that of the error that is reported.
//!
//! Every effect of the catalogue, on bases of none to four effects, on synthetic logs and on
//! measured ones, which are not part of this project: the folder that holds them is
//! `TAUSCOPE_REAL_LOGS`, or `../shared/data`.

use crate::real;
use crate::sample::size;
use tauscope::diagnosis::ErrorFigures;
use tauscope::effect::{REGISTRY, find};
use tauscope::experiment::{Joint, Trial};
use tauscope::fit::{Fit, FitRecord, Horizon, Part, Split, fit};
use tauscope::model::{Component, JointModel};
use tauscope::synthetic::{
    CylinderSpec, DelayLaw, InputSpec, JointSpec, PlantSpec, Spikes, simulate,
};
use tauscope::units::SamplePeriod;

/// By how much, in parts, an error may be larger: sums in another order.
const ROUNDING: f64 = 1e-9;

/// A measured log: file, the column of its trials, those of time, input and output, and of how
/// many samples one is taken in the small sample.
type Log = (&'static str, Option<&'static str>, [&'static str; 3], usize);

const LOGS: [Log; 16] = [
    ("excavator_full_arm_single.csv", Some("test"), ["t_s", "u_duty_pct", "angle_deg"], 14),
    ("excavator_full_bucket_single.csv", Some("test"), ["t_s", "u_duty_pct", "angle_deg"], 7),
    ("excavator_rc_manual.csv", Some("run"), ["t_s", "u_boom_duty", "y_boom"], 10),
    ("excavator_rc_steps.csv", Some("run"), ["t_s", "u_boom_duty", "y_boom"], 1),
    ("emps_train.csv", None, ["t_s", "force_N", "q_m"], 20),
    ("dart_steering.csv", Some("trial"), ["time_s", "steer.input", "steer.output"], 1),
    ("davinci_tool.csv", Some("trial"), ["time_s", "jaw.input", "jaw.output"], 14),
    ("faster_rig.csv", None, ["time_s", "actuator.input", "actuator.output"], 7),
    ("mataveid_hangload.csv", None, ["time_s", "lift.input", "lift.output"], 10),
    ("mataveid_hydmotor.csv", None, ["time_s", "motor.input", "motor.output"], 5),
    ("mataveid_cylinders.csv", None, ["time_s", "cyl0.input", "cyl0.output"], 1),
    ("cascaded_tanks.csv", None, ["t_s", "u_est_V", "y_est_V"], 1),
    ("emps_test_pulses.csv", None, ["t_s", "force_N", "q_m"], 18),
    ("gas_furnace_seriesJ.csv", None, ["t_s", "gas_rate", "co2_pct"], 1),
    ("bj_sales_seriesM.csv", None, ["t", "lead", "sales"], 1),
    ("rotary_hydraulic_strokes.csv", Some("stroke"), ["k", "p_drive_cnt", "angle_cnt"], 20),
];

/// Effects of the models to which others are added.
const BASES: [&[&str]; 5] = [
    &[],
    &["dead_band"],
    &["dead_band", "end_stop"],
    &["dead_band", "input_saturation", "direction_gain"],
    &["coulomb_friction", "end_stop", "position_gain", "input_offset"],
];

const HORIZONS: [Horizon; 2] = [Horizon::Steps, Horizon::Auto];

/// The log, one of `every` samples, as if it were sampled evenly; `None` where it is not here.
fn measured((file, trial, [time, input, output], _): Log, every: usize) -> Option<Joint> {
    let mut reader = csv::Reader::from_path(real::log(file)?).unwrap();
    let headers = reader.headers().unwrap().clone();
    let place = |name: &str| headers.iter().position(|header| header == name).unwrap();
    let mut runs: Vec<(String, Vec<[f64; 3]>)> = Vec::new();
    for row in reader.records() {
        let row = row.unwrap();
        let label = trial.map_or("run", |trial| &row[place(trial)]).to_owned();
        let number = |name: &str| row[place(name)].trim().parse::<f64>();
        let (Ok(t), Ok(u), Ok(y)) = (number(time), number(input), number(output)) else { continue };
        match runs.last_mut() {
            Some((last, rows)) if *last == label => rows.push([t, u, y]),
            _ => runs.push((label, vec![[t, u, y]])),
        }
    }
    let trials = runs.into_iter().filter_map(|(label, rows)| {
        let rows: Vec<_> = rows.into_iter().step_by(every).collect();
        let (first, last) = (rows.first()?, rows.last()?);
        let period = (last[0] - first[0]) / (rows.len() - 1).max(1) as f64;
        let column = |index: usize| rows.iter().map(|row| row[index]).collect();
        let period = SamplePeriod::from_seconds(period)?;
        Trial::new(label, first[0], period, column(1), column(2)).ok()
    });
    Some(joint(trials.collect()))
}

fn joint(trials: Vec<Trial>) -> Joint {
    Joint::new("joint", trials)
}

/// A joint with a dead band, a lag and spikes of its sensor, and one that a cylinder moves.
fn synthetic(seconds: f64) -> Vec<Joint> {
    let input = InputSpec::Levels {
        levels: vec![-4.0, -2.5, -1.5, -0.5, 0.0, 0.5, 1.5, 2.5, 4.0],
        hold_s: [0.5, 2.0],
    };
    let delay = DelayLaw::Constant { seconds: 0.1 };
    let plain = JointSpec::new("joint", input, delay);
    let spikes = Some(Spikes { share: 0.002, size: 5.0 });
    let banded =
        JointSpec { dead_band: Some([-0.4, 0.3]), lag_s: Some(0.1), spikes, ..plain.clone() };
    let range = Some([-10.0, 50.0]);
    let cylinder = Some(CylinderSpec::default());
    let moved = JointSpec { start: 20.0, range, cylinder, ..plain };
    let made = |spec| simulate(&PlantSpec::new(3, seconds, vec![spec])).unwrap().joints.remove(0);
    vec![made(banded), made(moved)]
}

fn plus(model: &JointModel, id: &str) -> JointModel {
    model.with(Component::neutral(find(id).unwrap()))
}

/// The sum of squares of the training windows, without spikes.
fn squares(record: &FitRecord<'_>, model: &JointModel) -> f64 {
    let residuals = record.evaluate(model).residuals;
    let of_window = |trial: usize, start: usize, end: usize| {
        let counts = |k: usize| record.weights_of(trial).map_or(1.0, |weights| weights[k]);
        (start..end).map(|k| counts(k) * residuals[trial][k].powi(2)).sum::<f64>()
    };
    record.part(Part::Training).map(|w| of_window(w.trial, w.start, w.end)).sum()
}

/// Fits `model`, and holds the error against that of the start and against what is reported.
fn fitted(record: &FitRecord<'_>, model: &JointModel, what: &str) -> Fit {
    let range = record.range_for(model);
    let fit = fit(record, model, &range).unwrap();
    let start = squares(record, model);
    assert!(fit.cost <= start * (1.0 + ROUNDING), "{what}: {} from {start}", fit.cost);
    let reported = squares(record, &fit.model);
    assert!((fit.cost / reported - 1.0).abs() < ROUNDING, "{what}: {} is {reported}", fit.cost);
    let error = ErrorFigures::of(record, &fit.evaluation, Part::Training).unwrap();
    let windows = record.part(Part::Training);
    let counted = windows.map(|window| match record.weights_of(window.trial) {
        Some(weights) => weights[window.start..window.end].iter().sum(),
        None => (window.end - window.start) as f64,
    });
    let mean = fit.cost / counted.sum::<f64>();
    assert!((error.rmse.powi(2) / mean - 1.0).abs() < ROUNDING, "{what}: {error:?}");
    fit
}

/// Every effect on one base, on one joint.
fn every_effect_on(joint: &Joint, base: &[&str], horizon: Horizon, what: &str) {
    let record = FitRecord::new(joint, Split::of(joint), horizon);
    let span = |values: &mut dyn Iterator<Item = f64>| {
        let (low, high) = values.fold((f64::MAX, f64::MIN), |(l, h), y| (l.min(y), h.max(y)));
        high - low
    };
    let outputs = span(&mut joint.trials.iter().flat_map(|t| t.output().iter().copied()));
    let inputs = span(&mut joint.trials.iter().flat_map(|t| t.input().iter().copied()));
    let plain = JointModel::integrator(outputs / inputs, 0.1);
    let model = base.iter().fold(plain, |model, id| plus(&model, id));
    let before = fitted(&record, &model, &format!("{what}, {base:?}"));
    for effect in REGISTRY {
        let id = effect.spec().id;
        let with = plus(&before.model, id);
        if base.contains(&id) || with.components().len() <= base.len() {
            continue;
        }
        let what = format!("{what}, {base:?} + {id}");
        let after = fitted(&record, &with, &what);
        let (less, more) = (after.cost, before.cost);
        assert!(less <= more * (1.0 + ROUNDING), "{what}: {less}, without {more}");
    }
}

#[test]
fn no_effect_makes_the_training_error_of_a_synthetic_log_larger() {
    for (index, joint) in synthetic(size(15.0, 120.0)).iter().enumerate() {
        let some = [BASES[index], BASES[3 + index]];
        for base in size(&some[..], &BASES[..]) {
            every_effect_on(joint, base, Horizon::Steps, &format!("synthetic {index}"));
        }
    }
}

/// In the small sample one base and horizon of every other log, and a part of the samples; the whole
/// one takes an hour.
#[test]
fn no_effect_makes_the_training_error_of_a_measured_log_larger() {
    for (index, log) in LOGS.into_iter().enumerate().step_by(size(2, 1)) {
        let Some(joint) = measured(log, size(log.3, 1)) else { continue };
        let bases = size(&BASES[index % BASES.len()..][..1], &BASES[..]);
        let horizons = size(&HORIZONS[index / 2 % 2..][..1], &HORIZONS[..]);
        for (base, horizon) in bases.iter().flat_map(|base| horizons.iter().map(move |h| (base, h)))
        {
            every_effect_on(&joint, base, *horizon, log.0);
        }
    }
}
