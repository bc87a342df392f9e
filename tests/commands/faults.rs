//! Faults from outside: programs that are killed, disks that are full, readers that leave, two
//! runs at once, logs that are exchanged. Afterwards a file is what it was or what it was to
//! become, and nothing else is there that the next run does not remove.
//!
//! `TAUSCOPE_KILLS` says how often each command is ended, 2 unless given.
#![cfg(unix)]

use std::collections::BTreeMap;
use std::fs::{self, File};
use std::io::{BufRead as _, BufReader, Write as _};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

use crate::desk::{Desk, banded, joint};
use rand::{RngExt as _, SeedableRng as _};
use rand_chacha::ChaCha8Rng;
use tauscope::model::ModelFile;

/// Commands that write files, each in a way of its own.
const COMMANDS: [&str; 10] = [
    "estimate log.csv --decisions d.csv --delays t.csv --review-sheet r.csv --table l.csv",
    "estimate log.csv --joint boom --export l.c",
    "estimate logs --results kept --summary s.csv --decisions all.csv",
    "add dead_band log.csv -m model.toml -w added.toml",
    "improve log.csv --joint stick -m model.toml -w better.toml --max-effects 1",
    "simulate plant.toml -o made.csv --truth truth.csv",
    "design --model model.toml --joint boom --output-range=-40,40 --duration 20 -o input.csv",
    "report log.csv -m model.toml -o page.html",
    "export model.toml --joint stick stick.c",
    "columns log.csv -w columns.toml",
];

/// A plant of two joints for 20 seconds.
const PLANT: &str = r#"
schema = "tauscope/plant/1"
seed = 4
duration_s = 20.0
[[joint]]
name = "boom"
input = { levels = [-1.0, 1.0], hold_s = [0.5, 1.0] }
delay = { law = "constant", seconds = 0.15 }
noise = 0.05
"#;

const MODEL: &str = r#"
schema = "tauscope/model/1"
[joint.boom]
structure = "integrator"
parameters = { gain = 10.0, delay = 0.12 }
[joint.stick]
structure = "integrator"
parameters = { gain = 9.0, delay = 0.1 }
"#;

/// Every file of a folder and of those in it, by its name.
type Files = BTreeMap<PathBuf, Vec<u8>>;

/// A command, its folder, and what it makes of it when nothing disturbs it.
struct Job {
    desk: Desk,
    command: &'static str,
    before: Files,
    after: Files,
    takes: Duration,
}

impl Job {
    fn new(command: &'static str) -> Self {
        let desk = Desk::for_seconds(20.0, vec![joint("boom"), banded("stick")]);
        desk.write("model.toml", MODEL);
        desk.write("plant.toml", PLANT);
        fs::create_dir(desk.folder.path().join("logs")).unwrap();
        for name in ["logs/a.csv", "logs/b.csv"] {
            desk.write(name, &desk.read("log.csv"));
        }
        let mut job = Self {
            before: files(desk.folder.path()),
            after: Files::new(),
            takes: Duration::ZERO,
            desk,
            command,
        };
        let start = Instant::now();
        let output = job.start().wait_with_output().unwrap();
        let said = String::from_utf8_lossy(&output.stderr);
        assert!(matches!(output.status.code(), Some(0 | 1)), "{command}: {said}");
        job.takes = start.elapsed();
        job.after = job.files();
        assert!(job.after.len() > job.before.len(), "{command} writes nothing");
        // What stands under the names of the outputs, so that it can be lost.
        for name in job.made().cloned().collect::<Vec<_>>() {
            if !name.starts_with("kept") {
                job.before.insert(name, b"old\n".to_vec());
            }
        }
        job
    }

