//! `tauscope improve` as a user sees it: the ladder of errors, and the model file.

use std::fmt::Write as _;

use crate::desk::{Desk, assert_fields, banded, fields, joint, number};
use crate::sample::size;
use serde_json::{Value, json};
use sha2::{Digest as _, Sha256};
use tauscope::model::ModelFile;
use tauscope::synthetic::{CylinderSpec, DelayLaw, InputSpec, JointSpec};

/// No flow between −0.3 V and 0.3 V, and a slow spool.
fn slow(name: &str) -> JointSpec {
    JointSpec { lag_s: Some(0.1), ..banded(name) }
}

const FEW: &str = "--effects dead_band,actuator_lag,thermal_drift";

/// The history of a joint as the file has it is that of the JSON.
fn assert_history_is_that_of(desk: &Desk, file: &str, joint: &Value) {
    let file = ModelFile::read(&desk.folder.path().join(file)).unwrap();
    let name = joint["joint"].as_str().unwrap();
    let (history, revisions) = (file.history(name), joint["revisions"].as_array().unwrap());
    assert_eq!(history.len() + 1, revisions.len());
    for (entry, revision) in history.iter().zip(&revisions[1..]) {
        assert_eq!(json!(entry.revision), revision["revision"]);
        assert_eq!(entry.added.as_deref(), revision["added"].as_str());
        assert_eq!(entry.errors.validation_rmse, revision["error"]["validation"]["rmse"].as_f64());
    }
    let last = file.joint(name).unwrap();
    let effects: Vec<_> = last.components().iter().map(|c| c.effect().spec().id).collect();
    assert_eq!(json!(effects), revisions.last().unwrap()["effects"]);
}

#[test]
fn nothing_is_made_of_rounding() {
    let desk = Desk::with(vec![slow("boom")]);
    let log = concat!(env!("CARGO_MANIFEST_DIR"), "/data/worked_example.csv");
    let json = desk.json(&format!("improve {log} --write exact.toml"), 0);
    let joint = &json["joints"][0];
    assert!(number(&joint["error"]["train"]["rmse"]) < 1e-12, "{joint}");
    assert_eq!((&joint["verdict"], &joint["effects"]), (&json!("adequate"), &json!([])));
}

#[test]
fn the_error_falls_effect_by_effect_down_to_the_noise() {
    let desk = Desk::with(vec![slow("boom")]);
    desk.write(
        "boom.toml",
        "# mine\nschema = \"tauscope/model/1\"\n[joint.boom]\nstructure = \"integrator\" # ok\n\
         parameters = { gain = 9.0, delay = 0.1 }\n",
    );
    let json = desk.json(&format!("improve log.csv --model boom.toml {FEW}"), 0);
    assert_eq!(json["schema"], "tauscope/improve/1");
    let boom = &json["joints"][0];
    assert_fields(boom, "joint revision effects parameters error lack_of_fit revisions verdict");
    assert_eq!((&boom["verdict"], &boom["interrupted"]), (&json!("adequate"), &json!(false)));
    let revisions = boom["revisions"].as_array().unwrap();
    assert_eq!(fields(&revisions[0])[..3], ["revision", "added", "removed"]);
    assert_eq!((&revisions[0]["revision"], &revisions[0]["added"]), (&json!(0), &Value::Null));
    assert_fields(&revisions[0]["error"], "train validation noise_floor");
    let mut added: Vec<_> = revisions.iter().filter_map(|r| r["added"].as_str()).collect();
    added.sort_unstable();
    assert_eq!(added, ["actuator_lag", "dead_band"]);
    let error = |revision: &Value| number(&revision["error"]["validation"]["rmse"]);
    assert!(revisions.windows(2).all(|pair| error(&pair[1]) < error(&pair[0])));
    let last = revisions.last().unwrap();
    assert!(error(last) < 1.15 * number(&last["error"]["noise_floor"]), "{last}");
    assert_history_is_that_of(&desk, "boom.toml", boom);
    let text = desk.read("boom.toml");
    assert!(text.starts_with("# mine\n") && text.contains("structure = \"integrator\" # ok\n"));

    let again = desk.json(&format!("improve log.csv --model boom.toml {FEW}"), 0);
    assert_eq!(again["joints"][0]["revisions"].as_array().unwrap().len(), 1);
    assert_eq!(again["joints"][0]["revisions"][0]["revision"], 2);
    assert_eq!(desk.read("boom.toml"), text, "nothing is missing, so nothing changes");
}

