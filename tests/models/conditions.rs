//! What differs between trials and is in no signal, but in their labels: the load.

use std::fmt::Write as _;
use std::path::Path;
use std::process::Command;

use serde_json::Value;
use tauscope::synthetic::{PlantSpec, simulate, write_log};

/// What loads the joint in the trials that are `full`.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Load {
    None,
    Gravity,
    Slower,
}

const TRIALS: u64 = 8;

/// A log of eight trials, of which `full` says whether the label is that of a loaded one.
fn log(seed: u64, load: Load, full: impl Fn(u64) -> bool) -> String {
    let mut text = String::from("trial,time_s,boom.input [V],boom.output [deg]\n");
    for trial in 0..TRIALS {
        let is_loaded = load != Load::None && full(trial);
        let gain = if is_loaded && load == Load::Slower { 6.6 } else { 8.8 };
        let mut plant = format!(
            "schema = \"tauscope/plant/1\"\nseed = {}\nduration_s = 30.0\n[[joint]]\n\
             name = \"boom\"\ngain = {gain}\nrange = [-40.0, 60.0]\nnoise = 0.05\n\
             valve_edge = 0.02\ndelay = {{ law = \"constant\", seconds = 0.17 }}\n\
             input = {{ levels = [-2.0, -1.5, -0.8, 0.0, 0.8, 1.5, 2.0], hold_s = [0.5, 2.0] }}\n",
            100 * seed + trial
        );
        if is_loaded && load == Load::Gravity {
            plant.push_str("[joint.effect.gravity_load]\nkappa = 0.45\ny0 = 10.0\n");
        }
        let mut rows = Vec::new();
        write_log(&simulate(&PlantSpec::from_toml(&plant).unwrap()).unwrap(), &mut rows).unwrap();
        let label = if full(trial) { "full" } else { "empty" };
        let rows = String::from_utf8(rows).unwrap();
        let rows = rows.lines().filter(|row| row.starts_with(|c: char| c.is_ascii_digit()));
        for row in rows {
            writeln!(text, "run{trial}-{label},{row}").unwrap();
        }
    }
    text
}

fn tauscope(arguments: &[&str]) -> (String, String) {
    let mut command = Command::new(env!("CARGO_BIN_EXE_tauscope"));
    let output = command.args(arguments).output().unwrap();
    let text = |bytes: Vec<u8>| String::from_utf8(bytes).unwrap();
    (text(output.stdout), text(output.stderr))
}

fn path(path: &Path) -> &str {
    path.to_str().unwrap()
}

/// What `improve` says of the log, and the folder of the log and its model.
fn improved(log: &str) -> (Value, tempfile::TempDir) {
    let folder = tempfile::tempdir().unwrap();
    let (data, model) = (folder.path().join("log.csv"), folder.path().join("model.toml"));
    std::fs::write(&data, log).unwrap();
    let arguments =
        ["improve", path(&data), "--write", path(&model), "--quiet", "--format", "json"];
    let found: Value = serde_json::from_str(&tauscope(&arguments).0).unwrap();
    (found["joints"][0].clone(), folder)
}

fn value(joint: &Value, name: &str) -> f64 {
    joint["parameters"][name]["value"].as_f64().unwrap()
}

#[test]
fn a_load_that_is_in_the_labels_alone_is_found() {
    let (slower, _folder) = improved(&log(31, Load::Slower, |trial| trial % 2 == 0));
    assert_eq!(slower["effects"], serde_json::json!(["gain[empty]"]));
    // The first word in the alphabet: a third more without the load is a quarter less with it.
    for direction in ["positive", "negative"] {
        let part = value(&slower, &format!("gain[empty].{direction}"));
        assert!((part - 1.0 / 3.0).abs() < 0.015, "{direction}: {part}");
    }
    let (lifted, _folder) = improved(&log(32, Load::Gravity, |trial| trial % 2 == 1));
    assert_eq!(lifted["effects"], serde_json::json!(["gravity_load[full]"]));
    assert!((value(&lifted, "gravity_load[full].kappa") - 0.45).abs() < 0.02);
    assert_eq!(lifted["verdict"], "adequate");
}

#[test]
fn labels_that_say_nothing_of_the_joint_name_no_effect() {
    for seed in [41, 42, 43] {
        let (joint, _folder) = improved(&log(seed, Load::None, |trial| trial % 3 == 0));
        assert_eq!(joint["effects"], serde_json::json!([]), "seed {seed}");
    }
}

#[test]
fn the_model_knows_its_trials() {
    let (_, folder) = improved(&log(33, Load::Slower, |trial| trial % 2 == 0));
    let [data, model, code] = ["log.csv", "model.toml", "model.py"].map(|f| folder.path().join(f));
    let error = |data: &Path| {
        let arguments = ["compare", path(data), "-m", path(&model), "--format", "json"];
        let (found, notes) = tauscope(&arguments);
        let found: Value = serde_json::from_str(&found).unwrap();
        (found["joints"][0]["error"]["train"]["rmse"].as_f64().unwrap(), notes)
    };
    let (whole, notes) = error(&data);
    assert!(whole < 0.06 && !notes.contains("does nothing"), "{whole} {notes}");
    // Under labels that the model does not know it is the model of the other trials.
    let renamed = folder.path().join("renamed.csv");
    let text = std::fs::read_to_string(&data).unwrap();
    std::fs::write(&renamed, text.replace("-empty", "-light")).unwrap();
    let (renamed, notes) = error(&renamed);
    assert!(renamed > 5.0 * whole, "{renamed}");
    assert!(
        notes.contains("no trial has `empty` in its label: `gain[empty]` does nothing"),
        "{notes}"
    );
    // A model that stands alone is that of one kind of trial.
    let export = |more: &[&str]| {
        tauscope(&[&["export", path(&model), path(&code), "--quiet"], more].concat()).1
    };
    let refused = export(&[]);
    assert!(refused.contains("`--trial empty` or `--trial none`"), "{refused}");
    assert_eq!(export(&["--trial", "run9-empty"]), "");
    assert!(std::fs::read_to_string(&code).unwrap().contains("gain_empty_positive"));
    assert_eq!(export(&["--trial", "none"]), "");
    assert!(!std::fs::read_to_string(&code).unwrap().contains("gain_empty"));
}

#[test]
fn an_effect_is_added_to_the_trials_of_a_condition_by_hand() {
    let (_, folder) = improved(&log(34, Load::None, |trial| trial % 2 == 0));
    let [data, model] = ["log.csv", "model.toml"].map(|file| folder.path().join(file));
    let (_, errors) = tauscope(&["add", "dead_band[full]", path(&data), "-m", path(&model), "-q"]);
    assert_eq!(errors, "");
    let text = std::fs::read_to_string(&model).unwrap();
    assert!(text.contains("kind = \"dead_band[full]\""), "{text}");
    let (_, errors) = tauscope(&["add", "deadband[full]", path(&data), "-m", path(&model), "-q"]);
    assert!(errors.contains("did you mean `dead_band`?"), "{errors}");
}
