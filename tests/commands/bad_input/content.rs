//! What is in a log: cells, rows, columns, times and joints.

use std::fs;

use serde_json::Value;

use super::workspace::{Log, Workspace, boom, seconds};

#[test]
fn a_missing_file_is_named() {
    Workspace::new().estimate("absent.csv").is_refused().says(&["absent.csv"]);
}

#[test]
fn a_file_with_nothing_in_it_is_refused() {
    for text in ["", "\n", "\n\n\n", "\u{feff}", "# only a comment\n"] {
        let workspace = Workspace::new().with("log.csv", text);
        workspace.estimate("log.csv").is_refused().says(&["log.csv", "empty"]).says_what_to_do();
    }
}

#[test]
fn a_header_without_samples_is_refused() {
    for text in ["time_s,boom.input,boom.output", "time_s,boom.input,boom.output\n# end\n\n"] {
        let workspace = Workspace::new().with("log.csv", text);
        workspace.estimate("log.csv").is_refused().says(&["log.csv", "header", "sample"]);
    }
}

#[test]
fn a_single_sample_is_refused() {
    let outcome = Workspace::new().with_log(&boom().samples(1)).estimate("log.csv");
    outcome.is_refused().says(&["log.csv", "row 2", "one row"]).says_what_to_do();
}

#[test]
fn a_signal_that_is_missing_is_named() {
    for column in ["boom.input", "boom.output"] {
        let outcome = Workspace::new().with_log(&boom().without(column)).estimate("log.csv");
        outcome.is_refused().says(&["log.csv", "row 1", &format!("`{column}`")]);
    }
}

#[test]
fn a_misspelt_signal_is_offered_in_its_right_spelling() {
    let workspace = Workspace::new().with_log(&boom().renamed("boom.output", "boom.outptu"));
    let says = ["log.csv", "row 1", "`boom.output`", "did you mean `boom.outptu`?"];
    workspace.estimate("log.csv").is_refused().says(&says);
}

#[test]
fn a_log_without_time_is_refused_with_both_remedies() {
    let outcome = Workspace::new().with_log(&boom().without("time_s")).estimate("log.csv");
    outcome.is_refused().says(&[
        "log.csv",
        "row 1",
        "found boom.input, boom.output",
        "`--time COLUMN`",
        "`--sample-period SECONDS`",
    ]);
    let unnamed = Workspace::new().with_log(&boom().renamed("time_s", ""));
    let says = ["`--time ''` takes the first column", "`--sample-period SECONDS`"];
    unnamed.estimate("log.csv").is_refused().says(&says);
}

#[test]
fn a_log_without_joints_is_refused_with_its_columns() {
    let log = boom().renamed("boom.input", "left").renamed("boom.output", "right");
    let says = ["log.csv", "row 1", "no joint", "time_s, left, right", "--joint "];
    Workspace::new().with_log(&log).estimate("log.csv").is_refused().says(&says);
}

#[test]
fn a_mapped_column_that_is_missing_is_named() {
    let workspace = Workspace::new().with_log(&boom());
    for (option, column) in [
        ("--joint arm=boom.input:angle", "angle"),
        ("--joint arm=valve:boom.output", "valve"),
        ("--time clock", "clock"),
        ("--trial repetition", "repetition"),
    ] {
        let outcome = workspace.estimate(&format!("log.csv {option}"));
        outcome.is_refused().says(&["log.csv", "row 1", &format!("`{column}`"), "boom.input"]);
    }
}

#[test]
fn an_unknown_joint_is_refused_with_those_that_are_there() {
    let outcome = Workspace::new().with_log(&boom()).estimate("log.csv --joint bom");
    outcome.is_refused().says(&["log.csv", "`bom`", "did you mean `boom`?"]);
}

#[test]
fn text_in_a_number_cell_is_named_with_its_place() {
    for (column, text) in
        [("boom.input", "off"), ("boom.output", "12.x"), ("time_s", "noon"), ("time_s", "")]
    {
        let workspace = Workspace::new().with_log(&boom().cell(17, column, text));
        let says = ["log.csv", "row 17", &format!("`{column}`")];
        workspace.estimate("log.csv").is_refused().says(&says).says_what_to_do();
    }
}