#[test]
fn each_step_is_told_and_the_ladder_is_printed() {
    let desk = Desk::with(vec![banded("boom"), joint("arm")]).with_broken_joint();
    let output = desk.run(&format!("improve log.csv {FEW}"));
    assert_eq!(output.status.code(), Some(1));
    let told = String::from_utf8(output.stderr).unwrap();
    for part in [
        "improving: boom: integrator: validation error ",
        "improving: boom: + dead_band: validation error ",
        "improving: arm: integrator: ",
        "broken",
        "model: model.toml",
    ] {
        assert!(told.contains(part), "no `{part}` in {told}");
    }
    let printed = String::from_utf8(output.stdout).unwrap();
    for part in [
        "boom: dead_band explains ",
        "; nothing more is missing",
        "│ 0          integrator",
        "│ 1          + dead_band",
        "arm: ",
    ] {
        assert!(printed.contains(part), "no `{part}` in {printed}");
    }
    let file = ModelFile::read(&desk.folder.path().join("model.toml")).unwrap();
    assert_eq!(file.names().collect::<Vec<_>>(), ["arm", "boom"]);
    assert_eq!((file.revision("arm"), file.revision("boom")), (Some(0), Some(1)));
}

#[test]
fn the_conclusion_says_what_each_effect_carries_and_what_remains() {
    let desk = Desk::with(vec![banded("boom")]);
    let explained = desk.json(&format!("explain log.csv {FEW}"), 0);
    let improved = desk.json(&format!("improve log.csv --write one.toml {FEW}"), 0);
    let [named, improved] = [&explained, &improved].map(|json| &json["joints"][0]);
    let [of_named, conclusion] = [named, improved].map(|joint| &joint["conclusion"]);
    assert_eq!(conclusion["found"][0]["effect"], "dead_band");
    assert_eq!(conclusion["found"].as_array().unwrap().len(), 1);
    assert!(conclusion["found"][0]["parameters"]["dead_band.upper"]["value"].is_f64());
    assert_eq!(conclusion["headline"], improved["headline"]);
    // What is said follows from the errors of the revisions and the one noise.
    let error = |index: usize| number(&improved["revisions"][index]["error"]["validation"]["rmse"]);
    let noise = number(&conclusion["sensor_noise"]);
    assert!((number(&of_named["sensor_noise"]) - noise).abs() < 1e-15);
    let (before, after) = (error(0), error(1));
    let explained = 100.0 * (before - after) / (before - noise.min(after));
    assert!((number(&conclusion["explained_percent"]) - explained).abs() < 1e-9);
    assert!((number(&conclusion["remaining"]["rmse"]) - after).abs() < 1e-15);
    let times = number(&conclusion["remaining"]["times_sensor_noise"]);
    assert!((times - after / noise).abs() < 1e-9);
    // The only effect carries nearly all.
    let share = number(&conclusion["found"][0]["error_share_percent"]);
    assert!((share - explained).abs() < 5.0, "{share} {explained}");
    assert_eq!(of_named["found"][0]["effect"], "dead_band");
}

#[test]
fn no_more_effects_are_added_than_allowed() {
    let desk = Desk::with(vec![slow("boom")]);
    let json = desk.json(&format!("improve log.csv --max-effects 1 --write one.toml {FEW}"), 0);
    let boom = &json["joints"][0];
    assert_eq!(boom["revisions"].as_array().unwrap().len(), 2);
    assert_eq!(boom["verdict"], "missing_effect");
    let command = boom["commands"][0].as_str().unwrap();
    assert!(command.ends_with(" log.csv --model one.toml"), "{command}");
}

