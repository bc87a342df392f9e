//! Many logs, each by itself: one table of all, whatever way they were worked on.

use std::fs;
use std::path::PathBuf;
use std::process::{Command, Output};

use crate::desk::{Desk, banded};
use serde_json::Value;
use tauscope::synthetic::{DelayLaw, InputSpec, JointSpec, PlantSpec, simulate, write_log};
use tempfile::TempDir;

/// A folder with a folder of logs.
struct Workspace {
    folder: TempDir,
}

impl Workspace {
    /// Logs of two joints, a third of a minute each, no two alike.
    fn with_logs(count: u64) -> Self {
        let workspace = Self { folder: tempfile::tempdir().unwrap() };
        fs::create_dir(workspace.path("logs")).unwrap();
        for seed in 0..count {
            workspace.write_log(&format!("logs/run_{seed:02}.csv"), seed);
        }
        workspace
    }

    fn write_log(&self, name: &str, seed: u64) {
        let joint = |name: &str, seconds| {
            let levels = vec![-1.5, -0.5, 0.5, 1.5];
            let input = InputSpec::Levels { levels, hold_s: [0.8, 1.6] };
            let spec = JointSpec::new(name, input, DelayLaw::Constant { seconds });
            JointSpec { noise: 0.05, ..spec }
        };
        let joints = vec![joint("boom", 0.12), joint("arm", 0.2)];
        let plant = PlantSpec { sample_period_s: 0.02, ..PlantSpec::new(seed, 20.0, joints) };
        let log = fs::File::create(self.path(name)).unwrap();
        write_log(&simulate(&plant).unwrap(), log).unwrap();
    }

    fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    fn read(&self, name: &str) -> String {
        fs::read_to_string(self.path(name)).unwrap()
    }

    fn run(&self, arguments: &str) -> Outcome {
        let output = Command::new(env!("CARGO_BIN_EXE_tauscope"))
            .current_dir(self.folder.path())
            .args(arguments.split(' '))
            .output()
            .unwrap();
        Outcome::of(&output, arguments)
    }
}

/// What a command said.
struct Outcome {
    status: Option<i32>,
    out: String,
    error: String,
}

impl Outcome {
    fn of(output: &Output, arguments: &str) -> Self {
        let text = |bytes: &[u8]| String::from_utf8(bytes.to_vec()).unwrap();
        let (out, error) = (text(&output.stdout), text(&output.stderr));
        assert!(!error.contains("panicked"), "{arguments}: {error}");
        Self { status: output.status.code(), out, error }
    }

    fn is_whole(&self) -> &Self {
        assert_eq!(self.status, Some(0), "{}", self.error);
        self
    }

    fn says(&self, part: &str) -> &Self {
        assert!(self.error.contains(part), "{}", self.error);
        self
    }

    fn is_refused_with(&self, part: &str) {
        assert_eq!(self.status, Some(2), "{}", self.error);
        assert_eq!(self.error.lines().count(), 1, "{}", self.error);
        self.says(part);
    }
}

#[test]
fn the_table_of_all_decisions_is_that_of_each_log_behind_its_name() {
    let workspace = Workspace::with_logs(3);
    for method in ["two-line", "hinge"] {
        let all = format!("estimate logs --results {method} --decisions all.csv --method {method}");
        workspace.run(&all).is_whole();
        let mut expected = Vec::new();
        for number in 0..3 {
            let log = format!("logs/run_{number:02}.csv");
            workspace
                .run(&format!("estimate {log} --decisions one.csv --method {method}"))
                .is_whole();
            let one = workspace.read("one.csv");
            let mut lines = one.lines();
            let header = format!("file,{}", lines.next().unwrap());
            expected.extend((number == 0).then_some(header));
            expected.extend(lines.map(|line| format!("{log},{line}")));
        }
        let found = workspace.read("all.csv");
        assert!(found.lines().eq(expected.iter()), "{method}:\n{found}\n{}", expected.join("\n"));
    }
}

