//! What is tried with bytes that may be anything: they are read or refused, and what was read
//! holds together. A fault panics. Each attempt says whether the bytes got past the reader.

use std::fs;
use std::io;
use std::path::{Path, PathBuf};
use std::sync::LazyLock;

use tauscope::Settings;
use tauscope::delay::EstimateError;
use tauscope::effect::{Definition, InputChange, Moment, OwnParameter, Stage, expression};
use tauscope::experiment::{
    ColumnMap, Experiment, Joint, JointColumns, MemoryLimit, ReadOptions, Survey,
};
use tauscope::explain::Sequential;
use tauscope::export::{Export, Units, by_ending, endings};
use tauscope::model::{Component, JointModel, ModelFile, Surroundings, simulate_input};
use tauscope::study::{JointEstimate, Review, estimate_joints};
use tauscope::synthetic::{self, PlantSpec};
use tempfile::TempDir;

/// More than any of the files that are changed needs to be read.
const MEMORY: u64 = 100_000_000;

thread_local! {
    /// Where the bytes are put for readers that take a file; tests run beside one another.
    static FOLDER: TempDir = TempDir::new().unwrap();
}

fn file(name: &str, bytes: &[u8]) -> PathBuf {
    let path = FOLDER.with(|folder| folder.path().join(name));
    fs::write(&path, bytes).unwrap();
    path
}

fn options(columns: ColumnMap) -> ReadOptions {
    ReadOptions { memory: MemoryLimit::of_bytes(MEMORY), columns, ..ReadOptions::default() }
}

/// A log of any format: read as it is, and by the mapping that a survey finds.
pub fn log(name: &str, bytes: &[u8]) -> bool {
    let path = file(name, bytes);
    let plain = read(&path, ColumnMap::default());
    let Ok(survey) = Survey::of(&path, MemoryLimit::of_bytes(MEMORY)) else { return plain };
    let mut map = survey.map;
    if map.joints.is_empty() {
        let names: Vec<_> = survey.columns.iter().map(|column| &column.name).collect();
        let [.., input, output] = names.as_slice() else { return plain };
        map.joints = vec![JointColumns::new("j", input, output)];
    }
    read(&path, map) || plain
}

fn read(path: &Path, columns: ColumnMap) -> bool {
    let experiment = Experiment::read(&[path.to_owned()], &options(columns));
    check(&experiment.joints);
    !experiment.joints.is_empty()
}

/// A trial has as many inputs as outputs, at times that are numbers.
fn check(joints: &[Joint]) {
    for trial in joints.iter().flat_map(|joint| &joint.trials) {
        assert_eq!(trial.input().len(), trial.output().len());
        assert!(trial.input().iter().chain(trial.output()).all(|value| value.is_finite()));
        assert!(trial.time_s(0).is_finite(), "it starts at {}", trial.time_s(0));
    }
}

/// A column map: written and read again it is the same, and a log is read by it.
pub fn columns(bytes: &[u8]) -> bool {
    static LOG: LazyLock<PathBuf> = LazyLock::new(|| file("mapped.csv", log_text().as_bytes()));
    let Ok(map) = ColumnMap::read(&file("columns.toml", bytes)) else { return false };
    let again = ColumnMap::read(&file("columns.toml", map.to_toml().as_bytes())).unwrap();
    // As text: a sample period may be no number until a log is read with it.
    assert_eq!(format!("{again:?}"), format!("{map:?}"));
    read(&LOG, map);
    true
}

/// A plant: written and read again it is the same; a small one is driven.
pub fn plant(bytes: &[u8]) -> bool {
    /// Steps of time of all joints that are driven in a moment.
    const STEPS: f64 = 20_000.0;
    let Ok(text) = std::str::from_utf8(bytes) else { return false };
    let Ok(plant) = PlantSpec::from_toml(text) else { return false };
    assert_eq!(PlantSpec::from_toml(&plant.to_toml().unwrap()).unwrap(), plant);
    let samples = plant.duration_s / plant.sample_period_s * plant.joints.len() as f64;
    if samples * f64::from(plant.substeps) < STEPS
        && let Ok(made) = synthetic::simulate(&plant)
    {
        check(&made.joints);
        synthetic::write_log(&made, io::sink()).unwrap();
        synthetic::write_truth(&made.truth, io::sink()).unwrap();
    }
    true
}