#[test]
fn any_number_of_threads_gives_the_same_bytes() {
    let desk = Desk::with(vec![banded("boom"), slow("arm")]);
    let run = |threads: &str| {
        let file = format!("{threads}.toml");
        let effects = "--effects dead_band,actuator_lag";
        let arguments =
            format!("improve log.csv --quiet --threads {threads} --write {file} {effects}");
        (desk.run(&arguments).stdout, desk.read(&file))
    };
    assert_eq!(run("1"), run("3"));
}

#[test]
fn what_cannot_be_used_is_refused() {
    let desk = Desk::with(vec![joint("boom")]);
    let refused = desk.refusal("improve log.csv --effects dead_band,stictoin");
    assert!(refused.contains("did you mean `stiction`?"), "{refused}");
    assert!(desk.refusal("improve log.csv --max-effects few").contains("--max-effects"));
    assert!(!desk.has("model.toml"));
}

#[cfg(unix)]
mod interrupted {
    use std::io::{BufRead as _, BufReader, Read as _};
    use std::process::{Child, ChildStderr, Command, Stdio};

    use super::*;

    /// A program that is at work on the first effect, and what it tells.
    struct AtWork {
        child: Child,
        told: BufReader<ChildStderr>,
    }

    impl AtWork {
        fn at(desk: &Desk, command: &str) -> Self {
            // One joint after the other, so that there is enough to do when it is interrupted.
            let few = format!("--threads 1 {FEW},gravity_load,flow_curve");
            let mut command = desk.command(&format!("{command} {few}"));
            let mut child = command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
            let told = BufReader::new(child.stderr.take().unwrap());
            let mut program = Self { child, told };
            program.wait_for("integrator");
            program
        }

        /// Reads what it tells up to a line with `part`.
        fn wait_for(&mut self, part: &str) {
            let mut line = String::new();
            while !line.contains(part) {
                line.clear();
                assert_ne!(self.told.read_line(&mut line).unwrap(), 0, "it ended before {part}");
            }
        }

        /// What it prints after it was interrupted once, and ended by itself.
        fn interrupted(mut self) -> String {
            self.interrupt();
            self.wait_for("stopping: after this revision");
            let mut rest = String::new();
            self.told.read_to_string(&mut rest).unwrap();
            let output = self.child.wait_with_output().unwrap();
            assert_eq!(output.status.code(), Some(1), "{rest}");
            String::from_utf8(output.stdout).unwrap()
        }

        fn interrupt(&self) {
            let pid = self.child.id().to_string();
            assert!(Command::new("kill").args(["-INT", &pid]).status().unwrap().success());
        }
    }

    #[test]
    fn once_it_keeps_the_revisions_so_far() {
        let desk = Desk::with(vec![slow("boom"), slow("arm")]);
        let printed = AtWork::at(&desk, "improve log.csv --format json").interrupted();
        let json: Value = serde_json::from_str(&printed).unwrap();
        let [boom, arm] = &json["joints"].as_array().unwrap()[..] else { panic!("{json}") };
        assert_history_is_that_of(&desk, "model.toml", boom);
        assert_history_is_that_of(&desk, "model.toml", arm);
        assert_eq!(arm["interrupted"], true);
        assert!(arm["revisions"].as_array().unwrap().len() < 3, "{arm}");
    }

    #[test]
    fn a_report_has_the_revisions_so_far() {
        let desk = Desk::with(vec![slow("boom"), slow("arm")]);
        let printed = AtWork::at(&desk, "log.csv -o page.html").interrupted();
        assert!(printed.contains("(stopped before the end)"), "{printed}");
        assert!(desk.read("page.html").contains("The search was stopped before its end"));
    }

    #[test]
    fn twice_it_ends_at_once() {
        let desk = Desk::with(vec![slow("boom"), slow("arm")]);
        let mut program = AtWork::at(&desk, "improve log.csv --format json");
        program.interrupt();
        program.wait_for("stopping: ");
        program.interrupt();
        let output = program.child.wait_with_output().unwrap();
        assert_eq!(output.status.code(), Some(130));
        assert!(output.stdout.is_empty() && !desk.has("model.toml"));
    }
}

