//! What differs between trials and is in no signal, but in their labels: the load.

use std::fmt::Write as _;

use crate::desk::Desk;
use crate::sample::size;
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

/// What `improve` says of the log, and the desk with the log and its model.
fn improved(log: &str) -> (Value, Desk) {
    let desk = Desk::of_log(log);
    let found = desk.json("improve log.csv --write model.toml --quiet", 0);
    (found["joints"][0].clone(), desk)
}

/// What a command says on standard error.
fn notes(desk: &Desk, arguments: &str) -> String {
    String::from_utf8(desk.run(arguments).stderr).unwrap()
}

fn value(joint: &Value, name: &str) -> f64 {
    joint["parameters"][name]["value"].as_f64().unwrap()
}

#[test]
fn a_load_that_is_in_the_labels_alone_is_found_and_the_model_knows_its_trials() {
    let (slower, desk) = improved(&log(31, Load::Slower, |trial| trial % 2 == 0));
    assert_eq!(slower["effects"], serde_json::json!(["gain[empty]"]));
    // The first word in the alphabet: a third more without the load is a quarter less with it.
    for direction in ["positive", "negative"] {
        let part = value(&slower, &format!("gain[empty].{direction}"));
        assert!((part - 1.0 / 3.0).abs() < 0.015, "{direction}: {part}");
    }
    assert_knows_its_trials(&desk);
    let (lifted, _) = improved(&log(32, Load::Gravity, |trial| trial % 2 == 1));
    assert_eq!(lifted["effects"], serde_json::json!(["gravity_load[full]"]));
    assert!((value(&lifted, "gravity_load[full].kappa") - 0.45).abs() < 0.02);
    assert_eq!(lifted["verdict"], "adequate");
}

#[test]
fn labels_that_say_nothing_of_the_joint_name_no_effect() {
    for seed in 41..size(42, 44) {
        let (joint, _) = improved(&log(seed, Load::None, |trial| trial % 3 == 0));
        assert_eq!(joint["effects"], serde_json::json!([]), "seed {seed}");
    }
}

/// The model of `log.csv` has a gain of its own in the trials whose label says `empty`.
fn assert_knows_its_trials(desk: &Desk) {
    let error = |log: &str| {
        let compare = format!("compare {log} -m model.toml");
        let found = desk.json(&compare, 0);
        let rmse = found["joints"][0]["error"]["train"]["rmse"].as_f64().unwrap();
        (rmse, notes(desk, &compare))
    };
    let (whole, said) = error("log.csv");
    assert!(whole < 0.06 && !said.contains("does nothing"), "{whole} {said}");
    // Under labels that the model does not know it is the model of the other trials.
    desk.write("renamed.csv", &desk.read("log.csv").replace("-empty", "-light"));
    let (renamed, said) = error("renamed.csv");
    assert!(renamed > 5.0 * whole, "{renamed}");
    let expected = "no trial has `empty` in its label: `gain[empty]` does nothing";
    assert!(said.contains(expected), "{said}");
    // A model that stands alone is that of one kind of trial.
    let export = |more: &str| notes(desk, &format!("export model.toml model.py --quiet {more}"));
    let refused = export("");
    assert!(refused.contains("`--trial empty` or `--trial none`"), "{refused}");
    assert_eq!(export("--trial run9-empty"), "");
    assert!(desk.read("model.py").contains("gain_empty_positive"));
    assert_eq!(export("--trial none"), "");
    assert!(!desk.read("model.py").contains("gain_empty"));
}

#[test]
fn an_effect_is_added_to_the_trials_of_a_condition_by_hand() {
    let desk = Desk::of_log(&log(34, Load::None, |trial| trial % 2 == 0));
    assert_eq!(notes(&desk, "add dead_band[full] log.csv -m model.toml -q"), "");
    let text = desk.read("model.toml");
    assert!(text.contains("kind = \"dead_band[full]\""), "{text}");
    let said = notes(&desk, "add deadband[full] log.csv -m model.toml -q");
    assert!(said.contains("did you mean `dead_band`?"), "{said}");
}
