//! The search for the best pair of lines: samples per second on one core.

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use std::hint::black_box;
use tauscope::delay::Candidates;

/// A kink in the middle, with a little of everything above it.
fn segment(samples: usize) -> Vec<f64> {
    let noise = |k: usize| ((k * 2_654_435_761) % 1000) as f64 * 1e-5;
    (0..samples).map(|k| 0.1 * k.abs_diff(samples / 2) as f64 + noise(k)).collect()
}

/// How the search grows with the segment, from a short hold to a whole record.
fn search(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("search");
    for samples in [150, 1_500, 100_000, 10_000_000] {
        let values = segment(samples);
        group.throughput(Throughput::Elements(samples as u64));
        if samples > 1_000_000 {
            group.sample_size(10);
        }
        for beta in [1, 5] {
            let id = BenchmarkId::new(format!("beta {beta}"), samples);
            group.bench_with_input(id, &values, |bencher, values| {
                bencher.iter(|| Candidates::search(black_box(values), 1, beta));
            });
        }
    }
    group.finish();
}

criterion_group!(benches, search);
criterion_main!(benches);