#[cfg(feature = "rrd")]
#[test]
fn every_revision_is_recorded_as_a_model() {
    let desk = Desk::with(vec![banded("boom")]);
    let models = desk.recorded_models(&format!("improve log.csv {FEW}"));
    assert_eq!(models, ["revision 0", "revision 1"]);
    assert_eq!(desk.recorded_revisions(), 2);
}

#[test]
fn a_swing_is_a_resonance_before_it_is_an_oil_column() {
    let numbers = [
        ("period", 0.5),
        ("damping", 0.05),
        ("valve_damping", 0.1),
        ("slope", 0.01),
        ("reference", 0.0),
    ];
    let mut boom = joint("boom");
    boom.range = Some([-30.0, 30.0]);
    boom.hide("oil_column", &numbers.map(|(key, number)| (key.to_owned(), number))).unwrap();
    let desk = Desk::for_seconds(90.0, vec![boom]);
    let few = "--effects resonance,oil_column,actuator_lag,dead_band";
    let json = desk.json(&format!("improve log.csv --write m.toml {few}"), 0);
    let boom = &json["joints"][0];
    let added: Vec<_> =
        boom["revisions"].as_array().unwrap().iter().map(|r| r["added"].as_str()).collect();
    assert_eq!(added, [None, Some("resonance"), Some("oil_column")]);
    assert_eq!(boom["verdict"], "adequate");
    assert_eq!(boom["effects"], json!(["oil_column"]));
    for (name, truth) in numbers.into_iter().take(3) {
        // The plant has another formula.
        let found = number(&boom["parameters"][format!("oil_column.{name}")]["value"]);
        assert!((found / truth - 1.0).abs() < 0.2, "{name} is {found}");
    }
    // Alone it need not wait for the other.
    let json = desk.json("improve log.csv --write n.toml --effects oil_column", 0);
    assert_eq!(json["joints"][0]["revisions"][1]["added"], "oil_column");
}

#[test]
fn most_of_the_error_of_a_cylinder_is_taken_away() {
    let levels = vec![-6.0, -4.5, -3.0, -2.0, -1.0, 0.0, 1.0, 2.0, 3.0, 4.5, 6.0];
    let input = InputSpec::Levels { levels, hold_s: [0.5, 3.0] };
    let noise = 0.02;
    let boom = JointSpec {
        start: 20.0,
        range: Some([-10.0, 50.0]),
        cylinder: Some(CylinderSpec::default()),
        noise,
        ..JointSpec::new("boom", input, DelayLaw::Constant { seconds: 0.08 })
    };
    let desk = Desk::for_seconds(size(50.0, 90.0), vec![boom]);
    let few = "--effects dead_band,position_gain,gravity_load,flow_curve,resonance,oil_column";
    // A little is left, which the verdict may hold for something or not.
    let json = desk.json(&format!("improve log.csv --write m.toml {few}"), 0);
    let boom = &json["joints"][0];
    let revisions = boom["revisions"].as_array().unwrap();
    let error = |revision: &Value| number(&revision["error"]["validation"]["rmse"]);
    let (before, after) = (error(&revisions[0]), error(revisions.last().unwrap()));
    assert!(after < 0.2 * before, "{after} is left of {before}");
    assert!(boom["effects"].as_array().unwrap().contains(&json!("oil_column")));
}

/// A motor's speed: first order of 0.3 s, 0.25 s late, integrated in steps of 1 ms.
fn motor_log() -> String {
    const PER_SAMPLE: usize = 20;
    let (mut speed, mut log) = (0.0_f64, "time,motor.input,motor.output\n".to_owned());
    let level = |ms: usize| [0.0, 2.0, 5.0, 3.0, 7.0, 1.0, 4.0, 6.0, 2.5, 0.5][ms / 2000 % 10];
    let mut noise = simple_noise();
    for ms in 0..40_000_usize {
        if ms % PER_SAMPLE == 0 {
            let (time, input) = (ms as f64 / 1000.0, level(ms));
            let measured = 10.0 + speed + 0.05 * noise();
            writeln!(log, "{time:.2},{input},{measured}").unwrap();
        }
        let late = level(ms.saturating_sub(250));
        speed += 0.001 * (40.0 * late - speed) / 0.3;
    }
    log
}