/// A model file: each of its models is simulated, written to it again, and exported.
pub fn model(bytes: &[u8]) -> bool {
    let Ok(text) = std::str::from_utf8(bytes) else { return false };
    let Ok(file) = ModelFile::parse(text, Path::new("model.toml")) else { return false };
    for joint in file.names() {
        let model = file.joint(joint).unwrap();
        run(model);
        if let Ok(again) = file.refitted(joint, model) {
            assert_eq!(again.joint(joint).unwrap().values(), model.values());
        }
        export(model);
    }
    true
}

/// Simulates a model for a second.
fn run(model: &JointModel) {
    let input: Vec<f64> = (0..50).map(|k| f64::from(k / 10 % 3 - 1)).collect();
    let simulated = simulate_input(model, &input, 0.02, 1.0, &Surroundings::default());
    assert_eq!(simulated.output.len(), input.len());
}

/// Writes a model in each language but that of FMUs, which are C that a compiler is run on; what
/// cannot be said in one is refused.
fn export(model: &JointModel) {
    let Ok(export) = Export::new("joint", model, Units::default(), &[]) else { return };
    let endings = endings().into_iter().filter(|ending| *ending != "fmu");
    for language in endings.filter_map(by_ending) {
        if let Ok(files) = language.files(&export, "joint") {
            assert!(!files.is_empty());
        }
    }
}

/// An effect of a user's own: its stage on the first line, its expression, of the parameters
/// `a` and `b`, after it.
pub fn expression(bytes: &[u8]) -> bool {
    let Ok(text) = std::str::from_utf8(bytes) else { return false };
    let (stage, expression) = text.split_once('\n').unwrap_or(("input", text));
    let stage = Stage::ALL.into_iter().find(|known| known.id() == stage).unwrap_or(Stage::Input);
    let words = expression.split(|letter: char| !letter.is_alphanumeric() && letter != '_');
    let parameters = ["a", "b"].into_iter().filter(|name| words.clone().any(|word| word == *name));
    let defined = expression::define(Definition {
        id: "own".to_owned(),
        summary: None,
        stage,
        expression: expression.to_owned(),
        states: Vec::new(),
        parameters: parameters.map(|name| OwnParameter::new(name, 0.5)).collect(),
    });
    let Ok(effect) = defined else { return false };
    let values = vec![0.5; effect.spec().parameters.len()];
    for level in [0.0, -1.5, 1e300, f64::MIN_POSITIVE] {
        let moment = Moment {
            signal: level,
            position: -level,
            velocity: 3.0 * level,
            time_s: 1.0,
            dt_s: 0.01,
            others: 0.5,
            measured: f64::NAN,
            radians_per_output_unit: 1.0,
        };
        assert!(effect.step(&values, &mut [], &moment).is_finite());
        let change = InputChange { before: level, after: 1.0, held_s: 0.5, time_s: 1.0 };
        assert!(effect.extra_delay_s(&values, &change).is_finite());
    }
    export(&JointModel::integrator(1.0, 0.1).with(Component::neutral(effect)));
    true
}

/// A review of the decisions on a log.
pub fn review(bytes: &[u8]) -> bool {
    type Estimates = Vec<Result<JointEstimate, EstimateError>>;
    static DECIDED: LazyLock<(Vec<Joint>, Estimates)> = LazyLock::new(|| {
        let log = file("reviewed.csv", log_text().as_bytes());
        let joints = Experiment::read(&[log], &ReadOptions::default()).joints;
        let estimates = estimate_joints(
            &joints,
            &Settings::of(tauscope::delay::Method::TWO_LINE),
            || (),
            &Sequential,
        );
        (joints, estimates)
    });
    let Ok(review) = Review::read(&file("review.csv", bytes)) else { return false };
    let (joints, estimates) = &*DECIDED;
    let mut estimates: Estimates = estimates.iter().flatten().cloned().map(Ok).collect();
    for note in review.apply(joints, &mut estimates) {
        assert!(!note.is_empty());
    }
    true
}

/// A log of one joint that steps and follows.
fn log_text() -> String {
    let row = |k: u32| {
        let (level, angle) =
            (k / 60 % 2, k.saturating_sub(15) / 60 * 6 + k.saturating_sub(15) % 60);
        format!("{:.2},{level},{angle}\n", f64::from(k) * 0.01)
    };
    "time_s,a.input,a.output\n".to_owned() + &(0..300).map(row).collect::<String>()
}
