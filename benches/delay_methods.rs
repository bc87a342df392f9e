//! The methods that find delays: samples per second on one core.
#![expect(clippy::unwrap_used, reason = "a benchmark may fail loudly")]

use std::hint::black_box;

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use tauscope::delay::{Method, Settings, estimate};
use tauscope::experiment::Trial;
use tauscope::synthetic::{DelayLaw, InputSpec, JointSpec, PlantSpec, simulate};

/// One joint at 100 Hz, that only integrates or lags as well.
fn trial(samples: usize, hold_s: [f64; 2], lag_s: Option<f64>) -> Trial {
    let input = InputSpec::Levels { levels: vec![-1.0, -0.5, 0.5, 1.0], hold_s };
    let law = DelayLaw::Uniform { min: 0.05, max: 0.4 };
    let joint = JointSpec { noise: 0.05, lag_s, ..JointSpec::new("joint", input, law) };
    let spec = PlantSpec { substeps: 2, ..PlantSpec::new(1, samples as f64 * 0.01, vec![joint]) };
    simulate(&spec).unwrap().joints[0].trials[0].clone()
}

fn methods(criterion: &mut Criterion) {
    let holds = [("holds of 5 to 9 s", [5.0, 9.0]), ("holds of 0.9 to 2 s", [0.9, 2.0])];
    let joints = [("no lag", None), ("a lag of 0.06 s", Some(0.06))];
    for ((holds, hold_s), (joint, lag_s)) in
        holds.into_iter().flat_map(|holds| joints.map(|joint| (holds, joint)))
    {
        let mut group = criterion.benchmark_group(format!("methods, {holds}, {joint}"));
        group.sample_size(10);
        for samples in [10_000, 100_000, 1_000_000] {
            let trial = trial(samples, hold_s, lag_s);
            group.throughput(Throughput::Elements(samples as u64));
            for method in Method::all() {
                let settings = Settings::of(method);
                let id = BenchmarkId::new(method.id(), samples);
                group.bench_with_input(id, &trial, |bencher, trial| {
                    bencher.iter(|| estimate(black_box(trial), &settings).unwrap());
                });
            }
        }
        group.finish();
    }
}

criterion_group!(benches, methods);
criterion_main!(benches);
