//! Numbers and texts that no joint has: refused or written harmlessly, never half believed.

use std::fs;
use std::path::Path;
use std::process::{Command, Output};

use tempfile::TempDir;

const LOG: &str = "data/hidden_effect.csv";

fn tauscope(folder: &Path, arguments: &[&str]) -> Output {
    let log = fs::canonicalize(LOG).unwrap();
    let arguments = arguments.iter().map(|argument| match *argument {
        LOG => log.as_os_str().to_owned(),
        argument => argument.into(),
    });
    let mut command = Command::new(env!("CARGO_BIN_EXE_tauscope"));
    command.args(arguments).arg("-q").current_dir(folder).output().unwrap()
}

/// The message with which a command is refused.
fn refused(folder: &Path, arguments: &[&str]) -> String {
    let output = tauscope(folder, arguments);
    let said = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(2), "{arguments:?}: {said}");
    assert!(!said.contains("panicked"), "{said}");
    said
}

/// A model whose one effect is described by this text.
fn described(summary: &str) -> String {
    format!(
        "schema = \"tauscope/model/1\"\n[joint.boom]\nstructure = \"integrator\"\n\
         parameters = {{ gain = 7.5, delay = 0.1 }}\n[[joint.boom.effect]]\nkind = \"expression\"\n\
         id = \"own\"\nsummary = {}\nstage = \"input\"\nexpression = \"signal + k\"\n\
         parameters.k = 0.0\n",
        toml::Value::String(summary.to_owned())
    )
}

/// `text` in C without its comments, as a compiler sees it: first lines are joined, then comments go.
fn without_comments(text: &str) -> String {
    let joined = text.replace("\\\n", "");
    let mut parts = joined.split("/*");
    let mut code = parts.next().unwrap_or_default().to_owned();
    for part in parts {
        code += part.split_once("*/").unwrap().1;
    }
    code
}

/// What a model file says of an effect stays a comment in every language.
#[test]
fn a_text_of_a_model_file_becomes_no_code() {
    let folder = TempDir::new().unwrap();
    let exported = |summary: &str, ending: &str| {
        fs::write(folder.path().join("model.toml"), described(summary)).unwrap();
        let name = format!("out.{ending}");
        let unit = "V]\nimport os\n#";
        let output =
            tauscope(folder.path(), &["export", "model.toml", &name, "--input-unit", unit]);
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        fs::read_to_string(folder.path().join(name)).unwrap()
    };
    let hostile = [
        "x*/ EVIL /*",
        "x*\\\n/ EVIL /\\\n*",
        "x*\\",
        "x*??/\n/ EVIL",
        "x\nEVIL\n%",
        "x\r\u{2028}EVIL\u{85}#",
        "x\"\"\"\nEVIL\n\"\"\"",
        "\u{1b}[31m",
    ];
    for ending in ["c", "m", "py"] {
        let harmless = exported("x", ending);
        for summary in hostile {
            let text = exported(summary, ending);
            assert_eq!(text.lines().count(), harmless.lines().count(), "{ending}: {summary:?}");
            assert!(!text.contains(['\u{1b}', '\r', '\u{2028}', '\u{85}']), "{summary:?}");
            for line in text.lines().filter(|line| line.contains("EVIL")) {
                let start = line.trim_start();
                let is_comment = match ending {
                    "m" => start.starts_with('%'),
                    "py" => start.starts_with("\"\"\"") && line.matches("\"\"\"").count() == 2,
                    _ => true,
                };
                assert!(is_comment, "{ending}: {line}");
            }
            if ending == "c" {
                assert_eq!(without_comments(&text), without_comments(&harmless), "{summary:?}");
            }
        }
    }
}

#[test]
#[cfg(unix)]
fn the_name_of_a_log_moves_no_cursor_where_delays_are_exported() {
    let folder = TempDir::new().unwrap();
    let log = "a\u{1b}[31m\u{202e}b.csv";
    fs::copy(concat!(env!("CARGO_MANIFEST_DIR"), "/data/manipulator.csv"), folder.path().join(log))
        .unwrap();
    for name in ["out.c", "out.m", "out.py"] {
        let arguments = ["estimate", log, "--joint", "shoulder_pitch", "--export", name];
        let output = tauscope(folder.path(), &arguments);
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        let text = fs::read_to_string(folder.path().join(name)).unwrap();
        assert!(text.contains("31m"), "{text}");
        assert!(!text.contains(['\u{1b}', '\u{202e}']), "{name}");
    }
}

