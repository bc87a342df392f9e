//! The whole of `estimate`: smoothing, decisions, and what is written.
#![expect(clippy::unwrap_used, reason = "a benchmark may fail loudly")]

use std::hint::black_box;

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use tauscope::batch::{Threads, with_threads};
use tauscope::delay::Settings;
use tauscope::experiment::{Experiment, Joint, ReadOptions};
use tauscope::study::{JointEstimate, estimate_joints};
use tauscope::synthetic::{DelayLaw, InputSpec, JointSpec, PlantSpec, simulate, write_log};

/// Joints at 100 Hz with holds of 5 to 9 s: 2,000 decisions in 14 × 100,000 samples.
fn joints(count: usize, samples: usize) -> Vec<Joint> {
    let joint = |index: usize| {
        let input = InputSpec::Levels { levels: vec![-1.0, -0.5, 0.5, 1.0], hold_s: [5.0, 9.0] };
        let law = DelayLaw::Uniform { min: 0.01, max: 0.8 };
        JointSpec { noise: 0.05, ..JointSpec::new(&format!("joint_{index:02}"), input, law) }
    };
    let spec = PlantSpec {
        substeps: 1,
        ..PlantSpec::new(1, samples as f64 * 0.01, (0..count).map(joint).collect())
    };
    simulate(&spec).unwrap().joints
}

fn estimated(joints: &[Joint], settings: &Settings) -> Vec<JointEstimate> {
    estimate_joints(joints, settings, || (), &Threads).into_iter().map(Result::unwrap).collect()
}

/// One joint, longer and longer.
fn growth(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("estimate, growth");
    group.sample_size(10);
    let settings = Settings::default();
    for samples in [10_000, 100_000, 1_000_000, 10_000_000] {
        let joints = joints(1, samples);
        group.throughput(Throughput::Elements(samples as u64));
        group.bench_with_input(BenchmarkId::from_parameter(samples), &joints, |bencher, joints| {
            bencher.iter(|| estimated(black_box(joints), &settings));
        });
    }
    group.finish();
}

/// Fourteen joints of 100,000 samples: on one thread, on all, reading, and recording.
fn fourteen_joints(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("14 joints x 100,000 samples");
    group.sample_size(10).throughput(Throughput::Elements(1_400_000));
    let settings = Settings::default();
    let joints = joints(14, 100_000);
    for threads in [Some(1), None] {
        let name = threads.map_or("all threads".to_owned(), |n| format!("{n} thread"));
        group.bench_function(BenchmarkId::new("estimate", name), |bencher| {
            let work = || estimated(&joints, &settings);
            bencher.iter(|| with_threads(threads, work).unwrap());
        });
    }
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("log.csv");
    let made = tauscope::synthetic::Synthetic { joints: joints.clone(), truth: Vec::new() };
    write_log(&made, std::fs::File::create(&path).unwrap()).unwrap();
    group.bench_function("read the CSV", |bencher| {
        let read = || Experiment::read(std::slice::from_ref(&path), &ReadOptions::default());
        bencher.iter(read);
    });
    #[cfg(feature = "rrd")]
    record(&mut group, &joints, &settings);
    group.finish();
}

#[cfg(feature = "rrd")]
fn record(
    group: &mut criterion::BenchmarkGroup<'_, criterion::measurement::WallTime>,
    joints: &[Joint],
    settings: &Settings,
) {
    use tauscope::recording::{Detail, Recording, write_recording};
    use tauscope::report::EstimatedJoint;

    let reading = ReadOptions::default();
    let estimates = estimated(joints, settings);
    let pairs = joints.iter().zip(&estimates);
    let joints: Vec<_> =
        pairs.map(|(joint, estimate)| EstimatedJoint { joint, estimate }).collect();
    for (name, detail) in [("full", Detail::Full), ("lean", Detail::Lean)] {
        let recording = Recording {
            command: "estimate",
            joints: &joints,
            settings,
            sources: &[],
            reading: &reading,
            detail,
            models: &[],
            also: &[],
            revisions: &[],
        };
        group.bench_function(BenchmarkId::new("record", name), |bencher| {
            bencher.iter(|| {
                let file = std::io::BufWriter::new(tempfile::tempfile().unwrap());
                write_recording(&recording, file).unwrap();
            });
        });
    }
}

criterion_group!(benches, growth, fourteen_joints);
criterion_main!(benches);