/// Sums of twelve uniform numbers, less six: nearly normal.
fn simple_noise() -> impl FnMut() -> f64 {
    let mut state = 7_u64;
    move || {
        let mut uniform = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
            (state >> 11) as f64 / (1_u64 << 53) as f64
        };
        (0..12).map(|_| uniform()).sum::<f64>() - 6.0
    }
}

#[test]
fn a_speed_that_settles_is_a_first_order_with_dead_time() {
    let desk = Desk::with(vec![joint("boom")]);
    desk.write("motor.csv", &motor_log());
    let improved = desk.json("improve motor.csv --write motor.toml", 0);
    let motor = &improved["joints"][0];
    let value = |name: &str| number(&motor["parameters"][name]["value"]);
    assert_eq!(motor["effects"], json!(["leakage"]));
    assert!((value("delay") - 0.25).abs() < 0.01, "{}", value("delay"));
    assert!((value("leakage.rate") * 0.3 - 1.0).abs() < 0.03, "{}", value("leakage.rate"));
    assert!((value("gain") / value("leakage.rate") - 40.0).abs() < 0.5);
    assert!((value("leakage.y0") - 10.0).abs() < 0.5);
    assert_eq!(motor["verdict"], "adequate");
    let words = motor["in_words"].as_str().unwrap();
    assert!(words.contains("first order with dead time, of time constant 0.299 s"), "{words}");
}

#[test]
fn the_model_file_says_what_its_numbers_were_fitted_to() {
    let desk = Desk::with(vec![banded("boom")]);
    let json = desk.json("improve log.csv --write boom.toml --effects dead_band", 0);
    let file = ModelFile::read(&desk.folder.path().join("boom.toml")).unwrap();
    let (boom, fitted) = (&json["joints"][0], file.fitted("boom").unwrap());
    let hash = Sha256::digest(std::fs::read(desk.folder.path().join("log.csv")).unwrap());
    let hash = base16ct::lower::encode_string(&hash);
    let logs: Vec<_> = fitted.logs.iter().map(|log| (log.file.as_str(), &log.sha256)).collect();
    assert_eq!(logs, [("log.csv", &hash)]);
    assert_eq!(json!(fitted.verdict), boom["verdict"]);
    assert_eq!(fitted.output_unit.as_deref(), Some("deg"));
    assert!(desk.run("export boom.toml -o boom.py").status.success());
    assert!(desk.read("boom.py").contains("deg/s/V"), "the units are those of the log");
    let start = fitted.start.as_ref().unwrap();
    assert_eq!(json!(start.train_rmse), boom["revisions"][0]["error"]["train"]["rmse"]);
    let parameters = boom["parameters"].as_object().unwrap();
    assert_eq!(fitted.parameters.len(), parameters.len());
    for (name, parameter) in parameters {
        let known = &fitted.parameters[name];
        assert_eq!(json!(known.std_error), parameter["std_error"], "{name}");
        assert_eq!(json!(known.unit), parameter["unit"], "{name}");
    }
    // One effect more is another fit, and the errors at first stay.
    desk.run("add actuator_lag log.csv --model boom.toml --quiet");
    let file = ModelFile::read(&desk.folder.path().join("boom.toml")).unwrap();
    let grown = file.fitted("boom").unwrap();
    assert_eq!(grown.start, fitted.start);
    assert!(grown.parameters.contains_key("actuator_lag.time_constant"), "{grown:?}");
    assert_eq!(grown.verdict, None, "what is still missing was not looked for");
    // What was before a history without errors is not known.
    let older = "schema = \"tauscope/model/1\"\n[joint.boom]\nstructure = \"integrator\"\n\
                 parameters = { gain = 9.0, delay = 0.1 }\n[[joint.boom.history]]\nrevision = 1\n";
    desk.write("older.toml", older);
    desk.run("add dead_band log.csv --model older.toml --quiet");
    let file = ModelFile::read(&desk.folder.path().join("older.toml")).unwrap();
    assert_eq!((file.history("boom").len(), &file.fitted("boom").unwrap().start), (2, &None));
}
