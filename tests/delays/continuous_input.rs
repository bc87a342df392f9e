//! A joint driven by a joystick: one dead time over the record, and no step.

use std::fmt::Write as _;
use std::path::Path;
use std::process::Command;

use serde_json::Value;

/// The joint follows its stick so late.
const DEAD_TIME_S: f64 = 0.12;

/// A stick that somebody moves.
fn stick(time_s: f64) -> f64 {
    let waves = [(0.11, 0.3), (0.23, 1.0), (0.41, 2.0), (0.77, 4.0)];
    let sum: f64 =
        waves.iter().map(|(hz, phase)| (std::f64::consts::TAU * hz * time_s + phase).sin()).sum();
    (sum.signum() * (sum.abs() - 0.5).max(0.0)).clamp(-1.5, 1.5)
}

/// A log of 40 s at 50 Hz: `boom` has a stick, a dead band and a sensor with noise, `swing` is
/// driven by steps. The motion is integrated in steps of 1 ms.
fn log(folder: &Path) -> String {
    let mut text = "time_s,boom.input,boom.output,swing.input,swing.output\n".to_owned();
    let (mut boom, mut swing, mut speed) = (0.0, 0.0, 0.0);
    let level = |time_s: f64| if (time_s / 1.7).rem_euclid(2.0) < 1.0 { 1.0 } else { -1.0 };
    for sample in 0..2000_u32 {
        let time_s = f64::from(sample) * 0.02;
        let wild = (f64::from(sample) * 12.9898).sin() * 43_758.545;
        let noise = 0.02 * (wild - wild.floor() - 0.5);
        writeln!(text, "{time_s},{},{},{},{swing}", stick(time_s), boom + noise, level(time_s))
            .unwrap();
        for fine in 0..20_u32 {
            let then = time_s + 0.001 * f64::from(fine) - DEAD_TIME_S;
            // Held since the last sample.
            let then = (then / 0.02 + 1e-9).floor() * 0.02;
            let u = stick(then);
            let opened = u.signum() * (u.abs() - 0.2).max(0.0);
            speed += (10.0 * opened - speed) / 40.0;
            boom += 0.001 * speed;
            swing += 0.001 * 8.0 * level(then);
        }
    }
    let path = folder.join("log.csv");
    std::fs::write(&path, text).unwrap();
    path.to_str().unwrap().to_owned()
}

fn tauscope(arguments: &[&str]) -> String {
    let output = Command::new(env!("CARGO_BIN_EXE_tauscope")).args(arguments).output().unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout).unwrap()
}

fn joints(arguments: &[&str]) -> Vec<Value> {
    let json: Value = serde_json::from_str(&tauscope(arguments)).unwrap();
    json["joints"].as_array().unwrap().clone()
}

#[test]
fn a_joystick_has_one_dead_time_with_its_interval_and_no_step() {
    let folder = tempfile::tempdir().unwrap();
    let log = log(folder.path());
    let delays = folder.path().join("delays.csv");
    let found = joints(&[
        "estimate",
        &log,
        "--quiet",
        "--format",
        "json",
        "--delays",
        delays.to_str().unwrap(),
    ]);
    let boom = &found[0];
    assert_eq!((&boom["steps"], &boom["input"]["kind"]), (&0.into(), &"continuous".into()));
    let dead_time = &boom["dead_time"];
    let number = |name: &str| dead_time[name].as_f64().unwrap();
    assert_eq!(dead_time["verdict"], "dead_time");
    assert!((number("value_s") - DEAD_TIME_S).abs() < 0.01, "{dead_time}");
    assert!(number("low_s") <= number("value_s") && number("value_s") <= number("high_s"));
    assert!(number("high_s") - number("low_s") < 0.04, "{dead_time}");
    assert!((number("lag_s") - 0.04).abs() < 0.015, "{dead_time}");
    assert!(dead_time["reason"].as_str().unwrap().contains("the input moves all the time"));
    let windows = dead_time["windows"].as_array().unwrap();
    assert!(windows.iter().any(|window| window["value_s"].is_f64()), "{dead_time}");
    // The other joint is as ever.
    let swing = &found[1];
    assert_eq!(swing["input"]["kind"], "steps");
    assert!(swing["dead_time"].is_null() && swing["accepted"].as_u64().unwrap() > 15);
    let table = std::fs::read_to_string(delays).unwrap();
    let mut tau =
        table.lines().skip(1).filter_map(|line| line.split(',').nth(3)?.parse::<f64>().ok());
    assert!(tau.all(|tau| (tau * 0.02 - DEAD_TIME_S).abs() < 0.05));
}

#[test]
fn the_input_can_be_declared() {
    let folder = tempfile::tempdir().unwrap();
    let log = log(folder.path());
    let steps = joints(&["estimate", &log, "--quiet", "--format", "json", "--input", "steps"]);
    assert!(steps[0]["steps"].as_u64().unwrap() > 50 && steps[0]["dead_time"].is_null());
    let moves = joints(&["estimate", &log, "--quiet", "--format", "json", "--input", "continuous"]);
    assert_eq!(moves[1]["steps"], 0);
    assert!((moves[1]["dead_time"]["value_s"].as_f64().unwrap() - DEAD_TIME_S).abs() < 0.01);
}

#[test]
fn every_command_takes_such_a_log() {
    let folder = tempfile::tempdir().unwrap();
    let log = log(folder.path());
    let text = tauscope(&["estimate", &log, "--quiet"]);
    assert!(text.contains("boom: the input moves all the time (it changes at "), "{text}");
    assert!(text.contains("boom: dead time 0.1"), "{text}");
    // No setting of a sweep has an influence: that is said, and the joint with steps is swept.
    let sweep = Command::new(env!("CARGO_BIN_EXE_tauscope"))
        .args(["sweep", &log, "--quiet", "--alpha", "10", "--beta", "5", "--method", "two-line"])
        .output()
        .unwrap();
    let said = String::from_utf8_lossy(&sweep.stderr).into_owned();
    assert_eq!(sweep.status.code(), Some(1), "{said}");
    assert!(said.contains("`boom` is left out: the input moves all the time"), "{said}");
    tauscope(&["compare", &log, "--quiet", "--joint", "boom"]);
    let page = folder.path().join("page.html");
    tauscope(&["report", &log, "--quiet", "-o", page.to_str().unwrap()]);
    let page = std::fs::read_to_string(page).unwrap();
    assert!(page.contains("dead time 0.1"), "the page says it");
}
