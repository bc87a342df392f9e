//! `estimate --export`: the lookup is compiled and run, and gives what the table says.

use std::fmt::Write as _;
use std::fs;
use std::io::Write as _;
use std::path::Path;
use std::process::{Command, Stdio};

use serde_json::Value;

/// A step of a joint's input, and its delay where the table says it.
type Asked = (String, f64, f64);

/// What `program` prints when these are asked, a number a line.
fn answers(program: &mut Command, asked: &[Asked]) -> Vec<f64> {
    let mut lines = String::new();
    for (joint, from, to) in asked {
        writeln!(lines, "{joint} {from:?} {to:?}").unwrap();
    }
    let mut child = program.stdin(Stdio::piped()).stdout(Stdio::piped()).spawn().unwrap();
    child.stdin.take().unwrap().write_all(lines.as_bytes()).unwrap();
    let output = child.wait_with_output().unwrap();
    assert!(output.status.success());
    let text = String::from_utf8(output.stdout).unwrap();
    text.lines().map(|line| line.parse().unwrap()).collect()
}

fn is_there(program: &str) -> bool {
    let found = Command::new(program).arg("--version").output().is_ok();
    if !found {
        // Not `eprintln`, which the test runner keeps to itself.
        let mut terminal = std::io::stderr();
        writeln!(terminal, "skipped: no `{program}` to run the lookup in its language").unwrap();
    }
    found
}

const C: &str = r#"
#include "lookup.c"
#include <stdio.h>
int main(void)
{
    char joint[64];
    double from, to;
    while (scanf("%63s %lf %lf", joint, &from, &to) == 3) {
        printf("%.17g\n", tauscope_delay_s(joint, from, to));
    }
    return 0;
}
"#;

const PYTHON: &str = "
import sys
from lookup import delay_s
for line in sys.stdin:
    joint, a, b = line.split()
    print(delay_s(joint, float(a), float(b)))
";

const OCTAVE: &str = "while ischar(line = fgetl(stdin)) part = strsplit(line, ' '); printf('%.17g\\n', \
                      lookup(part{1}, str2double(part{2}), str2double(part{3}))); end";

/// What each language that is there answers.
fn all_answers(folder: &Path, asked: &[Asked]) -> Vec<(&'static str, Vec<f64>)> {
    let mut all = Vec::new();
    if is_there("cc") {
        fs::write(folder.join("main.c"), C).unwrap();
        let strict = ["-std=c99", "-Wall", "-Wextra", "-Wpedantic", "-Werror"];
        let compiled = Command::new("cc")
            .args(strict)
            .args(["main.c", "-o", "main", "-lm"])
            .current_dir(folder)
            .output()
            .unwrap();
        assert!(compiled.status.success(), "{}", String::from_utf8_lossy(&compiled.stderr));
        all.push(("C", answers(&mut Command::new(folder.join("main")), asked)));
    }
    if is_there("python3") {
        let mut python = Command::new("python3");
        all.push(("Python", answers(python.args(["-c", PYTHON]).current_dir(folder), asked)));
    }
    if is_there("octave-cli") {
        let mut octave = Command::new("octave-cli");
        all.push(("Octave", answers(octave.args(["--eval", OCTAVE]).current_dir(folder), asked)));
    }
    all
}

/// Runs `estimate` and writes the lookup in every language; the joints of its JSON.
fn export(folder: &Path) -> Vec<Value> {
    let mut found = Value::Null;
    for ending in ["c", "m", "py"] {
        let file = folder.join(format!("lookup.{ending}"));
        let output = Command::new(env!("CARGO_BIN_EXE_tauscope"))
            .args(["estimate", "data/manipulator.csv", "-q", "--format", "json", "--export"])
            .arg(&file)
            .output()
            .unwrap();
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        found = serde_json::from_slice(&output.stdout).unwrap();
    }
    found["joints"].as_array().unwrap().clone()
}