#[test]
fn what_is_done_and_unchanged_is_not_done_again() {
    let workspace = Workspace::with_logs(3);
    let first = workspace.run("estimate logs --results kept --summary all.csv");
    let table = workspace.read("all.csv");
    let again = workspace.run("estimate logs --results kept --summary all.csv");
    again.is_whole().says("3 of 3 logs are done already");
    assert_eq!((again.out.as_str(), workspace.read("all.csv")), (first.out.as_str(), table));

    workspace.write_log("logs/run_01.csv", 40);
    let changed = workspace.run("estimate logs --results kept");
    changed.is_whole().says("2 of 3 logs are done already");
    let other = workspace.run("estimate logs --results kept --beta 2");
    let other = &other.is_whole().error;
    assert!(!other.contains("already"), "{other}");
    fs::write(workspace.path("map.toml"), "time = \"time_s\"").unwrap();
    let map = "estimate logs --results kept --columns map.toml";
    workspace.run(map).is_whole();
    workspace.run(map).says("3 of 3 logs are done already");
    fs::write(workspace.path("map.toml"), "# changed\ntime = \"time_s\"").unwrap();
    assert!(!workspace.run(map).is_whole().error.contains("already"));
}

#[test]
fn parts_have_the_bytes_of_one_run() {
    let workspace = Workspace::with_logs(5);
    let ending = if cfg!(feature = "parquet") { "parquet" } else { "summary.csv" };
    let tables = |name: &str| format!("--decisions {name}.csv --summary {name}.{ending}");
    let one = workspace.run(&format!("estimate logs --results one --threads 1 {}", tables("one")));
    one.is_whole();
    for part in [3, 1, 2] {
        let command = format!("estimate logs --results parts --shard {part}/3 --threads 2");
        workspace.run(&command).is_whole().says(&format!("part {part} of 3"));
    }
    let all = workspace.run(&format!("estimate logs --results parts {}", tables("merged")));
    all.says("5 of 5 logs are done already");
    assert_eq!(all.is_whole().out, one.out);
    let mut compared = 0;
    for entry in fs::read_dir(workspace.folder.path()).unwrap() {
        let name = entry.unwrap().file_name().into_string().unwrap();
        if let Some(rest) = name.strip_prefix("one.") {
            let merged = workspace.path(&format!("merged.{rest}"));
            assert!(
                fs::read(workspace.path(&name)).unwrap() == fs::read(merged).unwrap(),
                "{name}"
            );
            compared += 1;
        }
    }
    assert_eq!(compared, 2);
}

#[test]
fn a_log_that_fails_is_named_and_tried_again() {
    let workspace = Workspace::with_logs(3);
    fs::write(workspace.path("logs/run_01.csv"), "time_s,boom.input\n0,1\n").unwrap();
    for _ in 0..2 {
        let found = workspace.run("estimate logs --results kept --summary all.csv");
        assert_eq!(found.status, Some(1));
        found.says("logs/run_01.csv, row 1: column `boom.output` is missing");
        assert_eq!(workspace.read("all.csv").lines().count(), 1 + 2 * 2);
    }
    workspace.write_log("logs/run_01.csv", 1);
    workspace.run("estimate logs --results kept").is_whole().says("2 of 3 logs are done already");
    fs::write(workspace.path("logs/run_01.csv"), "time_s,boom.input\n0,1\n").unwrap();
    assert_eq!(workspace.run("estimate logs --results kept").status, Some(1));
}

#[test]
fn a_joint_that_fails_is_told_by_each_run() {
    let workspace = Workspace::with_logs(2);
    let log = workspace.read("logs/run_01.csv");
    let broken = log.replacen("arm.output", "arm.outptu", 1);
    fs::write(workspace.path("logs/run_01.csv"), broken).unwrap();
    for _ in 0..2 {
        let found = workspace.run("estimate logs --results kept");
        assert_eq!(found.status, Some(1));
        found.says("joint `arm` is left out: logs/run_01.csv");
    }
}

#[test]
fn joints_are_held_together_across_the_logs() {
    let workspace = Workspace::with_logs(4);
    let found = workspace.run("estimate logs --results kept --format json");
    let json: Value = serde_json::from_str(&found.is_whole().out).unwrap();
    assert_eq!(json["schema"], "tauscope/folder/1");
    assert_eq!(json["logs"].as_array().unwrap().len(), 4);
    for (joint, delay_s) in json["joints"].as_array().unwrap().iter().zip([0.12, 0.2]) {
        assert_eq!(joint["logs"], 4);
        let summary = json["summary"].as_array().unwrap().iter();
        let own = summary.filter(|row| row["joint"] == joint["joint"]);
        let accepted: u64 = own.map(|row| row["accepted"].as_u64().unwrap()).sum();
        assert_eq!(joint["accepted"], accepted);
        let median = joint["delay_s"]["median"].as_f64().unwrap();
        assert!((median - delay_s).abs() <= 0.05, "{joint}");
    }
}

