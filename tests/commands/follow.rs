//! `estimate --follow` on a log that grows: each decision as its step completes, and in the
//! end what the whole log gives.

use std::fs::{File, OpenOptions};
use std::io::{BufRead as _, BufReader, Lines, Write as _};
use std::process::{Child, ChildStdout, Stdio};
use std::time::Duration;

use crate::desk::{Desk, banded, joint};
use flate2::Compression;
use flate2::write::GzEncoder;
use serde_json::Value;

/// A log that is written in pieces while the program follows it.
struct Growing {
    desk: Desk,
    whole: Vec<u8>,
    written: usize,
    program: Child,
    lines: Lines<BufReader<ChildStdout>>,
}

impl Growing {
    fn of(desk: Desk, arguments: &str) -> Self {
        let whole = std::fs::read(desk.folder.path().join("log.csv")).unwrap();
        let mut command = desk.command(&format!("estimate grows.csv --follow {arguments}"));
        let mut program = command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
        let lines = BufReader::new(program.stdout.take().unwrap()).lines();
        Self { desk, whole, written: 0, program, lines }
    }

    /// Writes on until this part of the log is there, in pieces that heed no line.
    fn write_until(&mut self, part: f64) {
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a part")]
        let end = (part * self.whole.len() as f64) as usize;
        let path = self.desk.folder.path().join("grows.csv");
        let mut file: File = OpenOptions::new().create(true).append(true).open(path).unwrap();
        for piece in self.whole[self.written..end].chunks(4096) {
            file.write_all(piece).unwrap();
            std::thread::sleep(Duration::from_millis(5));
        }
        self.written = end;
    }

    fn next(&mut self) -> Value {
        serde_json::from_str(&self.lines.next().unwrap().unwrap()).unwrap()
    }

    /// What else is printed, and the program's messages.
    fn rest(self) -> (Vec<Value>, String, Desk) {
        let rest = self.lines.map(|line| serde_json::from_str(&line.unwrap()).unwrap()).collect();
        let output = self.program.wait_with_output().unwrap();
        assert_eq!(output.status.code(), Some(0));
        (rest, String::from_utf8(output.stderr).unwrap(), self.desk)
    }
}

const BATCH: &str = "estimate log.csv --method two-line --beta 2 --decisions batch.csv";

#[test]
fn decisions_come_while_the_log_grows_and_are_those_of_the_whole_log() {
    let desk = Desk::with(vec![joint("boom"), banded("stick")]);
    let batch = desk.json(BATCH, 0);
    let steps: usize = batch["joints"]
        .as_array()
        .unwrap()
        .iter()
        .map(|joint| joint["decisions"].as_array().unwrap().len())
        .sum();
    let arguments = "--beta 2 --format json --idle 1 --decisions followed.csv";
    let mut growing = Growing::of(desk, arguments);
    growing.write_until(0.5);
    // Half of the log is not there yet when these come.
    let mut told: Vec<Value> = (0..6).map(|_| growing.next()).collect();
    growing.write_until(1.0);
    let (mut rest, stderr, desk) = growing.rest();
    let document = rest.pop().unwrap();
    told.append(&mut rest);
    assert_eq!(document["schema"], "tauscope/estimate/1");
    assert_eq!(document["joints"], batch["joints"]);
    assert!(!stderr.contains("with the whole log"), "{stderr}");
    // All but the last of each joint, whose segments end with the log.
    assert!(told.len() >= steps - 6 && told.len() < steps, "{} of {steps}", told.len());
    let whole = desk.read("batch.csv");
    for step in &told {
        assert_eq!(step["schema"], "tauscope/step/1");
        let text = |name: &str| step[name].to_string().replace('"', "");
        let start = format!("{},{},{},{},", text("joint"), text("trial"), text("i"), text("p"));
        let row = whole.lines().find(|row| row.starts_with(&start)).unwrap();
        let cells: Vec<&str> = row.split(',').collect();
        assert_eq!(cells[8], text("q").replace("null", ""), "{row}");
        assert_eq!(cells[9], text("delta").replace("null", ""), "{row}");
        assert_eq!(cells[16], text("verdict"), "{row}");
    }
    assert_eq!(desk.read("followed.csv"), whole);
}

#[test]
fn a_log_that_is_no_text_is_read_to_its_last_byte() {
    let desk = Desk::with(vec![joint("boom")]);
    let mut packed = GzEncoder::new(Vec::new(), Compression::fast());
    packed.write_all(desk.read("log.csv").as_bytes()).unwrap();
    let packed = packed.finish().unwrap();
    assert_ne!(packed.last(), Some(&b'\n'));
    std::fs::write(desk.folder.path().join("grows.csv.gz"), packed).unwrap();
    let output = desk.run("estimate grows.csv.gz --follow --idle 0 --beta 2");
    let said = String::from_utf8(output.stderr).unwrap();
    assert!(output.status.success() && !said.contains("waiting"), "{said}");
    assert!(String::from_utf8(output.stdout).unwrap().lines().count() > 15);
}

#[test]
fn lines_for_people_say_when_and_how_late() {
    let desk = Desk::with(vec![joint("boom")]);
    desk.write("grows.csv", &desk.read("log.csv"));
    let output = desk.run("estimate grows.csv --follow --idle 0 --beta 2");
    assert!(output.status.success());
    let text = String::from_utf8(output.stdout).unwrap();
    let lines: Vec<&str> = text.lines().take_while(|line| line.starts_with("boom, step")).collect();
    assert!(lines.len() > 15 && lines[0].ends_with("rejected, first_or_last"), "{text}");
    assert!(lines[1].contains(" V: delay 0.") && lines[1].ends_with("samples)"), "{text}");
    assert!(text.contains("│ boom "), "the table follows: {text}");
}

#[cfg(unix)]
#[test]
fn ctrl_c_ends_it_with_the_results() {
    let desk = Desk::with(vec![joint("boom")]);
    let mut growing = Growing::of(desk, "--format json");
    growing.write_until(1.0);
    growing.next();
    let id = growing.program.id().to_string();
    std::process::Command::new("kill").args(["-INT", &id]).status().unwrap();
    let (rest, stderr, _) = growing.rest();
    assert_eq!(rest.last().unwrap()["schema"], "tauscope/estimate/1");
    assert!(stderr.contains("stopping: at the log's end"), "{stderr}");
}

#[test]
fn what_cannot_be_followed_is_refused() {
    let desk = Desk::with(vec![joint("boom")]);
    let refused = [
        ("log.csv log.csv --follow", "expected one log"),
        (". --follow", "this is a folder"),
        ("log.csv --follow --method hinge", "--method two-line"),
        ("log.csv --follow --method two-line --method hinge", "only one method"),
        ("log.csv --follow --confidence 0.99", "--confidence none"),
        ("log.csv --follow --fill 1", "`--fill`"),
        ("log.csv --idle 3", "--follow"),
        ("later.csv --follow --idle 1 --decisions ./later.csv", "a file that is read"),
        ("missing.csv --follow --idle 0", "missing.csv: cannot be read"),
    ];
    for (arguments, why) in refused {
        let stderr = desk.refusal(&format!("estimate {arguments}"));
        assert!(stderr.contains(why), "{arguments}: {stderr}");
    }
}
