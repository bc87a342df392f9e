//! What makes the program easy to use: completions, `doctor`, colours, names that were mistyped.

use std::fmt::Write as _;
use std::io::Write as _;
use std::process::{Command, Output, Stdio};

use crate::desk::{Desk, banded, fields, joint};
use serde_json::Value;

fn tauscope(arguments: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_tauscope"));
    command.args(arguments);
    for name in ["NO_COLOR", "CLICOLOR", "CLICOLOR_FORCE"] {
        command.env_remove(name);
    }
    command
}

fn printed(output: &Output) -> String {
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout.clone()).unwrap()
}

/// Says that a test is skipped. Not `eprintln`, which the test runner keeps to itself.
fn skipped(why: &str) {
    let mut stderr = std::io::stderr();
    writeln!(stderr, "skipped: {why}").unwrap();
}

/// The commands that the program says it has.
fn commands() -> Vec<String> {
    let help = printed(&tauscope(&["--help"]).output().unwrap());
    let list = help.split_once("Commands:").unwrap().1.split("Options:").next().unwrap();
    let word = |line: &str| line.split_whitespace().next().map(str::to_owned);
    // A line that goes on is indented deeper.
    let starts = list.lines().filter(|line| line.starts_with("  ") && !line.starts_with("   "));
    starts.filter_map(word).filter(|command| command != "help").collect()
}

#[test]
fn completions_of_every_shell_know_every_command() {
    let commands = commands();
    assert!(commands.len() >= 12, "{commands:?}");
    for shell in ["bash", "elvish", "fish", "powershell", "zsh"] {
        let script = printed(&tauscope(&["completions", shell]).output().unwrap());
        for command in &commands {
            assert!(script.contains(command.as_str()), "{shell}: {command}");
        }
        assert!(script.contains("two-line"), "{shell}: the values of --method");
    }
}

/// What bash offers after some words, or `None` without bash.
fn offered(words: &[&str]) -> Option<Vec<String>> {
    let line = words.iter().map(|word| format!("'{word}'")).collect::<Vec<_>>().join(" ");
    let script = format!(
        "source <({program} completions bash); COMP_WORDS=({line}); COMP_CWORD={last}; \
         _tauscope tauscope \"${{COMP_WORDS[COMP_CWORD]}}\" \"${{COMP_WORDS[COMP_CWORD-1]}}\"; \
         printf '%s\\n' \"${{COMPREPLY[@]}}\"",
        program = env!("CARGO_BIN_EXE_tauscope"),
        last = words.len() - 1,
    );
    let output = Command::new("bash").args(["-c", &script]).output().ok()?;
    Some(printed(&output).lines().map(str::to_owned).collect())
}

#[test]
fn bash_completes_commands_options_and_values() {
    let Some(first) = offered(&["tauscope", "swe"]) else {
        skipped("there is no bash");
        return;
    };
    assert_eq!(first, ["sweep"]);
    let options = offered(&["tauscope", "estimate", "--min-s"]).unwrap();
    assert_eq!(options, ["--min-slope-change", "--min-step"]);
    let values = offered(&["tauscope", "estimate", "--method", "l"]).unwrap();
    assert_eq!(values, ["lag-aware"]);
}

/// `doctor` where `PATH` is `path`: its JSON.
fn doctor(path: &std::path::Path) -> Value {
    let output = tauscope(&["doctor", "--format", "json"]).env("PATH", path).output().unwrap();
    let json: Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(json["schema"], "tauscope/doctor/1");
    let complete = json["complete"].as_bool().unwrap();
    assert_eq!(output.status.code(), Some(i32::from(!complete)));
    json
}

fn check<'a>(json: &'a Value, name: &str) -> &'a Value {
    let checks = json["checks"].as_array().unwrap();
    checks.iter().find(|check| check["name"] == name).unwrap()
}

#[test]
fn doctor_tells_of_each_thing_what_is_missing_and_the_remedy() {
    let empty = tempfile::tempdir().unwrap();
    let json = doctor(empty.path());
    assert_eq!(json["complete"], false);
    for check in json["checks"].as_array().unwrap() {
        assert_eq!(fields(check), ["name", "state", "found", "remedy"]);
        assert_eq!(check["state"] == "ok", check["remedy"].is_null(), "{check}");
        assert!(!check["found"].as_str().unwrap().is_empty());
    }
    let viewer = check(&json, "viewer");
    assert_eq!(viewer["state"], "missing");
    assert_eq!(viewer["remedy"], "pip install rerun-sdk==0.36.3");
    let state = if cfg!(feature = "rrd") { "ok" } else { "missing" };
    assert_eq!(check(&json, "program")["state"], state);
}

