//! Where a model fails: 12,000 samples with an error of two clauses, and with none.

use std::hint::black_box;

use criterion::{Criterion, criterion_group, criterion_main};
use rand::{Rng as _, SeedableRng as _};
use rand_chacha::ChaCha8Rng;
use tauscope::diagnosis::failure::{RecordError, ResidualRecord, Samples, diagnose};

const SAMPLES: usize = 12_000;
const HOLD: usize = 150;

/// A joint driven by steps, whose residual is five times as large where `fails`.
fn record(fails: fn(f64, f64) -> bool) -> Result<ResidualRecord, RecordError> {
    let mut random = ChaCha8Rng::seed_from_u64(1);
    let mut samples = Samples { trial: vec![0; SAMPLES], ..Samples::default() };
    let (mut level, mut output) = (0.0, 0.0_f64);
    for index in 0..SAMPLES {
        let noise = f64::from(random.next_u32()) / f64::from(u32::MAX) - 0.5;
        if index % HOLD == 0 {
            level = (8.0 * noise).round() - output.signum();
        }
        output += 0.1 * level;
        samples.input.push(level);
        samples.output.push(output);
        samples.speed.push(10.0 * level + noise);
        let size = if fails(level, output) { 5.0 } else { 1.0 };
        samples.residual.push(size * (f64::from(random.next_u32()) / f64::from(u32::MAX) - 0.5));
    }
    samples.time_s = (0..SAMPLES).map(|k| 0.01 * k as f64).collect();
    samples.since_step_s = (0..SAMPLES).map(|k| 0.01 * (k % HOLD) as f64).collect();
    samples.hold_s = vec![0.01 * HOLD as f64; SAMPLES];
    let segments = (0..SAMPLES).step_by(HOLD).map(|start| start..start + HOLD).collect();
    ResidualRecord::new(samples, vec!["1".to_owned()], segments)
}

fn benches(criterion: &mut Criterion) {
    let mut bench = |name: &str, fails| {
        if let Ok(record) = record(fails) {
            let residual = || record.samples().residual.iter().copied();
            criterion.bench_function(name, |run| {
                run.iter(|| diagnose(black_box(&record), residual()));
            });
        }
    };
    bench("diagnose/two clauses", |level, output| level.abs() < 2.5 && output > 0.0);
    bench("diagnose/nothing", |_, _| false);
}

criterion_group!(group, benches);
criterion_main!(group);