#[test]
fn the_lookup_gives_what_the_table_says_in_every_language() {
    let folder = tempfile::tempdir().unwrap();
    let joints = export(folder.path());
    let (mut asked, mut expected) = (Vec::new(), Vec::new());
    let mut ask = |joint: &str, from: f64, to: f64, delay: f64| {
        asked.push((joint.to_owned(), from, to));
        expected.push(delay);
    };
    for joint in &joints {
        let name = joint["joint"].as_str().unwrap();
        let number = |row: &Value, column: &str| row[column].as_f64().unwrap();
        let rows = joint["delay_table"].as_array().unwrap().iter();
        let starts = rows.filter(|row| row["transition"] == "start" && row["accepted"] != 0);
        let starts: Vec<_> =
            starts.map(|row| (number(row, "level_to"), number(row, "delay_median_s"))).collect();
        for (to, delay) in &starts {
            ask(name, 0.0, *to, *delay);
        }
        // Half way between two levels, and beyond the last one.
        for pair in starts.windows(2).filter(|pair| pair[0].0 * pair[1].0 > 0.0) {
            let middle = f64::midpoint(pair[0].0, pair[1].0);
            ask(name, 0.0, middle, f64::midpoint(pair[0].1, pair[1].1));
        }
        let (_, last) = starts.last().unwrap();
        ask(name, 0.0, 1e6, *last);
        ask(name, f64::NAN, 1.0, f64::NAN);
        let stop = joint["delay_table"].as_array().unwrap().iter();
        let stop = stop.filter(|row| row["transition"] == "stop" && row["accepted"] != 0);
        for row in stop {
            ask(name, number(row, "level_from"), 0.0, number(row, "delay_median_s"));
        }
    }
    for (language, answers) in all_answers(folder.path(), &asked) {
        assert_eq!(answers.len(), expected.len());
        for ((asked, answer), expected) in asked.iter().zip(answers).zip(&expected) {
            let same = (answer - expected).abs() < 1e-12 || (answer.is_nan() && expected.is_nan());
            assert!(same, "{language}: {asked:?}: {answer}, not {expected}");
        }
    }
}

#[test]
fn all_languages_agree_on_every_step_that_there_may_be() {
    let folder = tempfile::tempdir().unwrap();
    let joints = export(folder.path());
    let levels = || (-11..=11).map(|k| 0.23 * f64::from(k));
    let names = joints.iter().map(|joint| joint["joint"].as_str().unwrap());
    let asked: Vec<Asked> = names
        .flat_map(|name| levels().flat_map(move |a| levels().map(move |b| (name.to_owned(), a, b))))
        .collect();
    let all = all_answers(folder.path(), &asked);
    let Some((_, first)) = all.first() else { return };
    assert!(first.iter().filter(|answer| answer.is_finite()).count() > first.len() / 2);
    for (language, answers) in &all {
        for ((asked, a), b) in asked.iter().zip(first).zip(answers) {
            let same = (a - b).abs() < 1e-12 || (a.is_nan() && b.is_nan());
            assert!(same, "{language}: {asked:?}: {b}, not {a}");
        }
    }
}

#[test]
fn a_name_that_no_language_has_is_refused_before_the_work() {
    let folder = tempfile::tempdir().unwrap();
    for (file, why) in [("lookup.txt", ".c, .m or .py"), ("2nd try.m", "is not a valid name")] {
        let output = Command::new(env!("CARGO_BIN_EXE_tauscope"))
            .args(["estimate", "data/worked_example.csv", "-q", "--export"])
            .arg(folder.path().join(file))
            .output()
            .unwrap();
        assert_eq!(output.status.code(), Some(2));
        assert!(String::from_utf8(output.stderr).unwrap().contains(why));
        assert!(!folder.path().join(file).exists());
    }
}

/// `estimate` of a log with this input, which its output follows 12 samples late.
fn estimated(folder: &Path, input: impl Fn(i32) -> f64, options: &[&str]) -> std::process::Output {
    let mut text = "time_s,j.input,j.output\n".to_owned();
    let mut angle = 0.0;
    for k in 0..1500 {
        angle += 0.1 * input((k - 12).max(0));
        let noise = 0.01 * (f64::from(k) * 12.9898).sin();
        writeln!(text, "{:.2},{},{:.5}", f64::from(k) * 0.01, input(k), angle + noise).unwrap();
    }
    fs::write(folder.join("log.csv"), text).unwrap();
    Command::new(env!("CARGO_BIN_EXE_tauscope"))
        .current_dir(folder)
        .args(["estimate", "log.csv"])
        .args(options)
        .output()
        .unwrap()
}