    fn start(&self) -> Child {
        let mut command = self.desk.command(self.command);
        command.stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::piped()).spawn().unwrap()
    }

    fn files(&self) -> Files {
        files(self.desk.folder.path())
    }

    /// Names of the outputs.
    fn made(&self) -> impl Iterator<Item = &PathBuf> {
        self.after.iter().filter(|(name, bytes)| self.before.get(*name) != Some(bytes)).map(|f| f.0)
    }

    /// Makes the folder what it was before.
    fn restore(&self) {
        for name in self.files().keys().filter(|name| !self.before.contains_key(*name)) {
            fs::remove_file(self.desk.folder.path().join(name)).unwrap();
        }
        for (name, bytes) in &self.before {
            fs::write(self.desk.folder.path().join(name), bytes).unwrap();
        }
    }

    /// Whether each file is as it was before or as it is after, but for parts of files.
    fn check(&self, what: &str) {
        for (name, bytes) in self.files() {
            let is = |files: &Files| files.get(&name) == Some(&bytes);
            // An improvement that was interrupted keeps what it has come to.
            let is_model = || {
                let text = String::from_utf8_lossy(&bytes);
                name.ends_with("better.toml") && ModelFile::parse(&text, &name).is_ok()
            };
            let is_whole = is(&self.before) || is(&self.after) || is_part(&name) || is_model();
            assert!(
                is_whole,
                "{}, {what}: {} is neither old nor new",
                self.command,
                name.display()
            );
        }
    }

    /// Whether the next run makes everything as it should be.
    fn check_next(&self) {
        for name in self.files().keys().filter(|name| is_part(name)) {
            fs::remove_file(self.desk.folder.path().join(name)).unwrap();
        }
        // A folder of results is written to only where one is missing.
        for name in self.made().filter(|name| name.starts_with("kept")) {
            fs::remove_file(self.desk.folder.path().join(name)).unwrap_or_default();
        }
        self.start().wait_with_output().unwrap();
        assert!(self.files() == self.after, "{}: {:?}", self.command, self.files().keys());
    }

    /// Whether no program works in the folder any more, soon.
    fn check_alone(&self) {
        let folder = self.desk.folder.path().canonicalize().unwrap();
        let start = Instant::now();
        while works_in(&folder) {
            assert!(start.elapsed() < Duration::from_secs(20), "{}: orphans", self.command);
            std::thread::sleep(Duration::from_millis(10));
        }
    }
}

fn is_part(name: &Path) -> bool {
    let name = name.file_name().unwrap().to_string_lossy();
    name.starts_with(".tauscope-") && name.ends_with(".part")
}

fn files(folder: &Path) -> Files {
    let mut found = Files::new();
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        let name = PathBuf::from(path.file_name().unwrap());
        if path.is_dir() {
            found.extend(files(&path).into_iter().map(|(inner, bytes)| (name.join(inner), bytes)));
        } else if let Ok(bytes) = fs::read(&path) {
            // A part may have become whole since the folder was listed.
            found.insert(name, bytes);
        }
    }
    found
}

/// Whether a program's working folder is this one, as far as the system tells.
fn works_in(folder: &Path) -> bool {
    let processes = fs::read_dir("/proc").into_iter().flatten().flatten();
    let mut folders = processes.filter_map(|process| process.path().join("cwd").read_link().ok());
    folders.any(|works_in| works_in.starts_with(folder))
}

fn signal(child: &Child, name: &str) {
    let mut command = Command::new("kill");
    // It may have ended by itself.
    let said = command.args([&format!("-{name}"), &child.id().to_string()]).output();
    said.unwrap();
}

/// How often each command is ended.
fn kills() -> u32 {
    let given = std::env::var("TAUSCOPE_KILLS").ok().and_then(|count| count.parse().ok());
    given.unwrap_or(2)
}

/// Waits for a random time, or until a part of a file is there.
fn wait(job: &Job, child: &mut Child, rng: &mut ChaCha8Rng) {
    let longest = job.takes.mul_f64(rng.random_range(0.0..1.1));
    let waits_for_part = rng.random_bool(0.5);
    let start = Instant::now();
    while start.elapsed() < longest.max(job.takes * u32::from(waits_for_part)) {
        let is_there = waits_for_part && job.files().keys().any(|name| is_part(name));
        if is_there || child.try_wait().unwrap().is_some() {
            return;
        }
        std::thread::sleep(Duration::from_millis(1));
    }
}

