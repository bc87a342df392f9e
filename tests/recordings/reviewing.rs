//! A person's word on the decisions: the sheet, its way back through `--review`, and the page on
//! which it is said.

use std::collections::BTreeMap;
use std::io::Write as _;
use std::path::Path;
use std::process::Command;

use crate::desk::{Desk, joint};

/// The rows of a table by column.
fn rows(text: &str) -> Vec<BTreeMap<String, String>> {
    let mut reader = csv::Reader::from_reader(text.as_bytes());
    reader.deserialize().map(Result::unwrap).collect()
}

fn estimated(desk: &Desk, arguments: &str) -> serde_json::Value {
    desk.json(&format!("estimate log.csv {arguments}"), 0)
}

/// The review of two steps, one against the program, one with a delay.
fn review(sheet: &str) -> (String, [String; 2]) {
    let accepted: Vec<_> =
        rows(sheet).into_iter().filter(|row| row["program_verdict"] == "accepted").collect();
    let [first, second] = [&accepted[0], &accepted[1]].map(|row| row["i"].clone());
    let text = format!(
        "joint,trial,i,verdict,delay_s,note,reviewer\nboom,1,{first},rejected,,\"a wiggle, no \
         reaction\",Ann\nboom,1,{second},accepted,0.25,,Ann\n"
    );
    (text, [first, second])
}

#[test]
fn doubt_is_the_same_in_the_json_and_in_the_sheet_and_the_text_counts_it() {
    let desk = Desk::with(vec![joint("boom")]);
    let arguments = "--beta 2 --review-sheet sheet.csv";
    let json = estimated(&desk, arguments);
    let decisions = json["joints"][0]["decisions"].as_array().unwrap();
    for row in rows(&desk.read("sheet.csv")) {
        let same = |decision: &&serde_json::Value| decision["i"].as_u64() == row["i"].parse().ok();
        let decision = decisions.iter().find(same).unwrap();
        let rounded = |text: &str| (text.parse::<f64>().unwrap() * 1e3).round();
        assert!((rounded(&row["doubt"]) - rounded(&decision["doubt"].to_string())).abs() < 1.5);
        assert!(decision["flags"].is_array());
    }
    let doubtful = |decision: &&serde_json::Value| {
        let is_flagged = decision["flags"] != serde_json::json!([]);
        decision["doubt"].as_f64().unwrap() >= 0.3
            || is_flagged && decision["verdict"] == "accepted"
    };
    let count = decisions.iter().filter(doubtful).count();
    let output = desk.run(&format!("estimate log.csv {arguments}"));
    let text = String::from_utf8(output.stdout).unwrap();
    let said = format!("{count} of {} decisions", decisions.len());
    assert_eq!(text.contains(&said), count > 0, "{said}: {text}");
    assert_eq!(text.contains("doubtful"), count > 0, "{text}");
}

#[test]
fn a_sheet_lists_all_decisions_the_most_doubtful_first() {
    let desk = Desk::with(vec![joint("boom"), joint("stick")]);
    let json = estimated(&desk, "--review-sheet sheet.csv");
    let text = desk.read("sheet.csv");
    let columns = "joint,trial,i,verdict,delay_s,note,reviewer,";
    assert!(text.starts_with(columns), "{text}");
    let rows = rows(&text);
    let joints = json["joints"].as_array().unwrap();
    let steps: u64 = joints.iter().map(|joint| joint["steps"].as_u64().unwrap()).sum();
    assert_eq!(rows.len() as u64, steps);
    let doubts: Vec<f64> = rows.iter().map(|row| row["doubt"].parse().unwrap()).collect();
    assert!(doubts.is_sorted_by(|a, b| a >= b), "{doubts:?}");
    assert!(rows.iter().all(|row| row["verdict"].is_empty()));
    assert_eq!(rows.last().unwrap()["program_verdict"], "first_or_last", "the surest of all");
}

#[test]
fn a_word_stands_above_the_program_and_is_kept_through_runs() {
    let desk = Desk::with(vec![joint("boom")]);
    let before = estimated(&desk, "--review-sheet sheet.csv --delays before.csv");
    let (text, [first, second]) = review(&desk.read("sheet.csv"));
    desk.write("review.csv", &text);
    let after = estimated(&desk, "--review review.csv --review-sheet again.csv --decisions d.csv");
    let (before, after) = (&before["joints"][0], &after["joints"][0]);
    let accepted = |joint: &serde_json::Value| joint["accepted"].as_u64().unwrap();
    assert_eq!(accepted(after) + 1, accepted(before));
    let counted = serde_json::json!({"accepted": 1, "rejected": 1, "overruled": 1});
    assert_eq!((&before["reviewed"], &after["reviewed"]), (&serde_json::Value::Null, &counted));
    assert_eq!(after["rejected"]["reviewer"], 1);
    let decisions = rows(&desk.read("d.csv"));
    let of = |i: &str| decisions.iter().find(|row| row["i"] == i).unwrap();
    assert_eq!(of(&first)["verdict"], "reviewer");
    assert_eq!(
        (of(&second)["verdict"].as_str(), of(&second)["delta_s"].as_str()),
        ("accepted", "0.25")
    );
    // The sheet of the next run has the words, and they come back the same.
    let again = rows(&desk.read("again.csv"));
    let said: Vec<_> = again.iter().filter(|row| !row["verdict"].is_empty()).collect();
    assert_eq!(said.len(), 2);
    let noted = said.iter().find(|row| row["i"] == first).unwrap();
    assert_eq!(
        (noted["note"].as_str(), noted["reviewer"].as_str()),
        ("a wiggle, no reaction", "Ann")
    );
    let third = estimated(&desk, "--review again.csv");
    assert_eq!(third["joints"][0]["reviewed"], counted);
    let text = desk.run("estimate log.csv --review review.csv").stdout;
    let text = String::from_utf8(text).unwrap();
    let sentence =
        "boom: 2 steps reviewed by a person: 1 accepted, 1 rejected; 1 differing from the program";
    assert!(text.contains(sentence), "{text}");
}

