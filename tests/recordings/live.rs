//! Recordings that a viewer sees while they are made. The viewer is the real one, where
//! `rerun` is on PATH (or in `TAUSCOPE_RERUN`); what needs none is tried without.
#![cfg(all(feature = "rrd", unix))]

use std::collections::BTreeMap;
use std::ffi::OsString;
use std::io::Write as _;
use std::net::{SocketAddr, TcpListener, TcpStream};
use std::os::unix::fs::PermissionsExt as _;
use std::os::unix::process::CommandExt as _;
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

use crate::desk::{Desk, banded, joint};
use rerun::StoreKind;
use rerun::external::arrow::array::AsArray as _;
use rerun::external::arrow::datatypes::Float64Type;
use rerun::external::re_log_encoding::DecoderApp;
use rerun::log::{Chunk, LogMsg};

/// Longest time that anything here may take.
const PATIENCE: Duration = Duration::from_mins(2);

/// An address of this machine where nobody listens.
fn free_address() -> SocketAddr {
    TcpListener::bind("127.0.0.1:0").unwrap().local_addr().unwrap()
}

fn wait_until(what: &str, mut is_so: impl FnMut() -> bool) {
    let end = Instant::now() + PATIENCE;
    while !is_so() {
        assert!(Instant::now() < end, "{what} took too long");
        std::thread::sleep(Duration::from_millis(20));
    }
}

/// A program that is ended with its children.
struct Running(Child);

impl Running {
    fn start(command: &mut Command) -> Self {
        Self(command.process_group(0).stdin(Stdio::null()).spawn().unwrap())
    }

    fn signal(&self, signal: &str) {
        let group = format!("-{}", self.0.id());
        Command::new("kill").args([signal, "--", &group]).status().unwrap();
    }
}

impl Drop for Running {
    fn drop(&mut self) {
        self.signal("-KILL");
        self.0.wait().unwrap();
    }
}

/// A viewer without a window that writes down what it is sent, as it comes.
struct Viewer {
    address: SocketAddr,
    folder: tempfile::TempDir,
    _running: Running,
}

/// Says that a test is skipped. Not `eprintln`, which the test runner keeps to itself.
fn skipped(why: &str) {
    let mut stderr = std::io::stderr();
    writeln!(stderr, "skipped: {why}").unwrap();
}

/// The viewer's program, or `None` after saying that the test is skipped.
fn rerun() -> Option<OsString> {
    let program = std::env::var_os("TAUSCOPE_RERUN").unwrap_or_else(|| "rerun".into());
    if Command::new(&program).arg("--version").output().is_ok() {
        return Some(program);
    }
    skipped("there is no viewer `rerun`");
    None
}

impl Viewer {
    /// One that listens, `--save`d; or one that is a client of `server`.
    fn start(server: Option<&str>) -> Option<Self> {
        let (program, address) = (rerun()?, free_address());
        let folder = tempfile::tempdir().unwrap();
        let mut command = Command::new(program);
        command.env("RERUN_ANALYTICS", "0").stdout(Stdio::null()).stderr(Stdio::null());
        command.args(["--save", folder.path().join("seen.rrd").to_str().unwrap()]);
        match server {
            Some(url) => command.arg("--connect").arg(url),
            None => command.args(["--port", &address.port().to_string()]),
        };
        let running = Running::start(&mut command);
        if server.is_none() {
            wait_until("starting the viewer", || TcpStream::connect(address).is_ok());
        }
        Some(Self { address, folder, _running: running })
    }

    /// What it was sent so far.
    fn seen(&self) -> Vec<Chunk> {
        chunks_of(&self.folder.path().join("seen.rrd"))
    }

    /// What it was sent, as soon as that is `enough`.
    fn seen_when(&self, enough: impl Fn(&[Chunk]) -> bool) -> Vec<Chunk> {
        let mut seen = Vec::new();
        wait_until("arriving at the viewer", || {
            seen = self.seen();
            enough(&seen)
        });
        seen
    }
}

