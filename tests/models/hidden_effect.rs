//! The log of the tutorial: its recipe makes it, and what it hides is found.

use std::fs;
use std::process::Command;

use serde_json::Value;
use tauscope::effect::REGISTRY;
use tauscope::synthetic::{PlantSpec, simulate, write_log};

fn plant() -> PlantSpec {
    PlantSpec::from_toml(&fs::read_to_string("data/hidden_effect.truth.toml").unwrap()).unwrap()
}

/// The table of the effect that the boom hides, and its name.
fn hidden() -> (String, toml::Table) {
    let effects = toml::Table::try_from(&plant().joints[0].effect).unwrap();
    let mut effects = effects.into_iter();
    let (name, numbers) = effects.next().unwrap();
    assert!(effects.next().is_none(), "one effect is hidden");
    (name, numbers.as_table().unwrap().clone())
}

#[test]
fn the_log_is_what_its_truth_makes() {
    let mut log = Vec::new();
    write_log(&simulate(&plant()).unwrap(), &mut log).unwrap();
    assert!(log == fs::read("data/hidden_effect.csv").unwrap());
}

#[test]
fn what_is_hidden_is_not_told_beside_the_log() {
    let told = fs::read_to_string("data/README.md").unwrap();
    let log = fs::read_to_string("data/hidden_effect.csv").unwrap();
    let header = log.lines().take_while(|line| !line.starts_with("0,")).collect::<String>();
    for effect in REGISTRY {
        let id = effect.spec().id;
        assert!(!told.contains(id) && !header.contains(id), "{id}");
    }
}

#[test]
fn it_is_named_and_with_it_the_error_falls_to_the_noise() {
    let arguments = "improve data/hidden_effect.csv --write /dev/null --quiet --format json";
    let mut command = Command::new(env!("CARGO_BIN_EXE_tauscope"));
    let output = command.args(arguments.split(' ')).output().unwrap();
    let found: Value = serde_json::from_slice(&output.stdout).unwrap();
    let (boom, arm) = (&found["joints"][0], &found["joints"][1]);
    assert_eq!(arm["revisions"].as_array().unwrap().len(), 1, "the arm hides nothing");
    let (name, numbers) = hidden();
    let revisions = boom["revisions"].as_array().unwrap();
    let added: Vec<_> =
        revisions.iter().filter_map(|revision| revision["added"].as_str()).collect();
    assert_eq!((added, &boom["verdict"]), (vec![name.as_str()], &Value::from("adequate")));
    let error = |revision: &Value| revision["error"]["validation"]["rmse"].as_f64().unwrap();
    let noise = plant().joints[0].noise;
    assert!(error(&revisions[0]) > 10.0 * noise && error(&revisions[1]) < 1.15 * noise);
    for (key, truth) in numbers {
        let fitted = &boom["parameters"][format!("{name}.{key}")];
        let [value, std_error] = ["value", "std_error"].map(|key| fitted[key].as_f64().unwrap());
        let off = (value - truth.as_float().unwrap()) / std_error;
        assert!(off.abs() < 4.0, "{key} is off by {off} standard errors");
    }
}

#[test]
fn the_tutorial_tells_the_truth_of_the_file_in_the_end() {
    let tutorial = fs::read_to_string("docs/tutorial.md").unwrap();
    let (_, end) = tutorial.split_once("## What it was").unwrap();
    let (name, numbers) = hidden();
    assert!(end.contains(&format!("`{name}`")));
    for (key, truth) in numbers {
        let row = format!("| {key} | {} ", truth.as_float().unwrap());
        assert!(end.contains(&row), "{row}");
    }
}