#[test]
fn a_step_that_changed_is_said_and_a_review_that_is_none_names_its_place() {
    let desk = Desk::with(vec![joint("boom")]);
    estimated(&desk, "--review-sheet sheet.csv");
    let sheet = desk.read("sheet.csv").replace(",,,,,", ",accepted,,,Ann,");
    desk.write("review.csv", &sheet);
    let output = desk.run("estimate log.csv --method two-line --review review.csv --beta 2");
    let said = String::from_utf8(output.stderr).unwrap();
    assert!(said.contains("the review still applies"), "{said}");
    let moved = "joint,trial,i,verdict,delay_s,note,reviewer,p\nboom,1,2,rejected,,,Ann,1\n";
    desk.write("moved.csv", moved);
    let output = desk.run("estimate log.csv --review moved.csv");
    let said = String::from_utf8(output.stderr).unwrap();
    assert!(said.contains("the review is ignored, so review the step again"), "{said}");
    desk.write("wrong.csv", "joint,trial,i,verdict,delay_s,note,reviewer\nboom,1,2,maybe,,,\n");
    let output = desk.run("estimate log.csv --review wrong.csv");
    let said = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(2));
    assert!(said.contains("wrong.csv, line 2, column `verdict`: `maybe`"), "{said}");
}

#[test]
fn a_report_has_the_word_beside_what_the_program_says() {
    let desk = Desk::with(vec![joint("boom")]);
    estimated(&desk, "--review-sheet sheet.csv");
    let (text, [first, _]) = review(&desk.read("sheet.csv"));
    desk.write("review.csv", &text);
    let report = "report log.csv -o r.html --no-recording --review review.csv --title Wiggles";
    assert!(desk.run(report).status.success());
    let page = desk.read("r.html");
    let row = page.split("<tr>").find(|row| row.contains("a wiggle")).unwrap();
    let cells = row.split("<td").skip(1).filter_map(|cell| cell.split(['>', '<']).nth(1));
    let cells: Vec<_> = cells.collect();
    assert_eq!(&cells[..4], ["1", first.as_str(), "rejected", "-"]);
    assert_eq!(&cells[5..7], ["Ann", "accepted"]);
    assert!(
        page.contains("<h1>Wiggles</h1>") && page.contains("Most doubtful decisions"),
        "{page}"
    );
}

#[test]
fn the_page_is_one_file_and_needs_no_network() {
    let desk = Desk::with(vec![joint("boom")]);
    desk.run("report log.csv -o r.html --interactive --no-recording");
    let page = desk.read("r_review.html");
    for outside in ["http://", "https://", "src=", "@import", "{style}", "{script}", "{data}"] {
        let found = page.replace("http://www.w3.org/2000/svg", "").contains(outside);
        assert!(!found, "{outside}");
    }
    assert!(page.contains("default-src 'none'"));
}

/// The page in Chromium by keys alone and with the mouse, and what it saves read back.
#[test]
fn a_person_reviews_by_keys_in_a_browser() {
    let Some(python) = with_playwright() else {
        // Not `eprintln`, which the test runner keeps to itself.
        let why = "skipped: no Python with playwright to review in a browser with; name one in \
                   TAUSCOPE_PLAYWRIGHT";
        writeln!(std::io::stderr(), "{why}").unwrap();
        return;
    };
    let desk = Desk::with(vec![joint("boom")]);
    desk.run("report log.csv -o r.html --interactive --no-recording");
    let script =
        Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/recordings/reviewing/by_keys.py");
    let output = Command::new(python)
        .arg(script)
        .arg(desk.folder.path().join("r_review.html"))
        .arg(desk.folder.path().join("saved.csv"))
        .output()
        .unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let saved = rows(&desk.read("saved.csv"));
    let verdicts: Vec<_> = saved.iter().map(|row| row["verdict"].as_str()).collect();
    assert_eq!(verdicts, ["rejected", "accepted", "accepted"]);
    assert_eq!(saved[0]["note"], "a \"wiggle\", no reaction");
    assert!(saved.iter().all(|row| row["reviewer"] == "Ann"));
    let output = desk.run("estimate log.csv --review saved.csv --format json");
    // Notes on the method are not on what was saved.
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(said.lines().all(|line| line.is_empty() || line.starts_with("note: ")), "{said}");
    let json: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    let counted = &json["joints"][0]["reviewed"];
    assert_eq!((&counted["accepted"], &counted["rejected"]), (&2.into(), &1.into()));
}

/// A Python that has playwright.
fn with_playwright() -> Option<String> {
    let named = std::env::var("TAUSCOPE_PLAYWRIGHT").ok();
    let python = named.unwrap_or_else(|| "python3".to_owned());
    let output = Command::new(&python).args(["-c", "import playwright"]).output().ok()?;
    output.status.success().then_some(python)
}