#[cfg(unix)]
#[test]
fn doctor_asks_the_viewer_for_its_version() {
    use std::os::unix::fs::PermissionsExt as _;
    let answers = [
        ("echo rerun-cli 0.36.3 '(base map_view)'", "ok", "rerun 0.36.3"),
        ("echo rerun-cli 0.35.0", "missing", "recordings are made for 0.36.3"),
        ("exit 1", "missing", "does not report its version"),
    ];
    for (answer, state, found) in answers {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("rerun");
        std::fs::write(&path, format!("#!/bin/sh\n{answer}\n")).unwrap();
        std::fs::set_permissions(&path, std::fs::Permissions::from_mode(0o755)).unwrap();
        let json = doctor(folder.path());
        let viewer = check(&json, "viewer");
        assert_eq!(viewer["state"], state, "{answer}");
        assert!(viewer["found"].as_str().unwrap().contains(found), "{viewer}");
    }
}

#[test]
fn colours_are_there_only_where_they_are_wanted() {
    let desk = Desk::with(vec![joint("boom")]);
    let log = desk.folder.path().join("log.csv");
    let is_colored = |variables: &[(&str, &str)]| {
        let mut command = tauscope(&["estimate", log.to_str().unwrap(), "--joint", "boom,"]);
        let refused = command.envs(variables.iter().copied()).output().unwrap();
        refused.stderr.contains(&0x1b)
    };
    assert!(!is_colored(&[]), "a pipe is no terminal");
    assert!(is_colored(&[("CLICOLOR_FORCE", "1")]), "colours were forced");
    assert!(!is_colored(&[("NO_COLOR", "1"), ("CLICOLOR_FORCE", "1")]), "who wants none gets none");
    let forced = tauscope(&["estimate", log.to_str().unwrap(), "--format", "json"])
        .env("CLICOLOR_FORCE", "1")
        .output()
        .unwrap();
    assert!(!forced.stdout.contains(&0x1b), "JSON is for programs");
}

#[test]
fn names_that_were_mistyped_are_answered_with_the_nearest() {
    let desk = Desk::with(vec![banded("boom")]);
    desk.write(
        "model.toml",
        "schema = \"tauscope/model/1\"\n[joint.bom]\nstructure = \
        \"integrator\"\nparameters = { gain = 10.0, delay = 0.1 }\n",
    );
    let refused = [
        ("estimte log.csv", "`estimate`"),
        ("estimate log.csv --methd hinge", "'--method'"),
        ("explain log.csv --method hinge", "option of `estimate`, `sweep`, `report`"),
        ("log.csv --decisions d.csv", "option of `estimate`"),
        ("estimate log.csv --method hing", "'hinge'"),
        ("estimate log.csv --joint arm=bom.input:boom.output", "`boom.input`"),
        ("estimate log.csv --time time_", "`time_s`"),
        ("sweep log.csv --method hing", "`hinge`"),
        ("effects dead_bnd", "`dead_band`"),
        ("completions bsh", "'bash'"),
    ];
    for (arguments, near) in refused {
        let stderr = desk.refusal(arguments);
        assert!(stderr.contains(near), "{arguments}: {stderr}");
        assert!(!stderr.contains("-- --"), "{arguments}: {stderr}");
    }
    let output = desk.run("explain log.csv --model model.toml --effects dead_band");
    let stderr = String::from_utf8(output.stderr).unwrap();
    assert!(stderr.contains("not in the model file, which has `bom`"), "{stderr}");
}

/// What a command shows on a terminal, or `None` where none can be had.
#[cfg(target_os = "linux")]
fn on_a_terminal(desk: &Desk, arguments: &str) -> Option<String> {
    let command = format!("{} {arguments}", env!("CARGO_BIN_EXE_tauscope"));
    let output = Command::new("script")
        .args(["-qec", &command, "/dev/null"])
        .current_dir(desk.folder.path())
        .env("TERM", "xterm")
        .stdin(Stdio::null())
        .output()
        .ok()?;
    Some(String::from_utf8_lossy(&output.stdout).into_owned())
}

#[cfg(target_os = "linux")]
#[test]
fn progress_has_rate_and_time_left_on_a_terminal_and_none_where_it_is_not_wanted() {
    let desk = Desk::with(vec![banded("boom")]);
    let improve = "improve log.csv --effects dead_band,actuator_lag,thermal_drift --write m.toml";
    let Some(shown) = on_a_terminal(&desk, improve) else {
        skipped("there is no `script` to make a terminal");
        return;
    };
    let bar = |shown: &str| shown.contains(" fits, ") && shown.contains("/s, ");
    assert!(bar(&shown) && shown.contains(" left"), "{shown}");
    assert!(shown.contains("improving"), "messages stand beside the bar: {shown}");
    let quiet = on_a_terminal(&desk, &format!("{improve} --quiet")).unwrap();
    assert!(!bar(&quiet), "{quiet}");
    let piped = desk.run(improve);
    assert!(!bar(&String::from_utf8_lossy(&piped.stderr)));
}

