//! The delay table: rows by kind of step and level, the same in every form.

use std::path::Path;
use std::process::Command;

use serde_json::Value;
use tauscope::batch::Threads;
use tauscope::delay::Transition::{Reversal, Start, Stop};
use tauscope::delay::{DelayTable, Method, Neutral, Settings};
use tauscope::experiment::Joint;
use tauscope::report::EstimatedJoint;
use tauscope::study::estimate_joints;
use tauscope::synthetic::{DelayLaw, InputSpec, JointSpec, PlantSpec, simulate};

fn joint(levels: &[f64], law: DelayLaw) -> Joint {
    let input = InputSpec::Levels { levels: levels.to_vec(), hold_s: [0.8, 1.6] };
    let spec = JointSpec { noise: 0.01, ..JointSpec::new("boom", input, law) };
    simulate(&PlantSpec::new(5, 200.0, vec![spec])).unwrap().joints.remove(0)
}

/// The delay table of `joint`.
fn table(joint: &Joint) -> DelayTable {
    let settings = Settings { low_pass: None, beta: 1, ..Settings::of(Method::TWO_LINE) };
    let estimates = estimate_joints(std::slice::from_ref(joint), &settings, || (), &Threads);
    EstimatedJoint { joint, estimate: estimates[0].as_ref().unwrap() }.delay_table()
}

fn run(arguments: &[&str]) -> String {
    let output = Command::new(env!("CARGO_BIN_EXE_tauscope")).args(arguments).output().unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout).unwrap()
}

#[test]
fn each_kind_has_its_own_rows_and_their_steps_are_all_steps() {
    let joint = joint(&[-2.0, 0.0, 2.0], DelayLaw::Direction { rising: 0.1, falling: 0.3 });
    let found = table(&joint);
    let kinds = found.rows.iter().map(|row| (row.transition, row.level_from, row.level_to));
    let kinds: Vec<_> = kinds.collect();
    let expected = [
        (Start, 0.0, -2.0),
        (Start, 0.0, 2.0),
        (Stop, -2.0, 0.0),
        (Stop, 2.0, 0.0),
        (Reversal, -2.0, 2.0),
        (Reversal, 2.0, -2.0),
    ];
    assert_eq!(kinds, expected);
    for row in &found.rows {
        let delay = row.delay.unwrap();
        let truth = if row.level_to > row.level_from { 0.1 } else { 0.3 };
        let (low, high) = delay.interval_s.unwrap();
        assert!((delay.median_s - truth).abs() < 0.015, "{row:?}");
        assert!(delay.min_s <= low && low <= delay.median_s && high <= delay.max_s, "{row:?}");
    }
    let steps: usize = found.rows.iter().map(|row| row.steps).sum();
    let of_kinds: usize = found.kinds.iter().map(|kind| kind.steps).sum();
    assert_eq!(steps, of_kinds);
}

#[test]
fn many_levels_are_put_together_in_bins_that_leave_no_step_out() {
    let levels: Vec<f64> = (-20..=20).map(|k| 0.1 * f64::from(k)).collect();
    let joint = joint(&levels, DelayLaw::Constant { seconds: 0.2 });
    let found = table(&joint);
    assert!(found.rows.len() <= 24, "{}", found.rows.len());
    let steps: usize = found.rows.iter().map(|row| row.steps).sum();
    assert_eq!(steps, found.kinds.iter().map(|kind| kind.steps).sum::<usize>());
    for row in &found.rows {
        assert!(row.from_limits.0 <= row.level_from && row.level_from <= row.from_limits.1);
        assert!(row.to_limits.0 <= row.level_to && row.level_to <= row.to_limits.1);
    }
    let neutral = Neutral::of(&joint.trials).unwrap();
    assert!(neutral.level.abs() < 1e-9);
}

#[test]
fn the_file_and_the_json_have_the_same_rows() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("table.csv");
    let log = "data/manipulator.csv";
    let json = run(&["estimate", log, "-q", "--format", "json", "--table", file.to_str().unwrap()]);
    let json: Value = serde_json::from_str(&json).unwrap();
    let joints = json["joints"].as_array().unwrap();
    let rows: Vec<&Value> =
        joints.iter().flat_map(|joint| joint["delay_table"].as_array().unwrap()).collect();
    let mut reader = csv::Reader::from_path(Path::new(&file)).unwrap();
    let header = "joint,transition,level_from,level_to,steps,accepted,delay_median_s,delay_low_s,\
                  delay_high_s,delay_min_s,delay_max_s";
    assert_eq!(reader.headers().unwrap().iter().collect::<Vec<_>>().join(","), header);
    let records: Vec<csv::StringRecord> = reader.records().map(Result::unwrap).collect();
    assert!(records.len() > 50 && records.len() == rows.len());
    for (record, row) in records.iter().zip(rows) {
        for (name, cell) in header.split(',').zip(record) {
            match &row[name] {
                Value::String(text) => assert_eq!(text, cell),
                Value::Null => assert_eq!(cell, ""),
                number => assert_eq!(number.as_f64(), cell.parse().ok(), "{name}"),
            }
        }
    }
}

#[test]
fn a_kind_with_few_accepted_steps_has_no_typical_delay_and_says_why() {
    let text = run(&["estimate", "data/worked_example.csv", "-q", "--table", "/dev/null"]);
    let start = text.lines().find(|line| line.starts_with("start: ")).unwrap();
    assert!(start.contains("no typical delay: too few accepted steps (0 of 1)"), "{start}");
    assert!(start.contains("first or last step of the trial"), "{start}");
}
