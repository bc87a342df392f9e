//! `tauscope report` as a user sees it.

use std::fmt::Write as _;
use std::io::Write as _;
use std::path::Path;
use std::process::Command;

use crate::desk::{Desk, assert_fields, banded, joint, number};
use scraper::{ElementRef, Html, Selector};
use serde_json::Value;

fn select(css: &str) -> Selector {
    Selector::parse(css).unwrap()
}

fn words(element: ElementRef<'_>) -> String {
    element.text().collect::<String>().split_whitespace().collect::<Vec<_>>().join(" ")
}

/// The page, which is as HTML has it.
fn parsed(page: &str) -> Html {
    let html = Html::parse_document(page);
    assert!(html.errors.is_empty(), "{:?}", html.errors);
    html
}

/// Asserts that nothing is fetched: links lead into the page, and drawings stand in it.
fn assert_stands_alone(html: &Html) {
    for element in html.select(&select("*")) {
        let name = element.value().name();
        assert!(!["script", "img", "iframe", "object", "embed"].contains(&name), "{name}");
        for attribute in ["href", "src", "srcset", "xlink:href", "data"] {
            let link = element.value().attr(attribute).unwrap_or("#");
            assert!(link.starts_with('#') || link.starts_with("data:"), "{name} loads {link}");
        }
    }
    let styles: String = html.select(&select("style")).map(words).collect();
    assert!(!styles.contains("url(") && !styles.contains("@import"));
}

/// The rows of the table of decisions of each joint.
fn decision_rows(html: &Html) -> Vec<Vec<String>> {
    let in_details = select("details table");
    let tables = html.select(&in_details);
    let header =
        |table: &ElementRef<'_>| table.select(&select("th")).map(words).collect::<Vec<_>>();
    let of_decisions = tables.filter(|table| header(table).contains(&"verdict".to_owned()));
    let rows = of_decisions.flat_map(|table| table.select(&select("tbody tr")).collect::<Vec<_>>());
    rows.map(|row| row.select(&select("td")).map(words).collect()).collect()
}

#[test]
fn the_page_has_the_numbers_of_the_estimate() {
    let desk = Desk::with(vec![banded("boom"), joint("arm")]);
    assert!(desk.run("report log.csv -o report.html").status.success());
    let page = parsed(&desk.read("report.html"));
    assert_stands_alone(&page);
    let estimate = desk.json("estimate log.csv", 0);
    let sentences: Vec<String> = page.select(&select("ul.contents li")).map(words).collect();
    let mut rows = decision_rows(&page).into_iter();
    for (joint, sentence) in estimate["joints"].as_array().unwrap().iter().zip(&sentences) {
        let delay = |part: &str| format!("{:.3}", number(&joint["delay_s"][part]));
        let (steps, accepted) = (&joint["steps"], &joint["accepted"]);
        let (median, min, max) = (delay("median"), delay("min"), delay("max"));
        let name = joint["joint"].as_str().unwrap();
        let said = format!(
            "{name} Delay {median} s (median; {min} to {max} s); {accepted} of {steps} steps"
        );
        assert!(sentence.starts_with(&said), "`{said}` in `{sentence}`");
        for decision in joint["decisions"].as_array().unwrap() {
            assert_is_row_of(&rows.next().unwrap(), decision);
        }
    }
    assert_eq!((rows.next(), sentences.len()), (None, 2));
    let text = words(page.root_element());
    let source = &estimate["sources"][0];
    for part in [source["sha256"].as_str().unwrap(), "tauscope report log.csv -o report.html"] {
        assert!(text.contains(part), "no {part}");
    }
}

/// A row of the table says what the JSON says, numbers to five digits.
fn assert_is_row_of(row: &[String], decision: &Value) {
    let keys = ["trial", "i", "p", "r", "end", "q", "delta", "delta_s"];
    for (cell, key) in row.iter().zip(keys) {
        let value = &decision[key];
        match (value.as_f64(), value.as_str()) {
            (Some(value), _) => {
                let shown: f64 = cell.parse().unwrap();
                assert!((shown - value).abs() <= 1e-4 * value.abs(), "{key}: {shown} for {value}");
            }
            (None, Some(text)) => assert_eq!(cell, text),
            (None, None) => assert_eq!(cell, "-"),
        }
    }
    assert!(row.iter().any(|cell| Some(cell.as_str()) == decision["verdict"].as_str()));
}