#[test]
fn improve_keeps_a_model_of_each_log() {
    let workspace = Workspace::with_logs(2);
    let command = "improve logs --results kept --summary all.csv --effects dead_band,stiction";
    workspace.run(command).is_whole();
    workspace.run(command).is_whole().says("2 of 2 logs are done already");
    let table = workspace.read("all.csv");
    assert!(table.starts_with("file,joint,verdict,revision,effects,train_rmse,validation_rmse"));
    assert_eq!(table.lines().count(), 1 + 2 * 2, "{table}");
    let models = fs::read_dir(workspace.path("kept")).unwrap().map(|entry| entry.unwrap().path());
    let models: Vec<_> = models.filter(|path| path.extension().unwrap() == "toml").collect();
    assert_eq!(models.len(), 2);
    assert!(fs::read_to_string(&models[0]).unwrap().contains("[joint.boom]"));
    fs::remove_file(&models[0]).unwrap();
    workspace.run(command).is_whole().says("1 of 2 logs are done already");
    assert!(fs::read_to_string(&models[0]).unwrap().contains("[joint.boom]"));
    assert!(!workspace.path("model.toml").exists());
    workspace.run("estimate logs --results kept").is_refused_with("kept: has results of `improve`");
}

#[test]
fn what_makes_no_sense_is_refused_with_the_remedy() {
    let workspace = Workspace::with_logs(2);
    workspace.run("estimate logs --shard 1/2").says("--results");
    workspace.run("estimate logs --results r --shard 3/2").says("expected K/N");
    workspace.run("estimate logs --results r --delays d.csv").is_refused_with("it is for one log");
    workspace
        .run("estimate logs --results r --shard 1/2 --summary s.csv")
        .is_refused_with("without `--shard`, when all parts are done");
    workspace.run("estimate nowhere --results r").says("nowhere");
    workspace.run("estimate logs --results one").is_whole();
    let result = fs::read_dir(workspace.path("one")).unwrap().next().unwrap().unwrap();
    let result = result.file_name().into_string().unwrap();
    for table in [result.replace(".json", ".toml"), result] {
        workspace
            .run(&format!("estimate logs --results one --summary one/{table}"))
            .is_refused_with("call it FILE.csv or FILE.parquet");
    }
    workspace.run("estimate logs --results new --summary new/all.csv").is_whole();
}

#[test]
fn json_of_another_program_is_left_alone() {
    let workspace = Workspace::with_logs(2);
    workspace.run("estimate logs --results kept").is_whole();
    let foreign = "{\"schema\": \"of/another/1\", \"key\": 3}";
    fs::write(workspace.path("kept/other.json"), foreign).unwrap();
    workspace.run("estimate logs --results kept").is_whole();
    // Under the name of a result it is not replaced: the other logs are done all the same.
    let result = fs::read_dir(workspace.path("kept")).unwrap().map(|entry| entry.unwrap().path());
    let result = result.filter(|path| !path.ends_with("other.json")).min().unwrap();
    fs::write(&result, foreign).unwrap();
    let again = workspace.run("estimate logs --results kept --summary all.csv");
    assert_eq!(again.status, Some(1));
    again.says("has the name of a result, but tauscope did not write it; move it");
    assert_eq!(fs::read_to_string(result).unwrap(), foreign);
    assert_eq!(workspace.read("all.csv").lines().count(), 1 + 2);
}

#[test]
#[cfg(unix)]
fn a_log_that_can_be_read_once_is_refused_beside_the_others() {
    let workspace = Workspace::with_logs(1);
    let pipe = workspace.path("pipe.csv");
    assert!(Command::new("mkfifo").arg(&pipe).status().unwrap().success());
    let found = workspace.run("estimate pipe.csv logs/run_00.csv --results kept --summary all.csv");
    assert_eq!(found.status, Some(1));
    found.says("pipe.csv: a pipe or a device can be read once");
    assert_eq!(workspace.read("all.csv").lines().count(), 1 + 2);
}

