//! One log gives equal results on any number of threads, in any order of joints.

use std::collections::BTreeMap;
use std::fs;
use std::process::Command;

use serde_json::Value;
use tauscope::synthetic::{DelayLaw, InputSpec, JointSpec, PlantSpec, simulate, write_log};
use tempfile::TempDir;

const NAMES: [&str; 5] = ["boom", "arm", "bucket", "swing", "grip"];

/// A log of all joints, random but for its seed.
#[derive(Clone)]
struct Log {
    /// The cells of every line, the header first.
    lines: Vec<Vec<String>>,
}

impl Log {
    fn of_seed(seed: u64) -> Self {
        let joint = |name: &&str| {
            let input = InputSpec::Levels { levels: vec![-1.0, 0.0, 0.5, 2.0], hold_s: [0.1, 1.0] };
            let delay = DelayLaw::Uniform { min: 0.02, max: 0.4 };
            JointSpec { noise: 0.05, ..JointSpec::new(name, input, delay) }
        };
        let plant = PlantSpec::new(seed, 20.0, NAMES.iter().map(joint).collect());
        let mut bytes = Vec::new();
        write_log(&simulate(&plant).unwrap(), &mut bytes).unwrap();
        let text = String::from_utf8(bytes).unwrap();
        let cells = |line: &str| line.split(',').map(str::to_owned).collect();
        Self { lines: text.lines().map(cells).collect() }
    }

    /// The joints in the order of `places`; each has two columns after the time.
    fn in_order(&self, places: &[usize]) -> Self {
        let reorder = |cells: &Vec<String>| {
            let pairs = places.iter().flat_map(|place| &cells[2 * place + 1..2 * place + 3]);
            cells.iter().take(1).chain(pairs).cloned().collect()
        };
        Self { lines: self.lines.iter().map(reorder).collect() }
    }

    /// With text in the output of the joint in `place`.
    fn with_bad(&self, place: usize) -> Self {
        let mut bad = self.clone();
        "lost".clone_into(&mut bad.lines[700][2 * place + 2]);
        bad
    }

    fn text(&self) -> String {
        self.lines.iter().map(|cells| cells.join(",") + "\n").collect()
    }
}

/// Everything that a run gives.
#[derive(Debug, PartialEq, Eq)]
struct Results {
    status: Option<i32>,
    stdout: String,
    stderr: String,
    decisions: String,
    delays: String,
}

impl Results {
    /// Of `estimate` on `logs`, as `log0.csv`, `log1.csv`, …
    fn of(logs: &[Log], options: &[&str]) -> Self {
        let folder: TempDir = tempfile::tempdir().unwrap();
        let names: Vec<String> = (0..logs.len()).map(|index| format!("log{index}.csv")).collect();
        for (name, log) in names.iter().zip(logs) {
            fs::write(folder.path().join(name), log.text()).unwrap();
        }
        let ran = Command::new(env!("CARGO_BIN_EXE_tauscope"))
            .arg("estimate")
            .args(names)
            .args(["--decisions", "decisions.csv", "--delays", "delays.csv"])
            .args(options)
            .current_dir(folder.path())
            .output()
            .unwrap();
        let read = |name| fs::read_to_string(folder.path().join(name)).unwrap();
        Self {
            status: ran.status.code(),
            stdout: String::from_utf8(ran.stdout).unwrap(),
            stderr: String::from_utf8(ran.stderr).unwrap(),
            decisions: read("decisions.csv"),
            delays: read("delays.csv"),
        }
    }

    /// The results of each joint: its JSON, its decisions, its column of delays.
    fn by_joint(&self) -> BTreeMap<String, (Value, Vec<String>, Vec<String>)> {
        let json: Value = serde_json::from_str(&self.stdout).unwrap();
        let mut delays = csv::Reader::from_reader(self.delays.as_bytes());
        let header = delays.headers().unwrap().clone();
        let rows: Vec<_> = delays.records().map(Result::unwrap).collect();
        let of_joint = |joint: &Value| {
            let name = joint["joint"].as_str().unwrap();
            let start = format!("{name},");
            let decisions = self.decisions.lines().filter(|line| line.starts_with(&start));
            let tau = format!("{name}.tau");
            let column = header.iter().position(|column| column == tau).unwrap();
            let taus = rows.iter().map(|row| row[column].to_owned()).collect();
            (name.to_owned(), (joint.clone(), decisions.map(str::to_owned).collect(), taus))
        };
        json["joints"].as_array().unwrap().iter().map(of_joint).collect()
    }

