//! A model on a record: simulating it, and fitting it.
#![expect(clippy::unwrap_used, reason = "a benchmark may fail loudly")]

use std::hint::black_box;

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use tauscope::effect::expression::define;
use tauscope::effect::{Definition, OwnParameter, Stage, find};
use tauscope::experiment::Joint;
use tauscope::fit::{FitRecord, Horizon, Split, fit};
use tauscope::model::{Commands, Component, JointModel, Surroundings, simulate};
use tauscope::synthetic::{DelayLaw, InputSpec, JointSpec, PlantSpec};

/// A joint at 100 Hz with holds of 1 to 2 s.
fn joint(samples: usize) -> Joint {
    let input = InputSpec::Levels { levels: vec![-1.0, -0.5, 0.2, 0.5, 1.0], hold_s: [1.0, 2.0] };
    let law = DelayLaw::Constant { seconds: 0.15 };
    let spec = JointSpec { noise: 0.05, lag_s: Some(0.1), ..JointSpec::new("joint", input, law) };
    let plant = PlantSpec { substeps: 1, ..PlantSpec::new(1, samples as f64 * 0.01, vec![spec]) };
    tauscope::synthetic::simulate(&plant).unwrap().joints.remove(0)
}

fn model(effects: &[(&str, &[f64])]) -> JointModel {
    let component = |(id, values): &(&str, &[f64])| {
        let values = values.iter().map(|value| (*value).into()).collect();
        Component::new(find(id).unwrap(), values).unwrap()
    };
    let plain = JointModel::integrator(9.0, 0.123);
    effects.iter().map(component).fold(plain, |model, component| model.with(component))
}

/// A knee in the flow, as a user would write it.
fn knee() -> Component {
    let own = define(Definition {
        id: "knee".to_owned(),
        summary: None,
        stage: Stage::Input,
        expression: "if(signal > start, start + slope * (signal - start), signal)".to_owned(),
        states: Vec::new(),
        parameters: vec![OwnParameter::new("start", 0.5), OwnParameter::new("slope", 0.8)],
    });
    Component::new(own.unwrap(), vec![0.5.into(), 0.8.into()]).unwrap()
}

/// From nothing to one effect of each kind.
fn models() -> [(&'static str, JointModel); 5] {
    [
        ("expression", JointModel::integrator(9.0, 0.123).with(knee())),
        ("plain", model(&[])),
        ("lag", model(&[("actuator_lag", &[0.1])])),
        ("valve and lag", model(&VALVE_AND_LAG)),
        ("five effects", model(&FIVE)),
    ]
}

const VALVE_AND_LAG: [(&str, &[f64]); 5] = [
    ("input_offset", &[0.05]),
    ("dead_band", &[-0.1, 0.1]),
    ("input_saturation", &[0.9, 0.1]),
    ("direction_gain", &[0.8]),
    ("actuator_lag", &[0.1]),
];

const FIVE: [(&str, &[f64]); 5] = [
    ("dead_band", &[-0.1, 0.1]),
    ("direction_gain", &[0.8]),
    ("actuator_lag", &[0.1]),
    ("leakage", &[0.01, 0.0]),
    ("backlash", &[0.5]),
];

fn simulation(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("simulate");
    group.sample_size(20);
    let samples = 100_000;
    let joint = joint(samples);
    let trial = &joint.trials[0];
    group.throughput(Throughput::Elements(samples as u64));
    for (name, model) in models() {
        group.bench_with_input(name, &model, |bencher, model| {
            bencher.iter(|| {
                let arrivals = Commands::new(trial.input(), 0.01).arriving(model, 0.0, None);
                simulate(black_box(model), &arrivals, samples, 0.01, &[], &Surroundings::default())
            });
        });
    }
    group.finish();
}

/// Gain, delay and a lag, from neutral.
fn growth(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("fit, growth");
    group.sample_size(10);
    let model = JointModel::integrator(9.0, 0.1);
    let model = model.with(Component::neutral(find("actuator_lag").unwrap()));
    for samples in [10_000, 100_000, 1_000_000] {
        let joint = joint(samples);
        let record = FitRecord::new(&joint, Split::Time(0.7), Horizon::FreeRun);
        let range = record.range(10.0);
        group.throughput(Throughput::Elements(samples as u64));
        group.bench_function(BenchmarkId::from_parameter(samples), |bencher| {
            bencher.iter(|| fit(black_box(&record), &model, &range));
        });
    }
    group.finish();
}

criterion_group!(benches, simulation, growth);
criterion_main!(benches);
