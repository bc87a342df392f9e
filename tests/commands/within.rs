//! Commands that a program runs inside itself give what the program prints.

use std::ffi::OsString;
use std::io;
use std::path::PathBuf;
use std::process::Command;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, Mutex};

use tauscope::cli::{Hosting, options_of, read_within, run_within};
use tauscope::effect::{Effect, Moment, Spec, Stage};
use tauscope::experiment::{Experiment, ReadOptions};

/// A program that runs commands inside itself.
#[derive(Default)]
struct Program {
    logs: Mutex<Option<Experiment>>,
    printed: Mutex<Vec<u8>>,
    said: Mutex<Vec<(String, String)>>,
    steps: AtomicU64,
    stops: bool,
    ends: bool,
    effects: Vec<&'static dyn Effect>,
}

impl Program {
    fn text(&self) -> String {
        String::from_utf8(self.printed.lock().unwrap().clone()).unwrap()
    }
}

/// An effect of the program's own.
#[derive(Debug)]
struct Half;

static HALF: Spec = Spec::new("half", Stage::Input, "half of the input is lost")
    .equation("out = in / 2")
    .source("made up for this test");

impl Effect for Half {
    fn spec(&self) -> &'static Spec {
        &HALF
    }

    fn step(&self, _: &[f64], _: &mut [f64], at: &Moment) -> f64 {
        0.5 * at.signal
    }

    fn nests(&self) -> bool {
        false
    }
}

impl Hosting for Program {
    fn effects(&self) -> Vec<&'static dyn Effect> {
        self.effects.clone()
    }

    fn logs(&self, _: &ReadOptions) -> Option<Experiment> {
        self.logs.lock().unwrap().take()
    }

    fn print(&self, results: &[u8]) -> io::Result<()> {
        self.printed.lock().unwrap().extend(results);
        Ok(())
    }

    fn say(&self, kind: &str, text: &str) {
        self.said.lock().unwrap().push((kind.to_owned(), text.to_owned()));
    }

    fn progress(&self, _: &str, _: u64, _: u64) {
        self.steps.fetch_add(1, Ordering::Relaxed);
    }

    fn is_stopping(&self) -> bool {
        self.stops
    }

    fn is_ending(&self) -> bool {
        self.ends
    }
}

fn arguments(words: &str) -> Vec<OsString> {
    words.split_whitespace().map(OsString::from).collect()
}

/// What the program itself prints.
fn printed(words: &str) -> String {
    let done = Command::new(env!("CARGO_BIN_EXE_tauscope")).args(arguments(words)).output();
    String::from_utf8(done.unwrap().stdout).unwrap()
}

#[test]
fn results_are_those_of_the_program_wherever_the_log_is() {
    let words = "estimate data/hidden_effect.csv --format json";
    let program = Arc::new(Program::default());
    assert!(run_within(&arguments(words), program.clone()).unwrap());
    let expected = printed(words);
    assert_eq!(program.text(), expected.trim_end());
    assert_eq!(program.steps.load(Ordering::Relaxed), 2);
    let log = PathBuf::from("data/hidden_effect.csv");
    let log = Experiment::read(&[log], &ReadOptions::default());
    let handed = Arc::new(Program { logs: Mutex::new(Some(log)), ..Program::default() });
    assert!(run_within(&arguments("estimate memory --format json"), handed.clone()).unwrap());
    assert_eq!(handed.text(), expected.trim_end());
}

#[test]
fn what_goes_wrong_is_said_with_its_place() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("log.csv");
    std::fs::write(&path, "time_s,boom.input,boom.output\n0,0,0\n0.1,0,x\n0.2,1,1\n").unwrap();
    let program = || Arc::new(Program::default());
    let words = format!("estimate {}", path.display());
    let refused = run_within(&arguments(&words), program()).unwrap_err();
    assert_eq!((refused.row, refused.column.as_deref()), (Some(3), Some("boom.output")));
    let refused = run_within(&arguments("estimate --alpha many x"), program()).unwrap_err();
    assert!(refused.message.contains("--alpha"), "{}", refused.message);
    let partly = program();
    let words = "estimate data/hidden_effect.csv --joint boom --joint wrist";
    assert!(!run_within(&arguments(words), partly.clone()).unwrap());
    let said = partly.said.lock().unwrap();
    assert!(said.iter().any(|(kind, text)| kind == "warning" && text.contains("wrist")));
}

#[test]
fn a_command_that_is_ended_leaves_no_results_and_one_that_is_stopped_what_it_has() {
    let ended = Arc::new(Program { ends: true, ..Program::default() });
    let words = "explain data/hidden_effect.csv --joint boom --format json";
    let refused = run_within(&arguments(words), ended.clone()).unwrap_err();
    assert!(refused.was_ended && ended.printed.lock().unwrap().is_empty());
    let folder = tempfile::tempdir().unwrap();
    let model = folder.path().join("model.toml");
    let words = "improve data/hidden_effect.csv --joint boom --format json -w ";
    let stopped = Arc::new(Program { stops: true, ..Program::default() });
    let words = words.to_owned() + model.to_str().unwrap();
    assert!(!run_within(&arguments(&words), stopped.clone()).unwrap());
    let found: serde_json::Value = serde_json::from_str(&stopped.text()).unwrap();
    assert_eq!(found["joints"][0]["interrupted"], true);
    assert_eq!(found["joints"][0]["revisions"].as_array().unwrap().len(), 1);
}

#[test]
fn a_model_may_name_the_effects_of_the_program() {
    let folder = tempfile::tempdir().unwrap();
    let model = folder.path().join("model.toml");
    let text = "schema = \"tauscope/model/1\"\n[joint.boom]\nstructure = \"integrator\"\n\
                parameters = { gain = 14.0, delay = 0.13 }\n[[joint.boom.effect]]\nkind = \"half\"\n";
    std::fs::write(&model, text).unwrap();
    let words = "add dead_band data/hidden_effect.csv --joint boom --format json --model ";
    let words = words.to_owned() + model.to_str().unwrap();
    let refused = run_within(&arguments(&words), Arc::new(Program::default())).unwrap_err();
    assert!(refused.message.contains("half"), "{}", refused.message);
    let program = Arc::new(Program { effects: vec![&Half], ..Program::default() });
    assert!(run_within(&arguments(&words), program.clone()).unwrap());
    let found: serde_json::Value = serde_json::from_str(&program.text()).unwrap();
    assert_eq!(found["joints"][0]["effects"], serde_json::json!(["half", "dead_band"]));
    let revised = std::fs::read_to_string(&model).unwrap();
    assert!(revised.contains("kind = \"half\"") && revised.contains("kind = \"dead_band\""));
}

#[test]
fn logs_are_read_with_the_options_of_every_command() {
    let program = Arc::new(Program::default());
    let found = read_within(&arguments("read data/hidden_effect.csv --joint arm"), program);
    assert_eq!(found.unwrap().joints[0].name, "arm");
    let names = |command: &str| -> Vec<String> {
        options_of(command).unwrap().into_iter().map(|option| option.name).collect()
    };
    assert!(names("estimate").contains(&"keep-first-last".to_owned()));
    assert!(names("read").contains(&"sample-period".to_owned()));
    assert!(!names("read").contains(&"alpha".to_owned()));
    assert_eq!(options_of("no such command"), None);
}