#[test]
#[cfg(unix)]
fn a_pipe_under_the_name_of_a_result_is_not_waited_for() {
    let workspace = Workspace::with_logs(2);
    workspace.run("estimate logs --results kept").is_whole();
    let result = fs::read_dir(workspace.path("kept")).unwrap().next().unwrap().unwrap().path();
    fs::remove_file(&result).unwrap();
    let make = || Command::new("mkfifo").arg(&result).status().unwrap().success();
    assert!(make());
    let again = workspace.run("estimate logs --results kept");
    assert_eq!(again.status, Some(1));
    again.says("a result must be a file of its own; remove it");
}

#[test]
#[cfg(unix)]
fn a_link_under_the_name_of_a_model_is_not_written_through() {
    let workspace = Workspace::with_logs(1);
    let command = "improve logs --results kept --max-effects 0";
    workspace.run(command).is_whole();
    let kept = fs::read_dir(workspace.path("kept")).unwrap().map(|entry| entry.unwrap().path());
    for file in kept.collect::<Vec<_>>() {
        fs::remove_file(&file).unwrap();
        if file.extension().unwrap() == "toml" {
            std::os::unix::fs::symlink(workspace.path("other.csv"), file).unwrap();
        }
    }
    fs::write(workspace.path("other.csv"), "a log").unwrap();
    let again = workspace.run(command);
    assert_eq!(again.status, Some(2));
    again.says("a result must be a file of its own; remove it");
    assert_eq!(workspace.read("other.csv"), "a log");
}

/// The interpreter for the example, where it has what the example needs.
fn python() -> Option<String> {
    let python = std::env::var("PYTHON").unwrap_or_else(|_| "python3".to_owned());
    let found = Command::new(&python).args(["-c", "import distributed"]).output();
    found.is_ok_and(|output| output.status.success()).then_some(python)
}

#[test]
fn dask_makes_the_bytes_of_one_process() {
    let Some(python) = python() else {
        // Not `eprintln`, which the test runner keeps to itself.
        let mut terminal = std::io::stderr();
        std::io::Write::write_all(
            &mut terminal,
            b"skipped: no Python with dask.distributed; see examples/dask/requirements.txt\n",
        )
        .unwrap();
        return;
    };
    // Four logs for each of two workers.
    let workspace = Workspace::with_logs(8);
    workspace.run("estimate logs --results one --decisions one.csv --beta 2").is_whole();
    let script = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("examples/dask/estimate_folder.py");
    let output = Command::new(python)
        .current_dir(workspace.folder.path())
        .arg(script)
        .args(["logs", "--results", "many", "--decisions", "many.csv", "--workers", "2"])
        .args(["--tauscope", env!("CARGO_BIN_EXE_tauscope"), "--", "--beta", "2"])
        .output()
        .unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    assert!(workspace.read("many.csv") == workspace.read("one.csv"));
    let said = String::from_utf8(output.stdout).unwrap();
    assert!(said.contains("8 logs, each by itself"), "{said}");
}

#[test]
fn a_joint_that_some_logs_lack_is_read_from_the_others() {
    let desk = Desk::with(vec![banded("boom"), banded("arm")]);
    fs::create_dir(desk.folder.path().join("logs")).unwrap();
    let log = desk.read("log.csv");
    desk.write("logs/1.csv", &log);
    for name in ["2", "3"] {
        desk.write(&format!("logs/{name}.csv"), &log.replace("boom.", "stick."));
    }
    let ended = desk.run("estimate logs --joint boom");
    let said = String::from_utf8(ended.stderr).unwrap();
    assert_eq!(ended.status.code(), Some(0), "{said}");
    let note = "joint `boom`: 2 of 3 logs do not have it and are skipped";
    assert!(said.contains(note) && !said.contains("left out"), "{said}");
    // Also where names of columns say which logs have it.
    let mapped = desk.run("estimate logs --joint b=boom.input:boom.output");
    let said = String::from_utf8(mapped.stderr).unwrap();
    assert_eq!(mapped.status.code(), Some(0), "{said}");
    assert!(said.contains(&note.replace("boom", "b")), "{said}");
    let refused = desk.refusal("estimate logs --joint bucket");
    assert!(refused.contains("no joint `bucket`"), "{refused}");
    // One that no log has is missed, whatever else is there.
    assert_eq!(desk.run("estimate logs --joint boom --joint bucket").status.code(), Some(1));
}