#[test]
fn a_decimal_comma_is_read_and_one_that_parts_thousands_is_refused() {
    let text = boom().text().replace(',', ";").replace('.', ",").replace("boom,", "boom.");
    Workspace::new().with("log.csv", text.as_str()).estimate("log.csv").is_whole();
    let says = ["log.csv", "row 17", "`boom.output`", "1.234,5"];
    let mut lines: Vec<String> = text.lines().map(str::to_owned).collect();
    lines[16] = "0,15;0;1.234,5".to_owned();
    let text = lines.join("\n");
    Workspace::new().with("log.csv", text).estimate("log.csv").is_refused().says(&says);
}

#[test]
fn an_infinite_number_is_named_with_its_place() {
    for text in ["inf", "-inf", "Infinity", "1e999"] {
        for column in ["boom.input", "boom.output"] {
            let workspace = Workspace::new().with_log(&boom().cell(17, column, text));
            let says = ["log.csv", "row 17", &format!("`{column}`")];
            workspace.estimate("log.csv").is_refused().says(&says).says_what_to_do();
        }
    }
}

#[test]
fn an_input_that_was_never_measured_is_named_even_when_gaps_may_be_filled() {
    let workspace = Workspace::new().with_log(&boom().column("boom.input", |_| String::new()));
    let outcome = workspace.estimate("log.csv --fill 1");
    outcome.is_refused().says(&["log.csv", "`boom.input`"]);
}

#[test]
fn a_row_of_another_length_is_named() {
    for count in [1, 2, 4, 9] {
        let outcome = Workspace::new().with_log(&boom().cells(17, count)).estimate("log.csv");
        let says = ["log.csv", "row 17", &format!("{count} cells"), "has 3"];
        outcome.is_refused().says(&says).says_what_to_do();
    }
}

#[test]
fn a_quotation_mark_that_is_never_closed_is_named_where_it_opens() {
    let outcome =
        Workspace::new().with_log(&boom().cell(17, "boom.input", "\"1")).estimate("log.csv");
    outcome.is_refused().says(&["log.csv", "row 17"]);
}

#[test]
fn two_columns_of_one_name_are_refused() {
    let log = Log::of(&["boom", "arm"]);
    let log = log.renamed("arm.input", "boom.input").renamed("arm.output", "boom.output");
    let outcome = Workspace::new().with_log(&log).estimate("log.csv");
    outcome.is_refused().says(&["log.csv", "row 1", "`boom.input`", "rename"]);
}

#[test]
fn two_joints_of_one_name_are_refused() {
    let joint = "--joint boom=boom.input:boom.output";
    let outcome = Workspace::new().with_log(&boom()).estimate(&format!("log.csv {joint} {joint}"));
    outcome.is_refused().says(&["`boom`"]).says_what_to_do();
}

#[test]
fn time_that_goes_backwards_is_refused_where_it_does() {
    let outcome = Workspace::new().with_log(&boom().cell(17, "time_s", "0.01")).estimate("log.csv");
    outcome.is_refused().says(&["log.csv", "row 17", "0.14 s to 0.01 s", "`trial`"]);
}

#[test]
fn a_stamp_that_stands_still_is_jitter_and_a_clock_that_does_is_refused() {
    let outcome = Workspace::new().with_log(&boom().cell(17, "time_s", "0.14")).estimate("log.csv");
    outcome.is_whole();
    assert!(
        outcome.stderr.contains("largest 100 % at row 17: samples are placed"),
        "{}",
        outcome.stderr
    );
    let still = boom().column("time_s", |_| "0.14".to_owned());
    let outcome = Workspace::new().with_log(&still).estimate("log.csv");
    outcome.is_refused().says(&["log.csv", "row 3", "0.14 s"]).says_what_to_do();
}

#[test]
fn two_time_steps_are_put_on_one_grid_with_a_note() {
    let time = |k: usize| seconds(0.01 * k as f64 + 0.01 * k.saturating_sub(200) as f64);
    let outcome = Workspace::new().with_log(&boom().column("time_s", time)).estimate("log.csv");
    outcome.is_whole();
    assert!(
        outcome.stderr.contains("the output interpolated and the input held"),
        "{}",
        outcome.stderr
    );
}