/// The recording's chunks, in the order of the file, which need not be whole.
fn chunks_of(path: &Path) -> Vec<Chunk> {
    let Ok(file) = std::fs::File::open(path) else { return Vec::new() };
    let messages = DecoderApp::decode_lazy(std::io::BufReader::new(file));
    let chunks = messages.map_while(Result::ok).filter_map(|message| match message {
        LogMsg::ArrowMsg(store, chunk) if store.kind() == StoreKind::Recording => {
            Some(Chunk::from_arrow_msg(&chunk).unwrap())
        }
        _ => None,
    });
    chunks.collect()
}

/// Per entity with its columns, how many rows there are.
fn rows(chunks: &[Chunk]) -> BTreeMap<String, usize> {
    let mut rows = BTreeMap::new();
    for chunk in chunks {
        let mut columns: Vec<_> = chunk.components().keys().map(ToString::to_string).collect();
        columns.sort();
        let name = format!("{} {columns:?}", chunk.entity_path());
        *rows.entry(name).or_default() += chunk.num_rows();
    }
    rows
}

/// Revisions and numbers of the chunks of `entity`, each chunk by itself.
fn scalars(chunks: &[Chunk], entity: &str) -> Vec<Vec<(i64, f64)>> {
    let of_chunk = |chunk: &Chunk| {
        let revisions = chunk.timelines().values().next().unwrap().times_raw().to_vec();
        let column = chunk.components().0.values().next().unwrap().list_array.values().clone();
        let numbers = column.as_primitive::<Float64Type>().values().to_vec();
        revisions.into_iter().zip(numbers).collect()
    };
    let is_entity = |chunk: &&Chunk| chunk.entity_path().to_string() == entity;
    chunks.iter().filter(is_entity).map(of_chunk).collect()
}

#[test]
fn a_viewer_is_sent_what_is_in_the_file() {
    let Some(viewer) = Viewer::start(None) else { return };
    let desk = Desk::with(vec![joint("boom"), banded("stick")]);
    let output = desk.run(&format!("estimate log.csv -o file.rrd --connect {}", viewer.address));
    let stderr = String::from_utf8(output.stderr).unwrap();
    assert!(output.status.success(), "{stderr}");
    assert!(stderr.contains("has the recording"), "{stderr}");
    let file = rows(&chunks_of(&desk.folder.path().join("file.rrd")));
    assert!(file.keys().any(|name| name.starts_with("/stick/decision/table ")));
    let seen = viewer.seen_when(|seen| seen.len() >= file.len());
    assert_eq!(rows(&seen), file);
}

#[test]
fn revisions_are_seen_as_they_are_computed_and_end_as_in_the_file() {
    let Some(viewer) = Viewer::start(None) else { return };
    let desk = Desk::with(vec![banded("boom")]);
    let improve = "improve log.csv --effects dead_band,actuator_lag,thermal_drift --write m.toml";
    let output = desk.run(&format!("{improve} -o file.rrd --connect {}", viewer.address));
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let file = chunks_of(&desk.folder.path().join("file.rrd"));
    // The models come last, when all is done. Of the revisions a file has one row more, before the
    // first, in which it opens on the last: which one that is is not known while they are sent. On it
    // the lane of the steps says where to look.
    let is_late = |name: &str| name.contains("/revision/") || name.starts_with("/boom/segment ");
    let is_whole = |seen: &[Chunk]| {
        let counted = rows(seen);
        let file = rows(&file).into_iter().filter(|(name, _)| !is_late(name));
        file.into_iter().all(|(name, rows)| counted.get(&name).is_some_and(|seen| *seen >= rows))
    };
    let seen = viewer.seen_when(is_whole);
    for error in ["validation_rmse", "training_rmse", "noise_floor"] {
        let entity = format!("/boom/revision/{error}");
        let steps = scalars(&seen, &entity);
        // What is sent alone was there before the next revision was.
        assert!(steps.len() >= 2 && steps.iter().all(|rows| rows.len() == 1), "{steps:?}");
        assert_eq!(vec![steps.concat()], scalars(&file, &entity));
    }
    let falling = scalars(&seen, "/boom/revision/validation_rmse").concat();
    assert!(falling[1].1 < 0.5 * falling[0].1, "{falling:?}");
    // The decisions were there before any revision, the ladder with each of them.
    let place = |entity: &str| {
        seen.iter().position(|chunk| chunk.entity_path().to_string() == entity).unwrap()
    };
    assert!(place("/boom/decision/table") < place("/boom/revision/validation_rmse"));
    let ladders = |part: &str| {
        let name = format!("/boom/revision/{part}");
        seen.iter().filter(|c| c.entity_path().to_string() == name && !c.is_static()).count()
    };
    assert!(ladders("sheet/ladder") >= 2 && ladders("record/simulated") >= 2);
    assert!(ladders("words") >= 2 && ladders("sheet/ranking") >= 2);
}

