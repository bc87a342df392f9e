//! The methods that find delays: samples per second on one core.
#![expect(clippy::unwrap_used, reason = "a benchmark may fail loudly")]

use std::hint::black_box;

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use tauscope::delay::{Method, Settings, estimate};
use tauscope::experiment::Trial;
use tauscope::synthetic::{DelayLaw, InputSpec, JointSpec, PlantSpec, simulate};

/// One lagged joint at 100 Hz.
fn trial(samples: usize, hold_s: [f64; 2]) -> Trial {
    let input = InputSpec::Levels { levels: vec![-1.0, -0.5, 0.5, 1.0], hold_s };
    let law = DelayLaw::Uniform { min: 0.05, max: 0.4 };
    let joint = JointSpec { noise: 0.05, lag_s: Some(0.06), ..JointSpec::new("joint", input, law) };
    let spec = PlantSpec { substeps: 2, ..PlantSpec::new(1, samples as f64 * 0.01, vec![joint]) };
    simulate(&spec).unwrap().joints[0].trials[0].clone()
}

fn methods(criterion: &mut Criterion) {
    for (name, hold_s) in [("holds of 5 to 9 s", [5.0, 9.0]), ("holds of 0.9 to 2 s", [0.9, 2.0])] {
        let mut group = criterion.benchmark_group(format!("methods, {name}"));
        group.sample_size(10);
        for samples in [10_000, 100_000, 1_000_000] {
            let trial = trial(samples, hold_s);
            group.throughput(Throughput::Elements(samples as u64));
            for method in Method::ALL {
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
