//! `tauscope LOG`, without a command: what a new user sees first.

use crate::desk::{Desk, banded};

fn printed(desk: &Desk, arguments: &str, status: i32) -> String {
    let output = desk.run(arguments);
    assert_eq!(output.status.code(), Some(status), "{output:?}");
    String::from_utf8(output.stdout).unwrap()
}

#[test]
fn a_log_alone_says_what_was_measured_the_delays_what_is_missing_and_what_is_next() {
    let desk = Desk::with(vec![banded("boom")]);
    let text = printed(&desk, "log.csv --effects dead_band,actuator_lag", 0);
    let places = ["duration", "delay min", "1          + dead_band", "what next:"];
    let places = places.map(|part| text.find(part).unwrap_or_else(|| panic!("no {part}: {text}")));
    assert!(places.is_sorted(), "{places:?}");
    // What stands there is what the commands print by themselves.
    let estimate = printed(&desk, "estimate log.csv", 0);
    assert!(text.contains(estimate.trim()), "{text}");
    let improve = "improve log.csv --write other.toml --quiet --effects dead_band,actuator_lag";
    assert!(text.contains(printed(&desk, improve, 0).trim()), "{text}");
    // Nothing is written unless it is asked for.
    let written = |name: &str| desk.has(name);
    assert!(!["log.html", "log.rrd", "model.toml"].into_iter().any(written));
}

#[test]
fn the_files_go_beside_the_log_or_where_they_are_named() {
    let desk = Desk::with(vec![banded("boom")]);
    let recorded = cfg!(feature = "rrd");
    let text = printed(&desk, "log.csv --effects dead_band -q -o", 0);
    assert_eq!((desk.has("log.html"), desk.has("log.rrd")), (true, recorded));
    assert_eq!(text.contains("rerun log.rrd"), recorded, "{text}");
    assert!(text.contains("tauscope compare log.csv --model log.toml"), "{text}");
    // A model may have been edited.
    let edited = format!("# mine\n{}", desk.read("log.toml"));
    assert!(edited.contains("dead_band"), "{edited}");
    desk.write("log.toml", &edited);
    printed(&desk, "log.csv --effects dead_band -q -o", 0);
    assert_eq!(desk.read("log.toml"), edited);
    printed(&desk, "log.csv --effects dead_band -q -o second", 0);
    assert_eq!((desk.has("second.html"), desk.has("second.rrd")), (true, recorded));
    printed(&desk, "-q -o second.html log.csv --effects dead_band", 0);
    let log = desk.read("log.csv");
    desk.write("other.csv", &log);
    assert!(desk.refusal("log.csv other.csv -o").contains("2 logs the report needs a name"));
    assert_eq!(desk.read("log.csv"), log);
    printed(&desk, "log.csv --effects dead_band -q -o third.rrd", 0);
    assert_eq!((desk.has("third.html"), desk.has("third.rrd")), (true, recorded));
}

#[test]
fn the_commands_that_are_next_can_be_run() {
    let desk = Desk::with(vec![banded("boom"), banded("arm")]);
    let text = printed(&desk, "log.csv --joint arm --effects dead_band -q", 0);
    let (_, next) = text.split_once("what next:\n").unwrap();
    let commands = next.lines().filter_map(|line| line.trim().strip_prefix("tauscope "));
    let commands: Vec<_> = commands.map(|line| line.split("  ").next().unwrap()).collect();
    assert_eq!(commands.len(), 3, "{next}");
    for command in commands {
        assert!(command.contains("--joint arm"), "{command}");
        printed(&desk, &format!("{command} -q"), 0);
    }
    assert!(desk.has("model.toml") && desk.has("decisions.csv") && desk.has("log.html"));
}

#[test]
fn what_is_no_log_and_no_command_is_said() {
    let desk = Desk::with(vec![banded("boom")]);
    assert!(desk.refusal("nothing.csv").contains("nothing.csv: cannot be read"));
    let missing = desk.refusal("runs/log.dat2");
    assert!(missing.contains("runs/log.dat2: no such file, and no command;"), "{missing}");
    assert!(desk.refusal("-q runs/log.dat2").contains("runs/log.dat2: cannot be read"));
    assert!(desk.refusal("estmate log.csv").contains("no command (did you mean `estimate`?)"));
    desk.write("notes", "no log\n");
    assert!(desk.refusal("notes").contains("notes"));
    let help = printed(&desk, "--help", 0);
    assert!(help.contains("tauscope <LOG>...") && !help.contains("first-look"), "{help}");
}

#[test]
fn a_model_is_kept_from_logs_that_are_not_its_own() {
    let desk = Desk::with(vec![banded("boom"), banded("arm")]);
    printed(&desk, "improve log.csv --effects dead_band -q -w both.toml", 0);
    let both = desk.read("both.toml");
    let refused = desk.refusal("improve log.csv --joint arm --effects dead_band -w both.toml");
    assert!(refused.contains("it has models of boom, which would be lost"), "{refused}");
    assert_eq!(desk.read("both.toml"), both);
    let millivolts = desk.read("log.csv").replacen("boom.input [V]", "boom.input [mV]", 1);
    desk.write("millivolts.csv", &millivolts);
    for command in ["compare", "explain", "improve -w new.toml"] {
        let refused = desk.refusal(&format!("{command} millivolts.csv --model both.toml"));
        let reason = "both.toml, joint `boom`: its input was in V when it was fitted, and is in mV";
        assert!(refused.contains(reason), "{refused}");
    }
}

#[test]
fn no_model_is_offered_where_none_was_found() {
    let desk = Desk::with(vec![banded("boom")]);
    let rows = (0..600).map(|k| format!("{}.{:02},{},1.5\n", k / 100, k % 100, k / 150 % 2));
    let rows: String = rows.collect();
    desk.write("still.csv", &format!("time_s,a.input,a.output\n{rows}"));
    let text = printed(&desk, "still.csv -q -o", 1);
    assert!(!desk.has("still.toml") && !text.contains("still.toml"), "{text}");
}

#[test]
fn that_an_output_does_not_follow_its_input_is_said_first() {
    let desk = Desk::with(vec![banded("boom"), banded("arm")]);
    let log = desk.read("log.csv");
    let crossed =
        log.replacen("boom.output", "x.output", 1).replacen("arm.output", "boom.output", 1);
    desk.write("crossed.csv", &crossed.replacen("x.output", "arm.output", 1));
    let text = printed(&desk, "crossed.csv --joint boom --effects dead_band -q -o", 0);
    let reason = "boom: the output does not follow its input";
    assert!(text.contains(&format!("{reason}: the input steps explain")), "{text}");
    assert!(text.contains("check the columns first"), "{text}");
    let page = desk.read("crossed.html");
    let at = |part: &str| page.find(part).unwrap_or_else(|| panic!("no {part}"));
    assert!(at("does not follow its input") < at("Model: "), "the caution comes first");
}
