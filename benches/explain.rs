//! What a model lacks, and mending it: how the time grows with samples, effects and joints.
#![expect(clippy::unwrap_used, reason = "a benchmark may fail loudly")]

use std::hint::black_box;
use std::time::Duration;

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use tauscope::batch::Threads;
use tauscope::delay::Settings;
use tauscope::effect::{Effect, REGISTRY, find};
use tauscope::experiment::Joint;
use tauscope::explain::Options;
use tauscope::fit::Horizon;
use tauscope::study::{Mode, Protocol, estimate_joints, explain_joints, improve_joints};
use tauscope::synthetic::{DelayLaw, InputSpec, JointSpec, PlantSpec, simulate};

/// Joints at 100 Hz that all hide a dead band, or three effects: a lag, too, and another gain
/// for each direction.
fn joints(samples: usize, count: usize, hidden: usize) -> Vec<Joint> {
    let levels = vec![-2.0, -1.5, -1.0, -0.5, 0.5, 1.0, 1.5, 2.0];
    let joint = |index: usize| {
        let input = InputSpec::Levels { levels: levels.clone(), hold_s: [0.8, 1.6] };
        let law = DelayLaw::Constant { seconds: 0.12 };
        let spec = JointSpec::new(&format!("joint{index}"), input, law);
        let dead_band = Some([-0.3, 0.3]);
        let spec = JointSpec { noise: 0.05, dead_band, ..spec };
        if hidden == 1 {
            return spec;
        }
        let mut spec = JointSpec { lag_s: Some(0.1), ..spec };
        spec.hide("direction_gain", &[("negative_factor".to_owned(), 0.7)]).unwrap();
        spec
    };
    let specs = (0..count).map(joint).collect();
    simulate(&PlantSpec::new(3, samples as f64 * 0.01, specs)).unwrap().joints
}

/// Six effects that include what is hidden.
fn six() -> Vec<&'static dyn Effect> {
    let ids = [
        "dead_band",
        "input_saturation",
        "direction_gain",
        "actuator_lag",
        "gravity_load",
        "thermal_drift",
    ];
    ids.map(|id| find(id).unwrap()).to_vec()
}

const PROTOCOL: Protocol =
    Protocol { mode: Mode::FitOrIntegrator, split: None, horizon: Horizon::Auto };

fn explain(joints: &[Joint], effects: &[&'static dyn Effect]) {
    let estimates = estimate_joints(joints, &Settings::default(), || (), &Threads);
    let options = Options { effects: effects.to_vec(), ..Options::default() };
    black_box(explain_joints(joints, &estimates, |_| None, PROTOCOL, &options, &Threads));
}

fn improve(joints: &[Joint], effects: &[&'static dyn Effect]) {
    let estimates = estimate_joints(joints, &Settings::default(), || (), &Threads);
    let options = Options { effects: effects.to_vec(), ..Options::default() };
    let every = |_, _: &_| true;
    black_box(improve_joints(joints, &estimates, |_| None, PROTOCOL, &options, every, &Threads));
}

/// A command that is measured.
type Work = fn(&[Joint], &[&'static dyn Effect]);

fn growth(criterion: &mut Criterion) {
    let works: [(&str, Work); 2] = [("explain", explain), ("improve", improve)];
    for (name, work) in works {
        let mut group = criterion.benchmark_group(name);
        group.sample_size(10).warm_up_time(Duration::from_millis(100));
        let mut measure = |what: &str, number: usize, joints: &[Joint], effects: &[_]| {
            let samples: usize = joints.iter().map(|joint| joint.trials[0].len()).sum();
            group.throughput(Throughput::Elements(samples as u64));
            let id = BenchmarkId::new(what, number);
            group.bench_function(id, |bencher| bencher.iter(|| work(joints, effects)));
        };
        for samples in [3_000, 12_000, 48_000] {
            measure("samples", samples, &joints(samples, 1, 1), REGISTRY);
        }
        measure("effects", 6, &joints(12_000, 1, 1), &six());
        measure("joints", 4, &joints(12_000, 4, 1), REGISTRY);
        measure("hidden", 3, &joints(12_000, 1, 3), REGISTRY);
        group.finish();
    }
}

criterion_group!(benches, growth);
criterion_main!(benches);
