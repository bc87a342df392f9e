//! The demonstration log against the true delay of every step.

use std::collections::BTreeMap;
use std::path::PathBuf;

use serde::Deserialize;
use tauscope::batch::Threads;
use tauscope::delay::{Method, Settings, Verdict};
use tauscope::experiment::{Experiment, ReadOptions};
use tauscope::study::estimate_joints;
use tauscope::synthetic::{PlantSpec, simulate, write_log, write_truth};

#[derive(Deserialize)]
struct Truth {
    joint: String,
    i: usize,
    hold_samples: f64,
    delay_samples: f64,
}

/// A step whose hold is longer than its delay: what became of it.
struct Judged {
    accepted: bool,
    error: Option<f64>,
    /// Whether the interval holds the truth, where there is one.
    held: Option<bool>,
}

fn judged(settings: &Settings) -> BTreeMap<String, Vec<Judged>> {
    let path = PathBuf::from("data/manipulator.csv");
    let experiment = Experiment::read(&[path], &ReadOptions::default());
    let estimates = estimate_joints(&experiment.joints, settings, || (), &Threads);
    let mut truth = csv::Reader::from_path("data/manipulator.truth.csv").unwrap();
    let mut judged: BTreeMap<String, Vec<Judged>> = BTreeMap::new();
    for step in truth.deserialize().map(Result::<Truth, _>::unwrap) {
        let joint = experiment.joints.iter().position(|joint| joint.name == step.joint).unwrap();
        let trial = estimates[joint].as_ref().unwrap().trials[0].as_ref().unwrap();
        let decision = &trial.decisions[step.i - 1];
        if step.hold_samples > step.delay_samples {
            let error = decision.delay().map(|delay| delay - step.delay_samples);
            let held = decision.fine.map(|it| (it.low..=it.high).contains(&step.delay_samples));
            let accepted = decision.verdict() == Verdict::Accepted;
            judged.entry(step.joint).or_default().push(Judged { accepted, error, held });
        }
    }
    judged
}

/// Algorithm 1 with candidates two samples apart.
fn by_lines() -> BTreeMap<String, Vec<Judged>> {
    judged(&Settings { beta: 2, ..Settings::of(Method::TWO_LINE) })
}

#[test]
fn at_least_95_percent_of_the_steps_are_accepted() {
    let judged = by_lines();
    let all = judged.values().flatten();
    let (accepted, all) = (all.clone().filter(|step| step.accepted).count(), all.count());
    assert!(all > 500);
    assert!(accepted * 100 >= 95 * all, "{accepted} of {all}");
}

#[test]
fn without_lag_the_median_error_is_below_one_and_a_half_samples() {
    let with_lag = ["wrist_pitch", "wrist_rotate"];
    let judged = by_lines();
    assert_eq!(judged.len(), 7);
    for (joint, steps) in &judged {
        let accepted = steps.iter().filter(|step| step.accepted);
        let mut errors: Vec<f64> = accepted.map(|step| step.error.unwrap().abs()).collect();
        errors.sort_by(f64::total_cmp);
        let median = errors[errors.len() / 2];
        if with_lag.contains(&joint.as_str()) {
            assert!(median > 3.0, "{joint}: lag is booked as delay, {median}");
        } else {
            assert!(median <= 1.5, "{joint}: {median}");
        }
    }
}

#[test]
fn the_table_of_the_document_is_what_comes_out() {
    let document = std::fs::read_to_string("docs/accuracy.md").unwrap();
    let judged = by_lines();
    let all: Vec<_> = judged.values().flatten().collect();
    let share = all.iter().filter(|step| step.accepted).count() as f64 / all.len() as f64;
    assert!(document.contains(&format!("{:.1} % are accepted", 100.0 * share)), "{share}");
    let by_onset = self::judged(&Settings::default());
    let mut wrong = Vec::new();
    for (joint, steps) in &judged {
        let row = document.lines().find(|line| line.starts_with(&format!("| {joint} "))).unwrap();
        let onsets = &by_onset[joint];
        let accepted = onsets.iter().filter(|step| step.accepted);
        let held = accepted.clone().filter(|step| step.held == Some(true)).count();
        let held = 100.0 * held as f64 / accepted.count() as f64;
        let numbers = format!("{}{} {held:.0} % |", errors(steps), errors(onsets));
        if !row.ends_with(&numbers) {
            wrong.push(format!("{joint}: {numbers} is not in {row}"));
        }
    }
    assert!(wrong.is_empty(), "{wrong:#?}");
}

/// Median, mean and bias of the accepted delays, as cells of a table.
fn errors(steps: &[Judged]) -> String {
    let accepted = steps.iter().filter(|step| step.accepted);
    let errors: Vec<f64> = accepted.map(|step| step.error.unwrap()).collect();
    let mut sizes: Vec<f64> = errors.iter().map(|error| error.abs()).collect();
    sizes.sort_by(f64::total_cmp);
    let count = sizes.len();
    let median = f64::midpoint(sizes[(count - 1) / 2], sizes[count / 2]);
    let mean = sizes.iter().sum::<f64>() / count as f64;
    let bias = errors.iter().sum::<f64>() / count as f64;
    format!(" {median:.2} | {mean:.2} | {bias:+.2} |")
}

#[test]
fn the_files_in_data_are_what_their_plants_make() {
    for name in ["manipulator", "worked_example"] {
        let plant = std::fs::read_to_string(format!("data/{name}.plant.toml")).unwrap();
        let made = simulate(&PlantSpec::from_toml(&plant).unwrap()).unwrap();
        let (mut log, mut truth) = (Vec::new(), Vec::new());
        write_log(&made, &mut log).unwrap();
        write_truth(&made.truth, &mut truth).unwrap();
        assert!(log == std::fs::read(format!("data/{name}.csv")).unwrap(), "{name}.csv");
        assert!(truth == std::fs::read(format!("data/{name}.truth.csv")).unwrap(), "{name}");
    }
}
