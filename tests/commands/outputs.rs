//! Where outputs go: never over what is read, whole or not at all, into pipes, and nothing is
//! left by who was killed.
#![cfg(unix)]

use crate::log_text::log_text;
use std::ffi::OsStr;
use std::fs::{self, File};
use std::os::unix::ffi::OsStrExt as _;
use std::path::Path;
use std::process::{Command, Stdio};

use tempfile::TempDir;

/// A folder with a log.
fn folder() -> TempDir {
    let folder = TempDir::new().unwrap();
    fs::write(folder.path().join("log.csv"), log_text()).unwrap();
    folder
}

fn tauscope(folder: &Path) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_tauscope"));
    command.current_dir(folder).stdin(Stdio::null());
    command
}

#[test]
fn a_model_file_is_never_replaced_by_another_output() {
    let folder = folder();
    let made = tauscope(folder.path()).args(["improve", "log.csv", "-w", "model.toml"]).output();
    assert!(made.unwrap().status.code().is_some_and(|status| status < 2));
    for name in ["m.html", "m.rrd", "m.toml"] {
        fs::copy(folder.path().join("model.toml"), folder.path().join(name)).unwrap();
    }
    let commands = [
        "report log.csv -m m.html -o m.html",
        "report log.csv -m m.rrd -o m.html",
        "compare log.csv -m m.toml -o m.toml",
        "explain log.csv -m m.toml -o m.toml",
        "improve log.csv -m m.toml -w n.toml -o m.toml",
        "add direction_gain log.csv -m m.toml -w n.toml -o m.toml",
        "improve log.csv --results r -m m.toml --summary m.toml",
        "columns log.csv -w log.csv",
    ];
    let before = |name: &str| fs::read(folder.path().join(name)).unwrap();
    let kept = ["m.html", "m.rrd", "m.toml", "log.csv"].map(before);
    for command in commands {
        // Without recordings a report writes none.
        if command.contains("m.rrd") && cfg!(not(feature = "rrd")) {
            continue;
        }
        let ended = tauscope(folder.path()).args(command.split(' ')).output().unwrap();
        let said = String::from_utf8_lossy(&ended.stderr);
        assert_eq!(ended.status.code(), Some(2), "{command}: {said}");
        assert!(said.contains("a file that is read"), "{command}: {said}");
    }
    assert_eq!(["m.html", "m.rrd", "m.toml", "log.csv"].map(before), kept);
}

#[test]
fn no_output_replaces_a_log_that_is_not_even_read() {
    let folder = folder();
    let other = folder.path().join("other.csv");
    fs::write(&other, log_text()).unwrap();
    let commands = [
        "estimate log.csv --decisions other.csv",
        "estimate log.csv --delays other.csv",
        "improve log.csv --write other.csv",
        "columns log.csv -w other.csv",
        "estimate log.csv --results r --summary other.csv",
    ];
    for command in commands {
        let ended = tauscope(folder.path()).args(command.split(' ')).output().unwrap();
        let said = String::from_utf8_lossy(&ended.stderr);
        assert!(ended.status.code() == Some(2), "{command}: {said}");
        assert!(said.contains("other.csv: this is a log"), "{command}: {said}");
        assert_eq!(fs::read_to_string(&other).unwrap(), log_text());
    }
    // What the program wrote itself is made anew.
    for _ in 0..2 {
        let words = "estimate log.csv --quiet --decisions d.csv --delays y.csv --table t.csv";
        let ended = tauscope(folder.path()).args(words.split(' ')).output().unwrap();
        assert_eq!(ended.status.code(), Some(0), "{}", String::from_utf8_lossy(&ended.stderr));
    }
}