#[test]
fn a_program_that_is_ended_at_any_moment_leaves_no_wrong_file() {
    let mut rng = ChaCha8Rng::seed_from_u64(1);
    let (mut ended, mut parts) = (0, 0);
    for job in COMMANDS.map(Job::new) {
        for number in 0..kills() {
            let name = ["KILL", "KILL", "TERM", "INT"][number as usize % 4];
            job.restore();
            let mut child = job.start();
            wait(&job, &mut child, &mut rng);
            signal(&child, name);
            ended += u32::from(!matches!(child.wait().unwrap().code(), Some(0 | 1)));
            job.check_alone();
            job.check(name);
            parts += job.files().keys().filter(|name| is_part(name)).count();
        }
        job.check_next();
    }
    println!("{ended} programs were ended, and left {parts} parts");
}

#[test]
fn a_disk_that_is_full_is_told_and_leaves_no_wrong_file() {
    for job in COMMANDS.map(Job::new) {
        // Blocks of 512 bytes that a file may have.
        for blocks in [0, 1, 4, 16, 64] {
            job.restore();
            let limit = format!("ulimit -f {blocks}; exec \"$0\" \"$@\"");
            let mut command = Command::new("sh");
            command.args(["-c", &limit]).arg(env!("CARGO_BIN_EXE_tauscope"));
            command.args(job.command.split_whitespace()).current_dir(job.desk.folder.path());
            let ended = command.output().unwrap();
            let said = String::from_utf8_lossy(&ended.stderr);
            let sizes = job.made().map(|name| job.after[name].len());
            let fits = sizes.max().unwrap() <= 512 * blocks;
            let status = ended.status.code();
            assert_eq!(matches!(status, Some(0 | 1)) && job.files() == job.after, fits, "{said}");
            assert!(fits || said.contains("cannot be written"), "{}: {said}", job.command);
            assert!(!said.contains("panicked"), "{}: {said}", job.command);
            job.check("a full disk");
            assert!(!job.files().keys().any(|name| is_part(name)), "{}", job.command);
        }
    }
}

/// Takes from everybody the right to change what is in a folder, and gives it back in the end.
struct Closed<'a>(&'a Path);

impl<'a> Closed<'a> {
    /// `None` where the system does not keep this user out.
    fn new(folder: &'a Path) -> Option<Self> {
        let closed = Self(folder);
        let attempts = [("chmod", "a-w"), ("chattr", "+i")];
        let keeps_out = |(program, how): (&str, &str)| {
            // A system may have no such program, or no such attribute.
            let _unknown =
                Command::new(program).arg(how).arg(folder).stderr(Stdio::null()).status();
            let attempt = folder.join("attempt");
            let is_made = fs::write(&attempt, "").is_ok();
            is_made.then(|| fs::remove_file(&attempt).unwrap()).is_none()
        };
        attempts.into_iter().any(keeps_out).then_some(closed)
    }
}

impl Drop for Closed<'_> {
    fn drop(&mut self) {
        for (program, how) in [("chattr", "-i"), ("chmod", "u+w")] {
            let _unknown =
                Command::new(program).arg(how).arg(self.0).stderr(Stdio::null()).status();
        }
    }
}

#[test]
fn a_folder_that_cannot_be_written_is_told_and_stays_as_it_is() {
    for job in COMMANDS.map(Job::new) {
        job.restore();
        let closed = Closed::new(job.desk.folder.path());
        if closed.is_none() {
            println!("skipped: a folder is closed to root by chattr alone, and not on this disk");
            return;
        }
        let ended = job.start().wait_with_output().unwrap();
        let said = String::from_utf8_lossy(&ended.stderr);
        assert!(matches!(ended.status.code(), Some(1 | 2)), "{}: {said}", job.command);
        assert!(said.contains("cannot be written") && !said.contains("panicked"), "{said}");
        assert!(job.files() == job.before, "{}: {:?}", job.command, job.files().keys());
    }
}