#[test]
fn steps_that_lie_in_gaps_have_delays_without_an_option() {
    let folder = tempfile::tempdir().unwrap();
    let mut log = "run,t_s,u_boom,y_boom\n".to_owned();
    for run in 0..3 {
        for k in 0..300 {
            // The valve is switched while nothing is logged, just before the rows go on.
            let (paused, late) = ((100..200).contains(&k), (f64::from(k) - 220.0).max(0.0));
            if !paused {
                let level = u8::from(k >= 200);
                let (time, angle) = (0.01 * f64::from(k), 0.1 * late);
                log.extend([format!("{run},{time:.2},{level},{angle:.4}\n")]);
            }
        }
    }
    let path = folder.path().join("pauses.csv");
    std::fs::write(&path, log).unwrap();
    let output =
        tauscope(&["estimate", "--format", "json", "--method", "hinge"]).arg(&path).output();
    let output = output.unwrap();
    let notes = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(notes.contains("its input changes only in gaps"), "{notes}");
    let found: Value = serde_json::from_str(&printed(&output)).unwrap();
    let joint = &found["joints"][0];
    assert_eq!((&joint["joint"], &joint["accepted"]), (&"boom".into(), &3.into()), "{found}");
    let median = joint["delay_s"]["median"].as_f64().unwrap();
    assert!((median - 0.2).abs() < 0.02, "{median}");
}

#[test]
fn columns_says_what_is_mended_in_the_log() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("log.csv");
    // The newest row is first, the slewing joint turns more than once, and one of its samples is missing.
    let mut text = "time_s,slew.input [V],slew.output [deg]\n".to_owned();
    for k in (0..3000).rev() {
        let level = [0.0, 3.0, 0.0, -2.0][(k / 200) % 4];
        let angle = (700.0 * (k as f64 / 500.0).sin()).rem_euclid(360.0);
        let angle = if k == 1234 { String::new() } else { format!("{angle:.3}") };
        writeln!(text, "{:.2},{level},{angle}", 0.01 * k as f64).unwrap();
    }
    std::fs::write(&path, text).unwrap();
    let path = path.to_str().unwrap();
    let table = printed(&tauscope(&["columns", path]).output().unwrap());
    let json = printed(&tauscope(&["columns", path, "--format", "json"]).output().unwrap());
    let json: Value = serde_json::from_str(&json).unwrap();
    let mended: Vec<&str> =
        json["mended"].as_array().unwrap().iter().filter_map(Value::as_str).collect();
    let expected =
        ["the newest row is first", "wraps at a turn of 360 deg", "1 cell is empty or NaN"];
    assert_eq!(mended.len(), expected.len(), "{mended:?}");
    for (line, says) in mended.iter().zip(expected) {
        assert!(line.contains(says) && table.contains(&format!("on reading: {line}")), "{table}");
    }
}

/// What stands between backticks in a source: commands and options as they are typed.
fn quoted_commands(source: &str) -> Vec<&str> {
    let lines = source.lines().filter(|line| !line.trim_start().starts_with("//"));
    let spans = lines.flat_map(|line| line.split('`').skip(1).step_by(2));
    spans.filter(|span| span.starts_with("--") || span.starts_with("tauscope ")).collect()
}

#[test]
fn every_option_that_a_message_names_exists() {
    let mut of_commands = std::collections::BTreeMap::new();
    for command in commands() {
        let help = printed(&tauscope(&[&command, "--help"]).output().unwrap());
        let lines = help.lines().map(str::trim_start);
        let options = lines.filter(|line| line.starts_with('-')).flat_map(str::split_whitespace);
        let options = options.filter(|word| word.starts_with("--")).map(str::to_owned);
        of_commands.insert(command, options.collect::<std::collections::BTreeSet<_>>());
    }
    let name = |word: &str| {
        let is_of_name = |letter: char| letter.is_ascii_lowercase() || letter == '-';
        word.chars().take_while(|letter| is_of_name(*letter)).collect::<String>()
    };
    let mut folders = vec![std::path::PathBuf::from(concat!(env!("CARGO_MANIFEST_DIR"), "/src"))];
    let mut seen = 0;
    while let Some(folder) = folders.pop() {
        for entry in std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()) {
            if entry.is_dir() {
                folders.push(entry);
                continue;
            }
            let source = std::fs::read_to_string(&entry).unwrap_or_default();
            for span in quoted_commands(&source) {
                let mut words = span.split_whitespace();
                let command = words.next().filter(|word| *word == "tauscope").and(words.next());
                let known = |option: &String| match command.and_then(|one| of_commands.get(one)) {
                    Some(own) => own.contains(option),
                    None => of_commands.values().any(|own| own.contains(option)),
                };
                let options = span.split_whitespace().filter(|word| word.starts_with("--"));
                for option in options.map(name).filter(|option| option.len() > 2) {
                    // The second is one of Cargo.
                    let is_other = ["--help", "--features"].contains(&option.as_str());
                    assert!(is_other || known(&option), "{}: `{span}`", entry.display());
                    seen += 1;
                }
            }
        }
    }
    assert!(seen > 50, "{seen} options");
}