#[test]
fn a_name_that_says_another_kind_of_file_is_refused() {
    let folder = folder();
    let cases = [
        ("estimate log.csv -o delays.csv", "FILE.rrd"),
        ("compare log.csv -o report.html", "FILE.rrd"),
        ("log.csv -o report.pdf", "FILE.html"),
        (
            "report log.csv -o no/report.html",
            "no/report.html: cannot be written: there is no folder `",
        ),
        ("estimate log.csv --decisions d.xlsx", "FILE.csv or FILE.parquet"),
        ("estimate log.csv --delays d.csv.gz", "FILE.csv or FILE.parquet"),
        ("estimate log.csv --review-sheet sheet.parquet", "FILE.csv"),
        ("improve log.csv --write m.json", "FILE.toml"),
        ("columns log.csv --write columns.csv", "FILE.toml"),
        ("simulate -o log.mat", "FILE.csv"),
    ];
    for (words, remedy) in cases {
        let ended = tauscope(folder.path()).args(words.split(' ')).output().unwrap();
        let said = String::from_utf8_lossy(&ended.stderr);
        assert!(ended.status.code() == Some(2) && said.contains(remedy), "{words}: {said}");
        assert!(!said.contains(".part"), "{words}: {said}");
    }
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1);
}

#[test]
fn logs_whose_names_differ_in_bytes_that_are_no_text_have_a_result_each() {
    let folder = TempDir::new().unwrap();
    let log =
        |byte: u8| folder.path().join(OsStr::from_bytes(&[b'l', byte, b'.', b'c', b's', b'v']));
    if fs::write(log(0xff), log_text()).is_err() {
        // Some file systems hold texts only.
        return;
    }
    let other = log_text().replace(",1,", ",2,");
    fs::write(log(0xfe), other).unwrap();
    let mut command = tauscope(folder.path());
    command.arg("estimate").args([log(0xff), log(0xfe)]);
    let ended = command.args(["--results", "r", "--summary", "s.csv", "--quiet"]).output().unwrap();
    assert_eq!(ended.status.code(), Some(0), "{}", String::from_utf8_lossy(&ended.stderr));
    assert_eq!(fs::read_dir(folder.path().join("r")).unwrap().count(), 2);
    let summary = |name| fs::read_to_string(folder.path().join(name)).unwrap();
    assert_eq!(summary("s.csv").lines().count(), 3);
    assert!(summary("s.csv").contains(r"\xfe") && summary("s.csv").contains(r"\xff"));
}

#[test]
fn logs_in_folders_within_a_folder_are_said_to_be_left_out() {
    let folder = TempDir::new().unwrap();
    let inner = folder.path().join("day").join("monday");
    fs::create_dir_all(&inner).unwrap();
    fs::create_dir(folder.path().join("day").join("tuesday")).unwrap();
    fs::write(inner.join("log.csv"), log_text()).unwrap();
    let said = |code| {
        let command = ["estimate", "day", "--results", "r"];
        let ended = tauscope(folder.path()).args(command).output().unwrap();
        assert_eq!(ended.status.code(), Some(code));
        String::from_utf8(ended.stderr).unwrap()
    };
    let only = said(2);
    assert!(only.contains("folders within it; name those") && only.contains("monday"), "{only}");
    fs::write(folder.path().join("day").join("log.csv"), log_text()).unwrap();
    let beside = said(0);
    assert!(beside.contains("left out") && beside.contains("monday"), "{beside}");
    assert!(!beside.contains("tuesday"), "it has no log: {beside}");
}

#[test]
fn a_name_as_long_as_can_be_has_a_result() {
    let folder = TempDir::new().unwrap();
    let name = format!("{}.csv", "n".repeat(251));
    fs::write(folder.path().join(&name), log_text()).unwrap();
    let ended = tauscope(folder.path()).args(["estimate", &name, "--results", "r"]).output();
    assert_eq!(ended.unwrap().status.code(), Some(0));
}