#[test]
fn a_constant_input_gives_an_empty_result_that_says_so() {
    let log = boom().column("boom.input", |_| "1.5".to_owned());
    let workspace = Workspace::new().with_log(&log);
    let outcome = workspace.estimate("log.csv --decisions d.csv --delays t.csv");
    outcome.is_whole();
    assert!(outcome.stdout.contains("the input never changes"), "{}", outcome.stdout);
    assert_eq!(workspace.text("d.csv").lines().count(), 1);
    let delays = workspace.text("t.csv");
    assert_eq!(delays.lines().count(), 301);
    assert!(delays.lines().skip(1).all(|line| line.ends_with(',')), "{delays}");
    let joint = &workspace.estimate("log.csv --format json").joints()[0];
    assert_eq!((&joint["steps"], &joint["accepted"]), (&0.into(), &0.into()));
    assert_eq!((&joint["delay_s"], &joint["decisions"]), (&Value::Null, &Value::Array(vec![])));
}

#[test]
fn an_input_that_changes_at_every_sample_works_with_a_note() {
    let workspace = Workspace::new().with_log(&boom().column("boom.input", |k| k.to_string()));
    let outcome = workspace.estimate("log.csv --format json");
    outcome.is_whole().says(&["note: ", "`boom`", "the input moves all the time", "100 %"]);
    assert_eq!(outcome.joints()[0]["steps"], 0);
    let steps = &workspace.estimate("log.csv --input steps --format json").joints()[0]["steps"];
    assert!(steps.as_u64().unwrap() > 10, "{steps}");
    assert_eq!(workspace.estimate("log.csv --quiet").is_whole().stderr, "");
}

#[test]
fn fewer_samples_than_two_rows_are_refused() {
    let workspace = Workspace::new().with_log(&boom().samples(9));
    let says = ["log.csv", "9 samples", "10", "`--beta`"];
    workspace.estimate("log.csv").is_refused().says(&says);
    workspace.estimate("log.csv --beta 4").is_whole();
}

#[test]
fn a_folder_without_logs_is_named() {
    let workspace = Workspace::new().with_log(&boom());
    fs::create_dir(workspace.path("folder")).unwrap();
    workspace.estimate("folder").is_refused().says(&["folder", ".csv"]);
    workspace.estimate("log.csv folder").is_partial(1).says(&["folder", ".csv"]);
}

#[test]
fn a_column_mapping_that_cannot_be_used_is_named() {
    let workspace = Workspace::new().with_log(&boom()).with("map.toml", "tiem = 't'\n");
    workspace.estimate("log.csv --columns map.toml").is_refused().says(&["map.toml", "tiem"]);
    workspace.estimate("log.csv --columns absent.toml").is_refused().says(&["absent.toml"]);
    workspace.estimate("log.csv --joint =a:b").is_refused().says(&["`=a:b`", "NAME="]);
}

#[test]
fn bytes_that_are_no_text_are_refused_with_their_place() {
    let cell = b"time_s,boom.input,boom.output\n0,0,0\n0.01,0,\xff\xfe\n".as_slice();
    let outcome = Workspace::new().with("log.csv", cell).estimate("log.csv");
    outcome.is_refused().says(&["log.csv", "row 3"]);
}

/// `bad` is named in line 17, however its lines end.
fn is_named_in_line_17(bad: &str) {
    let outcome = Workspace::new().with("log.csv", bad).estimate("log.csv");
    outcome.is_refused().says(&["row 17, column `boom.output`"]);
}

#[test]
fn rows_are_counted_as_an_editor_does_with_both_line_endings() {
    let bad = boom().cell(17, "boom.output", "x").text();
    is_named_in_line_17(&bad);
    is_named_in_line_17(&bad.replace('\n', "\r\n"));
}

#[test]
fn rows_are_counted_as_an_editor_does_with_mixed_line_endings() {
    let bad = boom().cell(17, "boom.output", "x").text();
    for phase in 0..3 {
        let every_third = |(line, text): (usize, &str)| {
            let ending = if (line + phase) % 3 == 0 { "\r\n" } else { "\n" };
            format!("{text}{ending}")
        };
        is_named_in_line_17(&bad.lines().enumerate().map(every_third).collect::<String>());
    }
}

#[test]
fn rows_are_counted_as_an_editor_does_below_a_very_long_header() {
    let long_name = "x".repeat(70_000);
    let widen = |(line, text): (usize, &str)| match line {
        0 => format!("{text},{long_name}\n"),
        _ => format!("{text},0\n"),
    };
    let bad = boom().cell(17, "boom.output", "x").text();
    let wide: String = bad.lines().enumerate().map(widen).collect();
    is_named_in_line_17(&wide);
    is_named_in_line_17(&wide.replace('\n', "\r\n"));
}
