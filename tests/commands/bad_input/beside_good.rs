//! What is bad beside what is good: that one is left out, and the rest is there.

use std::fs;

use serde_json::Value;

use super::workspace::{Log, Workspace, boom};

#[test]
fn a_bad_joint_does_not_change_the_good_one_beside_it() {
    let all = "log.csv --decisions d.csv --delays t.csv --format json";
    let good = Workspace::new().with_log(&boom());
    let expected = good.estimate(all).is_whole().joints();
    let pair = Log::of(&["boom", "arm"]);
    for (bad, place) in [
        (pair.clone().cell(17, "arm.output", "x"), "row 17, column `arm.output`"),
        (pair.clone().cell(17, "arm.input", "x"), "row 17, column `arm.input`"),
        (pair.clone().cell(17, "arm.output", "inf"), "row 17, column `arm.output`"),
        (pair.clone().cell(17, "arm.input", "inf"), "row 17, column `arm.input`"),
        (pair.clone().cell(17, "arm.output", "inf"), "row 17, column `arm.output`"),
        (pair.clone().without("arm.output"), "row 1: column `arm.output`"),
        (pair.clone().without("arm.input"), "row 1: column `arm.input`"),
    ] {
        let workspace = Workspace::new().with_log(&bad);
        let outcome = workspace.estimate(all);
        outcome.is_partial(1).says(&["joint `arm`", "log.csv", place]);
        assert_eq!(outcome.joints(), expected);
        assert_eq!(workspace.text("d.csv"), good.text("d.csv"));
        assert_eq!(workspace.text("t.csv"), good.text("t.csv"));
        let json: Value = serde_json::from_str(&outcome.stdout).unwrap();
        let failure = json["failures"][0].as_str().unwrap();
        assert!(failure.contains(place), "{failure}");
        let table = workspace.estimate("log.csv");
        assert!(table.is_partial(1).stdout.contains("boom"), "{}", table.stdout);
    }
}

#[test]
fn a_joint_that_was_asked_for_and_is_not_there_leaves_the_others() {
    let outcome = Workspace::new().with_log(&boom()).estimate("log.csv --joint boom --joint arm");
    outcome.is_partial(1).says(&["`arm`", "log.csv"]);
    assert!(outcome.stdout.contains("boom"), "{}", outcome.stdout);
}

#[test]
fn a_bad_file_beside_a_good_one_is_left_out() {
    let good = Workspace::new().with("good.csv", boom().text());
    good.estimate("good.csv --decisions d.csv").is_whole();
    // With several files a trial is named after its file.
    let expected = good.text("d.csv").replace("boom,1,", "boom,good,");
    for (bad, place) in [
        (String::new(), "bad.csv: the file is empty"),
        (boom().samples(0).text(), "bad.csv: there is a header"),
        (boom().cells(17, 2).text(), "bad.csv, row 17"),
        (boom().cell(17, "boom.output", "x").text(), "bad.csv, row 17, column `boom.output`"),
        (boom().cell(17, "time_s", "0").text(), "bad.csv, row 17"),
    ] {
        let workspace = Workspace::new().with("good.csv", boom().text()).with("bad.csv", bad);
        for files in ["good.csv bad.csv", "bad.csv good.csv", "."] {
            let outcome = workspace.estimate(&format!("{files} --decisions d.csv"));
            outcome.is_partial(1).says(&[place]);
            assert_eq!(workspace.text("d.csv"), expected, "{files}");
            fs::remove_file(workspace.path("d.csv")).unwrap();
        }
    }
    let outcome = good.estimate("good.csv absent.csv");
    outcome.is_partial(1).says(&["absent.csv"]);
}

#[test]
fn steps_of_a_trial_that_is_too_short_are_rejected_beside_good_ones() {
    // The last 4 samples are a trial of their own, and the input changes in it.
    let trial = |k: usize| if k < 296 { "long" } else { "short" }.to_owned();
    let log = Log::of(&["boom", "x"]).renamed("x.input", "trial").without("x.output");
    let log = log.cell(300, "boom.input", "9").cell(301, "boom.input", "9");
    let workspace = Workspace::new().with_log(&log.column("trial", trial));
    let outcome = workspace.estimate("log.csv --decisions steps.csv");
    outcome.is_whole();
    let rows = workspace.text("steps.csv");
    let short: Vec<_> = rows.lines().filter(|row| row.contains(",short,")).collect();
    assert_eq!(short.len(), 1, "{rows}");
    assert!(short[0].contains(",too_short,too_short"), "{rows}");
}