#[test]
fn a_lookup_without_a_delay_is_not_written() {
    let folder = tempfile::tempdir().unwrap();
    let output =
        estimated(folder.path(), |_| 1.0, &["--export", "lookup.c", "--table", "table.csv"]);
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(1), "{said}");
    assert!(said.contains("lookup.c: not written"), "{said}");
    assert!(!folder.path().join("lookup.c").exists());
    let text = String::from_utf8_lossy(&output.stdout).into_owned();
    assert!(text.contains("j: no delay table: the input never changes"), "{text}");
}

/// `??/` is a backslash in C99, and would free the quotation mark after it.
#[test]
fn a_trigraph_in_a_name_ends_no_text() {
    let folder = tempfile::tempdir().unwrap();
    let mut text = "time_s,\"x??/\"\".input\",\"x??/\"\".output\"\n".to_owned();
    let (mut angle, mut acting) = (0.0, vec![0.0; 12]);
    for k in 0..2000 {
        let level = f64::from([1, 0, -1, 2, -2][(k / 100) % 5]);
        acting.push(level);
        angle += 0.1 * acting[k];
        writeln!(text, "{:.2},{level},{angle:.5}", k as f64 * 0.01).unwrap();
    }
    fs::write(folder.path().join("log.csv"), text).unwrap();
    let output = Command::new(env!("CARGO_BIN_EXE_tauscope"))
        .current_dir(folder.path())
        .args(["estimate", "log.csv", "-q", "--export", "lookup.c"])
        .output()
        .unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let source = fs::read_to_string(folder.path().join("lookup.c")).unwrap();
    assert!(source.contains(r#"{"x\?\?/\"", "#) && !source.contains("??/"), "{source}");
}

#[test]
fn the_one_dead_time_of_an_input_that_moves_is_exported() {
    let folder = tempfile::tempdir().unwrap();
    let moving = |k: i32| (f64::from(k) * 0.05).sin() + (f64::from(k) * 0.137).sin();
    for file in ["lookup.c", "lookup.m", "lookup.py"] {
        let output = estimated(folder.path(), moving, &["--export", file]);
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        let text = String::from_utf8_lossy(&output.stdout).into_owned();
        assert!(text.contains("dead time 0.1") && !text.contains("two-line"), "{text}");
        let source = fs::read_to_string(folder.path().join(file)).unwrap();
        assert!(source.contains("joint j: dead time 0.1"), "{source}");
    }
    let asked = [("j".to_owned(), -1.0, 1.5), ("j".to_owned(), 0.5, 0.2)];
    for (language, answers) in all_answers(folder.path(), &asked) {
        let near = answers.iter().all(|delay| (delay - 0.12).abs() < 0.03);
        assert!(near, "{language}: {answers:?}");
    }
}

#[test]
fn each_curve_says_what_it_is_from_and_an_unknown_joint_is_documented() {
    let folder = tempfile::tempdir().unwrap();
    export(folder.path());
    let read = |file: &str| fs::read_to_string(folder.path().join(file)).unwrap();
    for file in ["lookup.c", "lookup.m", "lookup.py"] {
        let source = read(file);
        assert!(source.contains(" steps, 95 % intervals in s: "), "{source}");
    }
    assert!(read("lookup.c").contains("NAN where no such step was measured, and where no joint"));
    assert!(read("lookup.m").contains("an error where no joint"));
    assert!(read("lookup.py").contains("Raises KeyError where"));
    for (language, answers) in
        all_answers(folder.path(), &[]).into_iter().filter(|(l, _)| *l == "C")
    {
        assert!(answers.is_empty(), "{language}");
        let unknown = [("nobody".to_owned(), 0.0, 1.0)];
        let mut program = Command::new(folder.path().join("main"));
        assert!(self::answers(&mut program, &unknown)[0].is_nan());
    }
}
