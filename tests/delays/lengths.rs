//! Lengths of time in samples or in seconds, for all joints and for one.

use std::fmt::Write as _;
use std::fs;
use std::path::Path;
use std::process::{Command, Output};

use serde_json::Value;

/// Two joints that follow their steps 0.2 s late, at 10 ms and then at 20 ms.
fn log(periods: &[f64]) -> String {
    let mut text = "trial,time_s,arm.input,arm.output,boom.input,boom.output\n".to_owned();
    for (trial, period) in periods.iter().enumerate() {
        let level = |time: f64| if time < 0.0 { 0.0 } else { (time / 1.2).floor().rem_euclid(3.0) };
        let (mut angle, mut time) = (5.0, 0.0);
        while time < 12.0 {
            angle += 10.0 * period * level(time - 0.2);
            let (input, noise) = (level(time), 0.002 * (time * 1e4).sin());
            let output = angle + noise;
            writeln!(text, "{trial},{time:.3},{input},{output:.5},{input},{output:.5}").unwrap();
            time += period;
        }
    }
    text
}

fn run(folder: &Path, arguments: &[&str]) -> Output {
    let command = Command::new(env!("CARGO_BIN_EXE_tauscope"))
        .current_dir(folder)
        .args(arguments)
        .output()
        .unwrap();
    assert!(command.status.code().is_some());
    command
}

fn said(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

/// The joints of the JSON of `estimate` with these options.
fn estimated(folder: &Path, options: &str) -> Value {
    let options: Vec<&str> = options.split_whitespace().collect();
    let arguments = [&["estimate", "log.csv", "--format", "json", "-q"], &options[..]].concat();
    let output = run(folder, &arguments);
    assert!(output.status.success(), "{}", said(&output));
    serde_json::from_slice(&output.stdout).unwrap()
}

fn ends(joint: &Value, trial: &str) -> Vec<i64> {
    let decisions = joint["decisions"].as_array().unwrap().iter();
    let own = decisions.filter(|row| row["trial"] == trial);
    own.map(|row| row["end"].as_i64().unwrap() - row["p"].as_i64().unwrap()).collect()
}

#[test]
fn seconds_are_so_many_samples() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("log.csv"), log(&[0.01])).unwrap();
    for (seconds, samples) in [
        ("--max-delay 0.5s --alpha 0.08s", "--max-delay 50 --alpha 8"),
        ("--beta 20ms --min-delay 1.5s", "--beta 2 --min-delay 150"),
        ("--method hinge --max-delay 0.3s", "--method hinge --max-delay 30"),
    ] {
        assert_eq!(estimated(folder.path(), seconds), estimated(folder.path(), samples));
    }
    let output = run(folder.path(), &["estimate", "log.csv", "--max-delay", "0.5m"]);
    assert_eq!(output.status.code(), Some(2));
    assert!(said(&output).contains("seconds as in 0.5s"), "{}", said(&output));
}

#[test]
fn seconds_are_right_for_each_trial() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("log.csv"), log(&[0.01, 0.02])).unwrap();
    let found = estimated(folder.path(), "--max-delay 0.4s --alpha 0.1s --first-last keep");
    assert_eq!(
        (&found["max_delay"], &found["settings"]["max_delay"]),
        (&Value::Null, &Value::Null)
    );
    let settings = &found["settings"];
    assert_eq!(
        (settings["max_delay_s"].as_f64(), settings["alpha_s"].as_f64()),
        (Some(0.4), Some(0.1))
    );
    let joint = &found["joints"][0];
    // A segment ends a longest delay and α after its step.
    assert!(ends(joint, "0").contains(&50), "{:?}", ends(joint, "0"));
    assert!(ends(joint, "1").contains(&25), "{:?}", ends(joint, "1"));
    let text = run(folder.path(), &["estimate", "log.csv", "-q", "--max-delay", "0.4s"]);
    assert!(String::from_utf8_lossy(&text.stdout).contains("longest delay 0.4 s"));
}

#[test]
fn a_sweep_takes_seconds() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("log.csv"), log(&[0.01])).unwrap();
    let swept = |alpha: &str| {
        let options = ["--method", "two-line", "--beta", "5", "--passband", "none"];
        let first = ["sweep", "log.csv", "-q", "--format", "json", "--alpha", alpha];
        let output = run(folder.path(), &[&first[..], &options].concat());
        assert!(output.status.success(), "{}", said(&output));
        serde_json::from_slice::<Value>(&output.stdout).unwrap()
    };
    // What is the same number of samples is tried once.
    assert_eq!(swept("0.05s,0.1s,0.051s"), swept("5,10"));
    fs::write(folder.path().join("log.csv"), log(&[0.01, 0.02])).unwrap();
    let levels = swept("0.05s,0.1s")["joints"][0]["levels"]["alpha"].clone();
    assert_eq!(levels[0]["value"], "0.05s");
}

#[test]
fn a_joint_may_have_settings_of_its_own() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("log.csv"), log(&[0.01])).unwrap();
    let map = folder.path().join("map.toml");
    fs::write(&map, "[joint.arm.estimate]\nmax_delay = \"0.5s\"\nmin_step = 0.2\n").unwrap();
    let own = estimated(folder.path(), "--columns map.toml --alpha 8");
    let all = estimated(folder.path(), "--max-delay 50 --min-step 0.2 --alpha 8");
    let none = estimated(folder.path(), "--alpha 8");
    assert_eq!(own["joints"][0]["decisions"], all["joints"][0]["decisions"]);
    assert_eq!(own["joints"][0]["settings"]["max_delay"], 50);
    assert_eq!(own["joints"][1], none["joints"][1]);
    let output = run(folder.path(), &["estimate", "log.csv", "--columns", "map.toml"]);
    let text = String::from_utf8_lossy(&output.stdout).into_owned();
    assert!(
        text.contains("arm, settings of its own: ") && text.contains("longest delay 50 samples"),
        "{text}"
    );
    // A sweep varies the others.
    let options = ["--method", "two-line", "--beta", "5", "--passband", "none", "--alpha", "8"];
    let first = ["sweep", "log.csv", "-q", "--format", "json", "--columns", "map.toml"];
    let output = run(folder.path(), &[&first[..], &options].concat());
    assert!(output.status.success(), "{}", said(&output));
}

#[test]
fn settings_that_are_none_are_refused_with_their_place() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("log.csv"), log(&[0.01])).unwrap();
    for (text, why) in [
        ("[joint.arm.estimate]\nmax_dely = 5\n", "[joint.arm.estimate] max_dely: expected one of"),
        ("[joint.arm.estimate]\nmax_delay = \"soon\"\n", "seconds as in 0.5s"),
        ("[joint.arm.estimates]\nmax_delay = 5\n", "map.toml"),
    ] {
        fs::write(folder.path().join("map.toml"), text).unwrap();
        let output = run(folder.path(), &["estimate", "log.csv", "--columns", "map.toml"]);
        assert_eq!(output.status.code(), Some(2));
        assert!(said(&output).contains(why), "{}", said(&output));
    }
    fs::write(folder.path().join("map.toml"), "[joint.leg.estimate]\nalpha = 5\n").unwrap();
    let output = run(folder.path(), &["estimate", "log.csv", "--columns", "map.toml"]);
    assert!(said(&output).contains("no joint `leg`"), "{}", said(&output));
}
