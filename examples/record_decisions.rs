//! Delays recorded beside a program's own Rerun data.
#![expect(clippy::print_stdout, reason = "an example prints")]

use std::path::PathBuf;

use rerun::{RecordingStreamBuilder, Scalars};
use tauscope::batch::Threads;
use tauscope::delay::Settings;
use tauscope::experiment::{Experiment, ReadOptions};
use tauscope::recording::{Detail, Recording, log_recording};
use tauscope::report::EstimatedJoint;
use tauscope::study::estimate_joints;

fn main() -> anyhow::Result<()> {
    let file = std::env::temp_dir().join("tauscope-record-decisions.rrd");
    let stream = RecordingStreamBuilder::new("my_experiment").save(&file)?;

    // What the program logs itself, on the same timelines.
    for sample in 0..100_i32 {
        stream.set_time_sequence("sample", sample);
        stream.log("oil/temperature", &Scalars::single(40.0 + 0.01 * f64::from(sample)))?;
    }

    let paths = [PathBuf::from("data/worked_example.csv")];
    let experiment = Experiment::read(&paths, &ReadOptions::default());
    let settings = Settings::default();
    let mut estimates = Vec::new();
    for estimate in estimate_joints(&experiment.joints, &settings, || (), &Threads) {
        estimates.push(estimate?);
    }
    let pairs = experiment.joints.iter().zip(&estimates);
    let joints: Vec<_> =
        pairs.map(|(joint, estimate)| EstimatedJoint { joint, estimate }).collect();
    let recording = Recording {
        command: "estimate",
        joints: &joints,
        settings: &settings,
        sources: &experiment.sources,
        reading: &experiment.options,
        detail: Detail::Full,
        models: &[],
        also: &[],
        revisions: &[],
    };
    log_recording(&recording, &stream)?;
    stream.flush_blocking()?;
    println!("open it with: rerun {}", file.display());
    Ok(())
}

#[test]
fn runs() -> anyhow::Result<()> {
    main()
}