#[test]
fn a_pipe_is_written_to_and_neither_probed_nor_replaced() {
    let folder = folder();
    let pipe = folder.path().join("pipe");
    if !Command::new("mkfifo").arg(&pipe).status().is_ok_and(|status| status.success()) {
        return;
    }
    let mut child = tauscope(folder.path())
        .args(["estimate", "log.csv", "--decisions", "pipe", "--quiet"])
        .stdout(Stdio::null())
        .spawn()
        .unwrap();
    let piped = fs::read_to_string(&pipe).unwrap();
    assert!(child.wait().unwrap().success());
    let mut plain = tauscope(folder.path());
    plain.args(["estimate", "log.csv", "--decisions", "plain.csv"]);
    assert!(plain.output().unwrap().status.success());
    assert_eq!(piped, fs::read_to_string(folder.path().join("plain.csv")).unwrap());
    let program = env!("CARGO_BIN_EXE_tauscope");
    let shell =
        format!("'{program}' estimate log.csv --decisions >(cat > sub.csv) --quiet; sleep 1");
    let bash = Command::new("bash").args(["-c", &shell]).current_dir(folder.path()).output();
    if bash.is_ok_and(|bash| bash.status.success()) {
        assert_eq!(piped, fs::read_to_string(folder.path().join("sub.csv")).unwrap());
    }
}

#[test]
fn a_link_in_the_place_of_a_result_is_not_written_through() {
    let folder = folder();
    let run = || tauscope(folder.path()).args(["estimate", "log.csv", "--results", "r"]).output();
    assert!(run().unwrap().status.success());
    let results = folder.path().join("r");
    let result = fs::read_dir(&results).unwrap().flatten().map(|entry| entry.path());
    let result = result.filter(|path| path.is_file()).collect::<Vec<_>>().remove(0);
    fs::remove_file(&result).unwrap();
    std::os::unix::fs::symlink(folder.path().join("log.csv"), &result).unwrap();
    let ended = run().unwrap();
    assert_ne!(ended.status.code(), Some(0), "{}", String::from_utf8_lossy(&ended.stderr));
    assert_eq!(fs::read_to_string(folder.path().join("log.csv")).unwrap(), log_text());
}

#[test]
fn results_that_find_no_room_are_no_success() {
    let folder = folder();
    for format in ["text", "json"] {
        let mut command = tauscope(folder.path());
        command.args(["estimate", "log.csv", "--format", format]);
        let Ok(full) = File::options().write(true).open("/dev/full") else { return };
        let ended = command.stdout(full).output().unwrap();
        assert_eq!(ended.status.code(), Some(2), "{format}");
        let said = String::from_utf8_lossy(&ended.stderr);
        assert!(said.contains("standard output cannot be written"), "{said}");
    }
    for asked in ["--help", "--version"] {
        let full = File::options().write(true).open("/dev/full").unwrap();
        let ended = tauscope(folder.path()).arg(asked).stdout(full).output().unwrap();
        assert_eq!(ended.status.code(), Some(2), "{asked}");
    }
}

#[test]
fn what_a_person_filled_in_or_corrected_is_not_replaced() {
    let folder = folder();
    let path = |name: &str| folder.path().join(name);
    let run = |words: &str| {
        let ended = tauscope(folder.path()).args(words.split(' ')).output().unwrap();
        (ended.status.code(), String::from_utf8_lossy(&ended.stderr).into_owned())
    };
    let cases = [
        ("estimate log.csv --quiet --review-sheet sheet.csv", "sheet.csv", "--review sheet.csv"),
        ("columns log.csv --quiet -w columns.toml", "columns.toml", "exists already"),
    ];
    for (words, name, says) in cases {
        // As it was written it may be written again.
        for _ in 0..2 {
            let (code, said) = run(words);
            assert!(code.is_some_and(|code| code < 2), "{words}: {said}");
        }
        let text = fs::read_to_string(path(name)).unwrap();
        let changed = match text.split_once('\n') {
            Some((head, rows)) if name == "sheet.csv" => {
                format!("{head}\n{}", rows.replacen(",,,,", ",rejected,,,", 1))
            }
            _ => text.replacen("time", "# by hand\ntime", 1),
        };
        assert_ne!(changed, text);
        for by_hand in [changed.replace(",rejected,", ",no,"), changed] {
            fs::write(path(name), &by_hand).unwrap();
            let (code, said) = run(words);
            assert!(code == Some(2) && said.contains(says), "{words}: {said}");
            assert_eq!(fs::read_to_string(path(name)).unwrap(), by_hand);
        }
    }
}