/// The number that holds at each sample: what came last.
fn held(chunks: &[Chunk], entity: &str) -> BTreeMap<i64, String> {
    let mut held = BTreeMap::new();
    for chunk in chunks.iter().filter(|chunk| chunk.entity_path().to_string() == entity) {
        let samples = chunk.timelines().values().find(|times| times.name() == "sample");
        let columns = &chunk.components().0;
        for (samples, column) in samples.iter().zip(columns.values()) {
            for (row, sample) in samples.times_raw().iter().enumerate() {
                held.insert(*sample, format!("{:?}", column.list_array.value(row)));
            }
        }
    }
    held
}

#[test]
fn a_log_that_is_followed_is_seen_as_it_is_in_the_end() {
    let Some(viewer) = Viewer::start(None) else { return };
    let desk = Desk::with(vec![joint("boom")]);
    let address = viewer.address;
    let whole = desk.read("log.csv");
    let mut follow = desk
        .command(&format!("estimate grows.csv --follow --idle 1 -o file.rrd --connect {address}"));
    let mut running = Running::start(follow.stdout(Stdio::null()).stderr(Stdio::null()));
    for part in whole.as_bytes().chunks(whole.len() / 4) {
        let mut log = std::fs::File::options()
            .create(true)
            .append(true)
            .open(desk.folder.path().join("grows.csv"))
            .unwrap();
        log.write_all(part).unwrap();
        std::thread::sleep(Duration::from_millis(600));
    }
    assert!(running.0.wait().unwrap().success());
    let file = chunks_of(&desk.folder.path().join("file.rrd"));
    let entities =
        ["input", "output/raw", "output/smoothed", "delay/tau"].map(|name| format!("/boom/{name}"));
    let is_as_in_file =
        |seen: &[Chunk]| entities.iter().all(|entity| held(seen, entity) == held(&file, entity));
    let seen = viewer.seen_when(is_as_in_file);
    let sendings = |entity: &str| {
        seen.iter().filter(|c| c.entity_path().to_string() == entity && !c.is_static()).count()
    };
    assert!(sendings("/boom/output/raw") >= 3, "it was seen to grow");
    let rows: usize = rows(&seen).into_iter().filter(|(n, _)| n.starts_with("/boom/input")).count();
    assert!(rows > 0);
}

#[test]
fn a_viewer_is_sent_the_sweep_that_is_in_the_file() {
    let Some(viewer) = Viewer::start(None) else { return };
    let desk = Desk::with(vec![joint("boom")]);
    let options = "sweep log.csv --method two-line --beta 1,5 -o file.rrd";
    let output = desk.run(&format!("{options} --connect {}", viewer.address));
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let file = rows(&chunks_of(&desk.folder.path().join("file.rrd")));
    assert!(file.keys().any(|name| name.starts_with("/boom/sweep/setting")), "{file:?}");
    viewer.seen_when(|seen| rows(seen) == file);
}