#[test]
fn a_design_is_shown_on_a_page_with_what_is_expected() {
    let desk = Desk::with(vec![banded("boom")]);
    let options = "design log.csv --separate dead_band,flow_curve --rehearsals 4 --power 0.9";
    let json = desk.json(&format!("{options} --preview next.html -q"), 0);
    let page = parsed(&desk.read("next.html"));
    assert_stands_alone(&page);
    let drawn: Vec<String> = page.select(&select("svg desc")).map(words).collect();
    let [drawn] = drawn.as_slice() else { panic!("{drawn:?}") };
    for part in ["Plot 1 of 2: Input", "dead_band, flow_curve and range"] {
        assert!(drawn.contains(part), "no `{part}` in {drawn}");
    }
    let rows = page.select(&select("details tbody tr")).count();
    assert_eq!(rows, json["joints"][0]["holds"].as_array().unwrap().len());
    let text = words(page.root_element());
    assert!(["rehearsed", "λ", "explain"].iter().all(|part| text.contains(part)), "{text}");
}

#[test]
fn a_model_is_reported_with_its_ladder() {
    let desk = Desk::with(vec![banded("boom")]);
    let run = "report log.csv --improve --effects dead_band,actuator_lag -o report.html";
    let json = desk.json(run, 0);
    assert_eq!(json["schema"], "tauscope/report/1");
    assert_fields(&json, "schema version report recording joints failures");
    let sentence = json["joints"][0]["sentence"].as_str().unwrap();
    assert!(sentence.contains("dead_band explains"), "{sentence}");
    assert!(sentence.contains("nothing more is missing. Delay "), "{sentence}");
    assert!(!desk.has("model.toml"), "a report changes no model");
    let page = parsed(&desk.read("report.html"));
    let text = words(page.root_element());
    assert_eq!(text.matches(sentence).count(), 1, "each fact is said once: {sentence}");
    let improve = desk.json(
        &run.replace("report log.csv --improve", "improve log.csv --write m.toml")
            .replace(" -o report.html", ""),
        0,
    );
    for revision in improve["joints"][0]["revisions"].as_array().unwrap() {
        let error = number(&revision["error"]["validation"]["rmse"]);
        let shown = format!("{} deg", tauscope::wording::number(error));
        assert!(text.contains(&shown), "no {shown}");
    }
    let headings: Vec<String> = page.select(&select("h3")).map(words).collect();
    for part in ["Model", "Errors", "Measured and simulated", "Where the error of revision 0 arose"]
    {
        assert!(headings.iter().any(|heading| heading == part), "no {part} in {headings:?}");
    }
    for part in ["dead_band, on the delayed input: out = max(in", "[joint.boom]", "1: + dead_band"]
    {
        assert!(text.contains(part), "no {part}");
    }
}

#[test]
fn a_model_that_improve_made_is_reported_from_its_file() {
    let desk = Desk::with(vec![banded("boom")]);
    desk.run("improve log.csv --write boom.toml --quiet --effects dead_band,actuator_lag");
    let of_report = |file: &str| {
        let json = desk.json(&format!("report log.csv --model {file} -o given.html"), 0);
        let sentence = json["joints"][0]["sentence"].as_str().unwrap().to_owned();
        (sentence, words(parsed(&desk.read("given.html")).root_element()))
    };
    let (sentence, page) = of_report("boom.toml");
    assert!(sentence.contains("dead_band explains"), "{sentence}");
    for part in ["0: integrator", "1: + dead_band", "as it is in its file"] {
        assert!(page.contains(part), "no {part}");
    }
    assert!(!page.contains("Effects that were tried"), "something was fitted");

    // With another value it is not the model whose errors the file knows.
    let text = desk.read("boom.toml");
    let (before, gain) = text.split_once("gain = ").unwrap();
    let (_, behind) = gain.split_once(',').unwrap();
    desk.write("other.toml", &format!("{before}gain = 5.0,{behind}"));
    let (sentence, page) = of_report("other.toml");
    assert!(sentence.contains("dead_band explains"), "{sentence}");
    assert!(!page.contains("as it is in its file"), "it was to be fitted");
}

#[test]
fn names_are_text_and_never_markup() {
    let name = "<b>&\"boom\"</b>|*`";
    let desk = Desk::with(vec![joint("boom")]);
    let log = desk.read("log.csv");
    let header = log.lines().find(|line| line.contains("boom.input")).unwrap();
    let quoted =
        |column: &str| format!("\"{}\"", column.replace("boom", name).replace('"', "\"\""));
    let renamed: Vec<String> = header.split(',').map(quoted).collect();
    desk.write("odd.csv", &log.replacen(header, &renamed.join(","), 1));
    assert!(desk.run("report odd.csv -o odd.html").status.success());
    let page = parsed(&desk.read("odd.html"));
    assert_eq!(page.select(&select("h2")).map(words).next().unwrap(), name);
    assert_eq!(page.select(&select("b")).count(), 0);
}

#[test]
fn the_same_input_gives_the_same_bytes() {
    let desk = Desk::with(vec![banded("boom"), joint("arm")]);
    let made = |threads: &str| {
        let effects = "--effects dead_band,actuator_lag --no-recording";
        let run = format!("report log.csv --improve {effects} -o same.html --threads {threads}");
        assert!(desk.run(&run).status.success());
        desk.read("same.html")
    };
    assert_eq!(made("1"), made("3"));
}

