//! Files that cannot be written, and those that must stay as they are.

use std::fs;

use super::workspace::{Workspace, boom};

#[test]
fn an_output_folder_that_is_missing_is_named() {
    let workspace = Workspace::new().with_log(&boom());
    for option in ["--decisions", "--delays", "-o"] {
        let outcome = workspace.estimate(&format!("log.csv {option} absent/out.csv"));
        outcome.is_refused().says(&["absent"]);
    }
}

#[test]
fn an_output_on_a_folder_is_refused() {
    let workspace = Workspace::new().with_log(&boom());
    fs::create_dir(workspace.path("folder")).unwrap();
    workspace.estimate("log.csv --decisions folder").is_refused().says(&["folder"]);
}

#[cfg(target_os = "linux")]
#[test]
fn a_full_device_is_named_and_leaves_the_other_output_as_it_was_or_whole() {
    for (full, other) in [("--decisions", "--delays"), ("--delays", "--decisions")] {
        let workspace = Workspace::new().with_log(&boom()).with("old.csv", "old");
        let full = format!("log.csv {full} /dev/full");
        workspace.estimate(&full).is_refused().says(&["No space left", "/dev/full"]);
        let whole = Workspace::new().with_log(&boom());
        whole.estimate(&format!("log.csv {other} new.csv")).is_whole();
        let outcome = workspace.estimate(&format!("{full} {other} old.csv"));
        assert_eq!(outcome.status, Some(2), "{outcome:#?}");
        let found = workspace.text("old.csv");
        assert!(found == "old" || found == whole.text("new.csv"), "{found}");
    }
}

#[test]
fn an_output_that_exists_stands_when_the_run_fails() {
    let bad = boom().cell(200, "boom.output", "x");
    let workspace =
        Workspace::new().with_log(&bad).with("d.csv", "old decisions").with("t.csv", "old");
    for arguments in [
        "log.csv --decisions d.csv --delays t.csv",
        "absent.csv --decisions d.csv --delays t.csv",
        "log.csv --decisions d.csv --delays absent/t.csv",
        "log.csv --beta 0 --decisions d.csv --delays t.csv",
    ] {
        workspace.estimate(arguments).is_refused();
    }
    let outcome = workspace.with_log(&boom());
    outcome.estimate("log.csv --passband 60 --decisions d.csv --delays t.csv").is_refused();
}

#[test]
fn an_output_that_exists_is_replaced_when_the_new_one_is_whole() {
    let workspace = Workspace::new().with_log(&boom()).with("d.csv", "old\n".repeat(9999));
    workspace.estimate("log.csv --decisions d.csv").is_whole();
    let found = workspace.text("d.csv");
    assert!(found.starts_with("joint,trial,i,p,"), "{found}");
    assert!(!found.contains("old"));
}

#[test]
fn an_output_never_replaces_the_log_it_is_made_from() {
    let workspace = Workspace::new().with_log(&boom());
    for option in ["--decisions", "--delays"] {
        workspace.estimate(&format!("log.csv {option} ./log.csv")).is_refused().says(&["log.csv"]);
    }
}

#[test]
fn two_outputs_of_one_name_are_refused() {
    let workspace = Workspace::new().with_log(&boom());
    workspace.estimate("log.csv --decisions a.csv --delays a.csv").is_refused().says(&["a.csv"]);
}