#[test]
fn viewers_that_come_later_are_served_until_ctrl_c() {
    let desk = Desk::with(vec![joint("boom")]);
    let address = free_address();
    let mut command = desk.command(&format!("estimate log.csv --serve {address}"));
    let mut serving = Running::start(command.stdout(Stdio::null()).stderr(Stdio::null()));
    wait_until("serving", || TcpStream::connect(address).is_ok());
    if let Some(viewer) = Viewer::start(Some(&format!("rerun+http://{address}/proxy"))) {
        let whole = desk.run("estimate log.csv -o file.rrd");
        assert!(whole.status.success());
        let file = rows(&chunks_of(&desk.folder.path().join("file.rrd")));
        let seen = viewer.seen_when(|seen| seen.len() >= file.len());
        assert_eq!(rows(&seen), file);
    }
    // What is served takes recordings, too: it is what a viewer is.
    let guest = desk.run(&format!("estimate log.csv --connect {address}"));
    assert!(guest.status.success(), "{}", String::from_utf8_lossy(&guest.stderr));
    let taken = desk.refusal(&format!("estimate log.csv --serve {address}"));
    assert!(taken.contains("choose another port"), "{taken}");
    assert!(serving.0.try_wait().unwrap().is_none(), "it serves until it is told to end");
    serving.signal("-INT");
    wait_until("ending", || serving.0.try_wait().unwrap().is_some());
    assert!(serving.0.wait().unwrap().success());
}

#[test]
fn without_a_viewer_there_is_one_message_and_no_waiting() {
    let desk = Desk::with(vec![joint("boom")]);
    let start = Instant::now();
    for command in ["estimate", "compare", "explain", "improve", "add dead_band", "sweep"] {
        let stderr = desk.refusal(&format!("{command} log.csv --connect {}", free_address()));
        assert!(stderr.contains("no viewer at") && stderr.lines().count() == 1, "{stderr}");
        assert!(stderr.contains("start one with `rerun`"), "{stderr}");
    }
    assert!(start.elapsed() < Duration::from_secs(20));
    assert!(!desk.has("model.toml"));
    let wrong = desk.refusal("estimate --connect log.csv");
    assert!(wrong.contains("DATA goes before this option"), "{wrong}");
    let both = desk.refusal("estimate log.csv --spawn --serve");
    assert!(both.contains("cannot be used with"), "{both}");
}

#[test]
fn what_listens_but_is_no_viewer_is_found_out() {
    let desk = Desk::with(vec![joint("boom")]);
    let silent = TcpListener::bind("127.0.0.1:0").unwrap();
    let address = silent.local_addr().unwrap();
    let start = Instant::now();
    let stderr = desk.refusal(&format!("estimate log.csv --connect {address}"));
    assert!(stderr.contains("that listens there"), "{stderr}");
    assert!(start.elapsed() < Duration::from_mins(1));
}

#[test]
fn a_viewer_that_cannot_be_started_is_told_of() {
    if TcpStream::connect("127.0.0.1:9876").is_ok() {
        skipped("a viewer runs, and would be used");
        return;
    }
    let desk = Desk::with(vec![joint("boom")]);
    let spawn =
        || desk.command("estimate log.csv --spawn").env("PATH", desk.folder.path()).output();
    let text = |output: std::process::Output| {
        assert_eq!(output.status.code(), Some(2));
        String::from_utf8(output.stderr).unwrap()
    };
    let stderr = text(spawn().unwrap());
    assert!(stderr.contains("no viewer `rerun` on PATH") && stderr.contains("doctor"), "{stderr}");
    desk.write("rerun", "#!/bin/sh\nexit 3\n");
    let program = desk.folder.path().join("rerun");
    std::fs::set_permissions(&program, std::fs::Permissions::from_mode(0o755)).unwrap();
    let stderr = text(spawn().unwrap());
    assert!(stderr.contains("ended at once") && stderr.contains('3'), "{stderr}");
}
