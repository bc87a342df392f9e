//! The program as an importer of the viewer: `rerun LOG.csv` opens the recording of the log.
#![cfg(all(feature = "rrd", unix))]

use std::io::Write as _;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use crate::desk::{Desk, banded};
use crate::read_back::ReadBack;

/// The exit status by which an importer declines a file.
const DECLINED: i32 = 66;

/// The program under the name that a viewer calls, in a folder of its own.
fn installed(folder: &Path) -> PathBuf {
    let mut install = Command::new(env!("CARGO_BIN_EXE_tauscope"));
    install.args(["importer", "--install", "--folder"]).arg(folder);
    assert!(install.output().unwrap().status.success());
    folder.join("rerun-importer-tauscope")
}

/// What it says of `file`, called as a viewer calls it.
fn asked(desk: &Desk, file: &str) -> Output {
    let folder = desk.folder.path().join("bin");
    let mut importer = Command::new(installed(&folder));
    importer.current_dir(desk.folder.path()).arg(file);
    importer.args(["--application-id", file, "--recording-id", "rec_1"]).output().unwrap()
}

#[test]
fn a_viewer_gets_the_recording_of_a_log() {
    let desk = Desk::with(vec![banded("boom")]);
    assert!(desk.run("estimate log.csv -o page.rrd --quiet").status.success());
    let recording = std::fs::read(desk.folder.path().join("page.rrd")).unwrap();
    let given = asked(&desk, "log.csv");
    assert_eq!((given.status.code(), given.stderr.len()), (Some(0), 0));
    assert!(given.stdout == recording, "it is the recording that `estimate` makes");
}

#[test]
fn what_is_no_log_of_joints_is_declined_and_a_log_with_a_fault_is_not() {
    let desk = Desk::with(vec![banded("boom")]);
    desk.write("notes.md", "# Notes\n");
    desk.write("prices.csv", "name,price\nnut,3\nbolt,4\n");
    for file in ["notes.md", "prices.csv", "nothing.csv", "bin"] {
        let declined = asked(&desk, file);
        assert_eq!(declined.status.code(), Some(DECLINED), "{file}");
        assert!(declined.stdout.is_empty() && declined.stderr.is_empty(), "{file}: {declined:?}");
    }
    let broken = desk.read("log.csv").replacen("\n0.5,", "\nnever,", 1);
    desk.write("broken.csv", &broken);
    let refused = asked(&desk, "broken.csv");
    let message = String::from_utf8_lossy(&refused.stderr);
    assert_eq!((refused.status.code(), refused.stdout.len()), (Some(2), 0), "{message}");
    assert!(message.contains("broken.csv"), "{message}");
}

#[test]
fn it_is_replaced_unless_it_is_somebody_elses() {
    let desk = Desk::with(vec![banded("boom")]);
    let folder = desk.folder.path().join("bin");
    let link = installed(&folder);
    assert_eq!(installed(&folder), link, "a second time it is replaced");
    std::fs::remove_file(&link).unwrap();
    std::fs::write(&link, "of somebody else").unwrap();
    let mut again = Command::new(env!("CARGO_BIN_EXE_tauscope"));
    again.args(["importer", "--install", "--folder"]).arg(&folder);
    assert_eq!(again.output().unwrap().status.code(), Some(2));
    assert_eq!(std::fs::read_to_string(&link).unwrap(), "of somebody else");
}

#[test]
fn viewers_open_a_log() {
    let named = std::env::var("RERUN_VIEWERS").unwrap_or_else(|_| "rerun".to_owned());
    let answers = |viewer: &&str| Command::new(viewer).arg("--version").output().is_ok();
    let viewers: Vec<&str> = named.split(':').filter(answers).collect();
    if viewers.is_empty() {
        // Not `eprintln`, which the test runner keeps to itself.
        writeln!(std::io::stderr(), "skipped: no viewer; name some in RERUN_VIEWERS").unwrap();
        return;
    }
    let desk = Desk::with(vec![banded("boom")]);
    let folder = desk.folder.path().join("bin");
    installed(&folder);
    let own = std::env::var_os("PATH").unwrap_or_default();
    let path = std::env::join_paths([folder].into_iter().chain(std::env::split_paths(&own)));
    let mut ports = 40_000 + std::process::id() % 20_000..;
    for (viewer, port) in viewers.iter().zip(&mut ports) {
        let mut open = Command::new(viewer);
        open.args(["log.csv", "--save", "saved.rrd", "--port", &port.to_string()]);
        open.env("PATH", path.as_ref().unwrap()).env("RERUN_ANALYTICS", "0");
        let done = open.current_dir(desk.folder.path()).output().unwrap();
        assert!(done.status.success(), "{viewer}: {}", String::from_utf8_lossy(&done.stderr));
        let saved = desk.folder.path().join("saved.rrd");
        let back = ReadBack::of(&std::fs::read(&saved).unwrap());
        assert!(back.chunks.contains_key("/boom/decision/table"), "{viewer}");
        std::fs::remove_file(&saved).unwrap();
    }
}