#[test]
fn a_file_in_the_place_of_a_folder_is_told_and_stays() {
    let desk = Desk::with(vec![joint("boom")]);
    desk.write("file", "kept\n");
    for command in [
        "estimate log.csv --decisions file/d.csv",
        "report log.csv -o file/page.html",
        "estimate log.csv --results file",
        "columns log.csv -w file/columns.toml",
    ] {
        let ended = desk.command(command).output().unwrap();
        let said = String::from_utf8_lossy(&ended.stderr);
        assert_eq!(ended.status.code(), Some(2), "{command}: {said}");
        assert!(said.contains("file") && !said.contains("panicked"), "{command}: {said}");
        assert_eq!(desk.read("file"), "kept\n", "{command}");
    }
}

#[test]
fn a_reader_that_leaves_keeps_no_file_from_being_written() {
    for job in COMMANDS.map(Job::new) {
        job.restore();
        let mut command = job.desk.command(job.command);
        let mut child = command.stdout(Stdio::piped()).stderr(Stdio::null()).spawn().unwrap();
        drop(child.stdout.take());
        assert!(matches!(child.wait().unwrap().code(), Some(0 | 1)), "{}", job.command);
        assert!(job.files() == job.after, "{}: {:?}", job.command, job.files().keys());
    }
}

#[test]
fn two_runs_that_write_the_same_files_leave_one_whole() {
    for job in COMMANDS.map(Job::new) {
        job.restore();
        let pair = [job.start(), job.start()].map(|child| child.wait_with_output().unwrap());
        for output in pair {
            let said = String::from_utf8_lossy(&output.stderr);
            assert!(matches!(output.status.code(), Some(0 | 1)), "{}: {said}", job.command);
        }
        assert!(job.files() == job.after, "{}: {:?}", job.command, job.files().keys());
    }
}

/// What happens to a log, in its folder.
type Fault<'a> = &'a dyn Fn(&Desk, &Path);

#[test]
fn a_log_that_is_exchanged_while_it_is_followed_is_told() {
    let other = "time_s,boom.input,boom.output\n".to_owned() + &"0.5,1,1\n".repeat(20_000);
    let longer = other.as_bytes();
    let replaced: Fault<'_> = &|desk, log| {
        desk.write("new.csv", &other);
        fs::rename(desk.folder.path().join("new.csv"), log).unwrap();
    };
    let truncated: Fault<'_> = &|_, log| File::create(log).unwrap().write_all(b"time_s\n").unwrap();
    let written_again: Fault<'_> = &|_, log| fs::write(log, longer).unwrap();
    let rotated: Fault<'_> = &|desk, log| {
        fs::rename(log, desk.folder.path().join("grows.csv.1")).unwrap();
        fs::write(log, longer).unwrap();
    };
    let removed: Fault<'_> = &|_, log| fs::remove_file(log).unwrap();
    let faults = [
        (replaced, "another log took its place"),
        (truncated, "it became shorter"),
        (written_again, "another log took its place"),
        (rotated, "another log took its place"),
        (removed, "cannot be read"),
    ];
    for (fault, why) in faults {
        let desk = Desk::with(vec![joint("boom")]);
        let log = desk.folder.path().join("grows.csv");
        fs::copy(desk.folder.path().join("log.csv"), &log).unwrap();
        desk.write("d.csv", "old\n");
        let mut command = desk.command("estimate grows.csv --follow --idle 60 --decisions d.csv");
        let child = command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
        let mut child = child;
        let mut lines = BufReader::new(child.stdout.take().unwrap()).lines();
        lines.next().unwrap().unwrap();
        fault(&desk, &log);
        // All that it says, so that it never waits for its reader.
        lines.for_each(drop);
        let output = child.wait_with_output().unwrap();
        let said = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{why}: {said}");
        assert!(said.contains(why) && said.contains("grows.csv"), "{why}: {said}");
        assert_eq!(desk.read("d.csv"), "old\n");
    }
}