#[test]
fn a_long_record_makes_a_small_page() {
    let desk = Desk::with(vec![joint("boom")]);
    let mut log = "time_s,boom.input [V],boom.output [deg]\n".to_owned();
    let mut output = 0.0;
    for k in 0..100_000_u32 {
        // A level for each second or so, from a fixed sequence.
        let level = f64::from((k / 130).wrapping_mul(2_654_435_761) >> 29) - 3.5;
        output = 0.9995 * output + 0.01 * level;
        let noise = f64::from(k.wrapping_mul(2_246_822_519) >> 22) / 1024.0;
        let time_s = f64::from(k) / 100.0;
        writeln!(log, "{time_s:.2},{level},{:.4}", output + 0.02 * noise).unwrap();
    }
    desk.write("long.csv", &log);
    assert!(desk.run("report long.csv --no-recording -o long.html").status.success());
    let bytes = desk.read("long.html").len();
    assert!(bytes < 2_000_000, "{bytes} bytes");
}

#[test]
fn what_cannot_be_done_is_refused() {
    let desk = Desk::with(vec![joint("boom")]);
    for (arguments, part) in [
        ("report log.csv", "--output"),
        ("report log.csv -o report.pdf", "called FILE.html"),
        ("report log.csv -o missing/report.html", "missing/report.html: cannot be written"),
        ("report none.csv -o report.html", "none.csv"),
        ("report log.csv -o report.html --model none.toml", "none.toml"),
        ("report log.csv -o report.html --improve --effects stictoin", "`stiction`"),
        ("report log.csv -o report.html --method hinge --method two-line", "only one method"),
    ] {
        let refused = desk.refusal(arguments);
        assert!(refused.contains(part), "{arguments}: {refused}");
    }
    assert!(!desk.has("report.html"));
}

#[test]
fn what_failed_is_told_on_the_page() {
    let desk = Desk::with(vec![joint("boom")]).with_broken_joint();
    assert_eq!(desk.run("report log.csv --no-recording -o report.html").status.code(), Some(1));
    let page = parsed(&desk.read("report.html"));
    assert!(words(page.root_element()).contains("joint broken is left out"));
}

/// A browser that needs no screen, where there is one.
fn browser() -> Option<&'static str> {
    let known = ["chromium", "chromium-browser", "google-chrome"];
    let answers = |name: &&str| Command::new(name).arg("--version").output().is_ok();
    known.into_iter().find(answers)
}

/// What a browser makes of a page, and what it complains of.
fn shown(browser: &str, page: &Path, profile: &Path, arguments: &[&str]) -> (String, String) {
    let mut command = Command::new(browser);
    let quiet = "--headless --no-sandbox --disable-gpu --disable-quic --no-first-run \
                 --disable-background-networking --disable-component-update --disable-sync \
                 --enable-logging=stderr --log-level=0 --virtual-time-budget=2000";
    command.args(quiet.split_whitespace()).args(arguments);
    command.arg(format!("--user-data-dir={}", profile.display()));
    let output = command.arg(format!("file://{}", page.display())).output().unwrap();
    let text = |bytes: Vec<u8>| String::from_utf8_lossy(&bytes).into_owned();
    (text(output.stdout), text(output.stderr))
}

#[test]
fn a_browser_has_nothing_to_complain_of() {
    let Some(browser) = browser() else {
        // Not `eprintln`, which the test runner keeps to itself.
        let mut stderr = std::io::stderr();
        writeln!(stderr, "skipped: there is no chromium here to look at a page with").unwrap();
        return;
    };
    let desk = Desk::with(vec![banded("boom")]);
    assert!(
        desk.run("report log.csv --improve --effects dead_band --no-recording -o r.html")
            .status
            .success()
    );
    let (page, profile) = (desk.folder.path().join("r.html"), desk.folder.path().join("profile"));
    let (dom, complaints) = shown(browser, &page, &profile, &["--dump-dom"]);
    assert!(dom.contains("Models and delays in log.csv") && dom.contains("</svg>"), "{complaints}");
    assert!(!complaints.contains("CONSOLE"), "{complaints}");

    // The check can fail: a page that complains is heard.
    desk.write("bad.html", "<!DOCTYPE html><title>x</title><script>console.error('oh')</script>");
    let bad = desk.folder.path().join("bad.html");
    let (_, complaints) = shown(browser, &bad, &profile, &["--dump-dom"]);
    assert!(complaints.contains("CONSOLE"), "{complaints}");
}

#[cfg(not(feature = "rrd"))]
#[test]
fn without_recordings_there_is_none_beside_the_page() {
    let desk = Desk::with(vec![joint("boom")]);
    assert!(desk.run("report log.csv -o report.html").status.success());
    assert!(!desk.has("report.rrd") && !desk.read("report.html").contains("rerun"));
}