#[test]
fn a_model_that_gives_no_finite_numbers_is_refused_and_nothing_is_written() {
    let folder = TempDir::new().unwrap();
    let add = ["add", "gravity_load", LOG, "--joint", "boom", "-m", "model.toml", "-w", "new.toml"];
    let compare = ["compare", LOG, "--joint", "boom", "-m", "model.toml"];
    // Squares of the outputs leave double precision with the first, the outputs with the second.
    for gain in ["1e155", "1e308"] {
        let model = described("x").replace("7.5", gain);
        fs::write(folder.path().join("model.toml"), model).unwrap();
        for arguments in [&add[..], &compare] {
            let said = refused(folder.path(), arguments);
            assert!(said.contains("their squares are beyond double precision"), "{said}");
        }
        let levels = "--levels=-1,0,1";
        let said = refused(folder.path(), &["design", "-m", "model.toml", levels]);
        assert!(said.contains("joint `boom` has a gain of 1.0e"), "{said}");
    }
    assert!(!folder.path().join("new.toml").exists());
}

#[test]
fn a_signal_that_never_changes_is_said_and_not_fitted() {
    let folder = TempDir::new().unwrap();
    for (signal, input, output) in [("output", 1, 0), ("input", 0, 1)] {
        let level = |k: i32, moves: i32| moves * (k / 150 % 3 - 1);
        let row = |k: i32| {
            let time = format!("{}.{:02}", k / 100, k % 100);
            format!("{time},{},{}\n", level(k, input), level(k, output))
        };
        let rows: String = (0..6000).map(row).collect();
        let log = format!("time_s,a.input,a.output\n{rows}");
        fs::write(folder.path().join("still.csv"), log).unwrap();
        for command in [&["add", "dead_band"][..], &["explain"], &["improve"]] {
            let said = refused(folder.path(), &[command, &["still.csv"]].concat());
            assert!(said.contains(&format!("its {signal} never changes")), "{said}");
        }
        assert!(!folder.path().join("model.toml").exists());
    }
}

#[test]
fn periods_and_delays_that_no_log_has_are_refused() {
    let folder = TempDir::new().unwrap();
    for period in ["1e307", "1e-300", "0", "nan"] {
        let said = refused(folder.path(), &["estimate", LOG, "--sample-period", period]);
        assert!(said.contains("--sample-period"), "{said}");
    }
    let log = |period: &str| {
        let row = |k: i32| format!("{k}{period},{},{k}\n", k / 9 % 2);
        let rows: String = (0..90).map(row).collect();
        fs::write(folder.path().join("log.csv"), format!("time_s,j.input,j.output\n{rows}"))
    };
    for period in ["e-300", "e-10"] {
        log(period).unwrap();
        let said = refused(folder.path(), &["estimate", "log.csv"]);
        let place = "log.csv, row 2, column `time_s`: from here on samples come 1e-";
        assert!(said.contains(place) && said.contains("--sample-period"), "{said}");
    }
    let review = "joint,trial,i,verdict,delay_s,note,reviewer\nboom,1,2,accepted,1e308,,\n";
    fs::write(folder.path().join("review.csv"), review).unwrap();
    let said = refused(folder.path(), &["estimate", LOG, "--review", "review.csv"]);
    assert!(said.contains("delay_s"), "{said}");
}

/// 900 rows, each 2 % later than the one before.
#[test]
fn a_clock_that_slows_down_without_end_is_read_in_no_time() {
    let folder = TempDir::new().unwrap();
    let row = |k: i32| format!("{:e},{},{k}\n", 1e-10 * 1.02_f64.powi(k), k / 9 % 2);
    let rows: String = (0..900).map(row).collect();
    let text = format!("time_s,j.input,j.output\n{rows}");
    fs::write(folder.path().join("log.csv"), text).unwrap();
    let output = tauscope(folder.path(), &["estimate", "log.csv"]);
    assert!(output.status.code().is_some_and(|code| code != 101));
}