#[test]
fn a_dash_is_no_name_of_an_output() {
    let folder = folder();
    for words in ["columns log.csv -w -", "estimate log.csv --decisions -"] {
        let ended = tauscope(folder.path()).args(words.split(' ')).output().unwrap();
        let said = String::from_utf8_lossy(&ended.stderr);
        assert!(ended.status.code() == Some(2) && said.contains("/dev/stdout"), "{words}: {said}");
    }
    assert!(!folder.path().join("-").exists());
}

#[test]
fn what_stands_in_a_file_before_a_shell_appends_to_it_stays() {
    let folder = folder();
    let path = folder.path().join("all.csv");
    for (output, decisions) in [("before\n", "/dev/stdout"), ("more\n", "/dev/fd/1")] {
        let mut file = File::options().append(true).create(true).open(&path).unwrap();
        std::io::Write::write_all(&mut file, output.as_bytes()).unwrap();
        let mut command = tauscope(folder.path());
        command.args(["estimate", "log.csv", "--quiet", "--decisions", decisions]);
        assert!(command.stdout(file).status().unwrap().code().is_some_and(|code| code < 2));
    }
    let all = fs::read_to_string(path).unwrap();
    let heads: Vec<_> = all.match_indices("joint,").map(|(at, _)| at).collect();
    assert!(all.starts_with("before\njoint,"), "{all}");
    assert!(heads.len() == 2 && all[..heads[1]].ends_with("\nmore\n"), "{all}");
}

#[test]
fn a_log_is_replaced_neither_where_a_shell_has_it_open_nor_through_a_link_among_drawings() {
    let folder = folder();
    let log = folder.path().join("log.csv");
    let before = fs::read_to_string(&log).unwrap();
    let refused = |command: &mut Command, reason: &str| {
        let ended = command.output().unwrap();
        let said = String::from_utf8_lossy(&ended.stderr);
        assert!(ended.status.code() == Some(2) && said.contains(reason), "{said}");
        assert!(fs::read_to_string(&log).unwrap() == before);
    };
    let line = "exec \"$0\" estimate log.csv --quiet --decisions /dev/fd/5 5<>log.csv";
    let mut shell = Command::new("sh");
    shell.args(["-c", line, env!("CARGO_BIN_EXE_tauscope")]).current_dir(folder.path());
    refused(&mut shell, "a file that is read");
}

#[test]
fn names_that_control_a_terminal_or_compute_are_shown() {
    let folder = folder();
    let name = "=a\u{1b}]0;mine\u{7}";
    let text = log_text().replacen("a.input,a.output", &format!("{name}.input,{name}.output"), 1);
    fs::write(folder.path().join("log.csv"), text).unwrap();
    let mut command = tauscope(folder.path());
    command.args(["estimate", "log.csv", "--decisions", "d.csv"]);
    let ended = command.env("CLICOLOR_FORCE", "1").output().unwrap();
    assert!(ended.status.success());
    for stream in [&ended.stdout, &ended.stderr] {
        assert!(!String::from_utf8_lossy(stream).contains("\u{1b}]"));
    }
    assert!(String::from_utf8_lossy(&ended.stdout).contains(r"=a\u{1b}]0;mine\u{7}"));
}

#[test]
fn a_window_as_long_as_can_be_is_that_of_the_whole_trial() {
    let folder = folder();
    let delays = |alpha: &str| {
        let mut command = tauscope(folder.path());
        command.args(["estimate", "log.csv", "--quiet", "--method", "hinge", "--alpha", alpha]);
        let ended = command.output().unwrap();
        assert!(ended.status.success(), "{}", String::from_utf8_lossy(&ended.stderr));
        String::from_utf8(ended.stdout).unwrap().lines().take(5).collect::<Vec<_>>().join("\n")
    };
    assert_eq!(delays("18446744073709551615"), delays("100000"));
}