    /// The joints' names, in the order of the output.
    fn order(&self) -> Vec<String> {
        let json: Value = serde_json::from_str(&self.stdout).unwrap();
        let joints = json["joints"].as_array().unwrap().iter();
        joints.map(|joint| joint["joint"].as_str().unwrap().to_owned()).collect()
    }
}

const JSON: [&str; 2] = ["--format", "json"];

#[test]
fn any_number_of_threads_gives_the_same_bytes() {
    let logs = [Log::of_seed(1), Log::of_seed(2).with_bad(3), Log::of_seed(3)];
    for format in ["text", "json"] {
        let on = |threads: &str| Results::of(&logs, &["--format", format, "--threads", threads]);
        let one = on("1");
        assert_eq!(one.status, Some(1), "{}", one.stderr);
        assert!(one.decisions.lines().count() > 300, "{}", one.decisions);
        for threads in ["2", "7"] {
            assert_eq!(on(threads), one, "{format}, {threads} threads");
        }
        assert_eq!(Results::of(&logs, &["--format", format]), one, "{format}, all threads");
    }
}

#[test]
fn delays_behind_a_shared_lag_are_the_same_on_any_number_of_threads() {
    let log = [Log::of_seed(8)];
    let on = |threads: &str| {
        let methods = ["--method", "lag-aware", "--method", "hinge"];
        let joints = ["--joint", "boom", "--joint", "grip"];
        let options = [methods.as_slice(), &joints, &JSON, &["--threads", threads]];
        Results::of(&log, &options.concat())
    };
    let one = on("1");
    assert_eq!(one.status, Some(0), "{}", one.stderr);
    assert!(one.decisions.contains(",lag-aware,") && one.decisions.contains(",hinge,"));
    assert_eq!(on("3"), one);
}

#[test]
fn another_run_gives_the_same_bytes() {
    let run = || Results::of(&[Log::of_seed(4)], &JSON);
    assert_eq!(run(), run());
}

#[test]
fn joints_in_another_order_give_the_same_results_in_that_order() {
    let log = Log::of_seed(5);
    let straight = Results::of(std::slice::from_ref(&log), &JSON);
    assert_eq!(straight.order(), NAMES);
    for places in [[4, 3, 2, 1, 0], [1, 2, 3, 4, 0], [0, 3, 1, 4, 2]] {
        let permuted = Results::of(&[log.in_order(&places)], &JSON);
        assert_eq!(permuted.order(), places.map(|place| NAMES[place]));
        assert_eq!(permuted.by_joint(), straight.by_joint(), "{places:?}");
    }
}

#[test]
fn a_joint_alone_gives_what_it_gives_among_others() {
    let log = Log::of_seed(6);
    let all = Results::of(std::slice::from_ref(&log), &JSON).by_joint();
    for (place, name) in NAMES.iter().enumerate() {
        let alone = Results::of(&[log.in_order(&[place])], &JSON).by_joint();
        assert_eq!(alone[*name], all[*name]);
        let asked_for =
            Results::of(std::slice::from_ref(&log), &["--joint", name, JSON[0], JSON[1]]);
        assert_eq!(asked_for.by_joint(), alone);
    }
}

#[test]
fn whichever_joint_fails_the_others_stay_the_same() {
    let log = Log::of_seed(7);
    let all = Results::of(std::slice::from_ref(&log), &JSON).by_joint();
    for (place, name) in NAMES.iter().enumerate() {
        let results = Results::of(&[log.with_bad(place)], &JSON);
        assert_eq!(results.status, Some(1), "{}", results.stderr);
        let mut others = all.clone();
        others.remove(*name);
        assert_eq!(results.by_joint(), others, "without {name}");
    }
    let two = Results::of(&[log.with_bad(1).with_bad(4)], &JSON);
    let warnings: Vec<_> =
        two.stderr.lines().filter(|line| line.starts_with("warning: ")).collect();
    assert!(warnings.len() == 2 && warnings[0].contains("`arm`"), "{warnings:?}");
    assert_eq!(two.order(), ["boom", "bucket", "swing"]);
}
