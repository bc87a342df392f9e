//! Bad input: what the program says, how it exits and what it leaves behind.
#![expect(clippy::unwrap_used, reason = "a test may fail loudly")]

use std::collections::BTreeMap;
use std::fs;
use std::path::PathBuf;
use std::process::Command;

use serde_json::Value;
use tempfile::TempDir;

/// Words of which a message needs one to say what to do.
const REMEDIES: [&str; 12] = [
    "`--", "remove", "rename", "mend", "correct", "give", "mark", "choose", "check", "write",
    "expected", "needs",
];

/// A log at 100 Hz whose joints step every 60 samples and follow 15 samples later.
///
/// Lines are counted as an editor does: the header is line 1.
#[derive(Clone)]
struct Log {
    lines: Vec<Vec<String>>,
}

impl Log {
    fn of(joints: &[&str]) -> Self {
        let mut header = vec!["time_s".to_owned()];
        header.extend(joints.iter().flat_map(|j| [format!("{j}.input"), format!("{j}.output")]));
        let mut lines = vec![header];
        let mut angles = vec![0.0; joints.len()];
        for k in 0..300_u32 {
            let mut cells = vec![seconds(f64::from(k) * 0.01)];
            for (angle, gain) in angles.iter_mut().zip(1_u32..) {
                *angle += 0.1 * f64::from(gain) * level(k.saturating_sub(15));
                cells.extend([level(k).to_string(), format!("{angle:.3}")]);
            }
            lines.push(cells);
        }
        Self { lines }
    }

    fn samples(mut self, count: usize) -> Self {
        self.lines.truncate(count + 1);
        self
    }

    fn cell(mut self, line: usize, column: &str, text: &str) -> Self {
        let place = self.place(column);
        text.clone_into(&mut self.lines[line - 1][place]);
        self
    }

    fn column(mut self, column: &str, value: impl Fn(usize) -> String) -> Self {
        let place = self.place(column);
        for (k, cells) in self.lines.iter_mut().skip(1).enumerate() {
            cells[place] = value(k);
        }
        self
    }

    fn without(mut self, column: &str) -> Self {
        let place = self.place(column);
        for cells in &mut self.lines {
            cells.remove(place);
        }
        self
    }

    fn renamed(self, from: &str, to: &str) -> Self {
        self.cell(1, from, to)
    }

    fn cells(mut self, line: usize, count: usize) -> Self {
        self.lines[line - 1].resize(count, "0".to_owned());
        self
    }

    fn place(&self, column: &str) -> usize {
        self.lines[0].iter().position(|name| name == column).unwrap()
    }

    fn text(&self) -> String {
        self.lines.iter().map(|cells| cells.join(",") + "\n").collect()
    }
}

fn level(sample: u32) -> f64 {
    [0.0, 1.0, -1.0, 0.5][(sample + 30) as usize / 60 % 4]
}

fn seconds(time: f64) -> String {
    format!("{time:.4}")
}

/// A folder of its own, in which the program runs.
struct Workspace {
    folder: TempDir,
}

impl Workspace {
    fn new() -> Self {
        Self { folder: tempfile::tempdir().unwrap() }
    }

    fn with(self, name: &str, text: impl AsRef<[u8]>) -> Self {
        fs::write(self.path(name), text).unwrap();
        self
    }

    fn with_log(self, log: &Log) -> Self {
        self.with("log.csv", log.text())
    }

    fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    fn text(&self, name: &str) -> String {
        fs::read_to_string(self.path(name)).unwrap()
    }

    /// Every file with its bytes.
    fn files(&self) -> BTreeMap<PathBuf, Vec<u8>> {
        let paths = fs::read_dir(self.folder.path()).unwrap().map(|entry| entry.unwrap().path());
        paths.filter(|path| path.is_file()).map(|p| (p.clone(), fs::read(p).unwrap())).collect()
    }

    /// Runs `tauscope estimate` with `arguments`, split at spaces.
    fn estimate(&self, arguments: &str) -> Outcome {
        let before = self.files();
        let ran = Command::new(env!("CARGO_BIN_EXE_tauscope"))
            .arg("estimate")
            .args(arguments.split_whitespace())
            .current_dir(self.folder.path())
            .output()
            .unwrap();
        let text = |bytes| String::from_utf8(bytes).unwrap();
        let outcome = Outcome {
            status: ran.status.code(),
            stdout: text(ran.stdout),
            stderr: text(ran.stderr),
            unchanged: self.files() == before,
        };
        assert!(!outcome.stderr.contains("panicked"), "{}", outcome.stderr);
        let left_over = |path: &PathBuf| path.to_string_lossy().contains(".part");
        assert!(!self.files().keys().any(left_over), "a temporary file is left over");
        outcome
    }
}

/// What a run of the program gave.
#[derive(Debug)]
struct Outcome {
    status: Option<i32>,
    stdout: String,
    stderr: String,
    /// No file came, went or changed.
    unchanged: bool,
}

impl Outcome {
    /// Nothing usable: status 2, one error, no result, no file.
    fn is_refused(&self) -> &Self {
        assert_eq!((self.status, self.lines("error: ")), (Some(2), 1), "{self:#?}");
        assert_eq!(self.stdout, "");
        assert!(self.unchanged, "{self:#?}");
        self
    }

    /// Something failed, the rest is there: status 1, `count` warnings, no error.
    fn is_partial(&self, count: usize) -> &Self {
        let found = (self.status, self.lines("error: "), self.lines("warning: "));
        assert_eq!(found, (Some(1), 0, count), "{self:#?}");
        self
    }

    fn is_whole(&self) -> &Self {
        let found = (self.status, self.lines("error: "), self.lines("warning: "));
        assert_eq!(found, (Some(0), 0, 0), "{self:#?}");
        self
    }

    fn says(&self, parts: &[&str]) -> &Self {
        for part in parts {
            assert!(self.stderr.contains(part), "no `{part}` in: {}", self.stderr);
        }
        self
    }

    fn says_what_to_do(&self) {
        let says = REMEDIES.iter().any(|word| self.stderr.contains(word));
        assert!(says, "no remedy in: {}", self.stderr);
    }

    fn lines(&self, start: &str) -> usize {
        self.stderr.lines().filter(|line| line.starts_with(start)).count()
    }

    fn joints(&self) -> Vec<Value> {
        let json: Value = serde_json::from_str(&self.stdout).unwrap();
        json["joints"].as_array().unwrap().clone()
    }
}

fn boom() -> Log {
    Log::of(&["boom"])
}

#[test]
fn the_log_of_these_tests_is_good() {
    let outcome = Workspace::new().with_log(&boom()).estimate("log.csv --format json");
    outcome.is_whole();
    assert_eq!(outcome.joints()[0]["accepted"], 3, "{}", outcome.stdout);
    assert_eq!(outcome.stderr, "");
}

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
        "`--time COLUMN`",
        "`--sample-period SECONDS`",
    ]);
}

#[test]
fn a_log_without_joints_is_refused_with_its_columns() {
    let log = boom().renamed("boom.input", "left").renamed("boom.output", "right");
    let says = ["log.csv", "row 1", "no joint", "time_s, left, right", "`--joint NAME="];
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
    assert!(outcome.stderr.contains("interpolated, the input held"), "{}", outcome.stderr);
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
fn settings_out_of_range_are_refused_with_their_name() {
    let workspace = Workspace::new().with_log(&boom());
    for (setting, name) in [
        ("--alpha 0", "--alpha"),
        ("--beta 0", "--beta"),
        ("--beta 2.5", "--beta"),
        ("--beta 99999999999999999999", "--beta"),
        ("--passband 0", "--passband"),
        ("--passband=-1", "--passband"),
        ("--passband fast", "--passband"),
        ("--passband 50", "--passband"),
        ("--passband 51", "--passband"),
        ("--passband inf", "--passband"),
        ("--filter-order 0", "--filter-order"),
        ("--output-limits 40,-40", "--output-limits"),
        ("--output-limits 40,40", "--output-limits"),
        ("--output-limits 40", "--output-limits"),
        ("--output-limits NaN,40", "--output-limits"),
        ("--min-slope-change=-1", "--min-slope-change"),
        ("--max-sse NaN", "--max-sse"),
        ("--min-step x", "--min-step"),
        ("--threads 0", "--threads"),
        ("--resample 0", "--resample"),
        ("--fill=-1", "--fill"),
        ("--sample-period 0", "--sample-period"),
    ] {
        workspace.estimate(&format!("log.csv {setting}")).is_refused().says(&[name]);
    }
}

#[test]
fn a_row_of_more_samples_than_can_be_counted_is_refused() {
    let outcome = Workspace::new().with_log(&boom()).estimate("log.csv --beta 9223372036854775808");
    outcome.is_refused().says(&["`--beta`"]);
}

#[test]
fn a_negative_number_is_refused_with_the_name_of_its_option() {
    let workspace = Workspace::new().with_log(&boom());
    for name in ["--alpha", "--beta", "--passband", "--min-slope-change", "--fill", "--resample"] {
        workspace.estimate(&format!("log.csv {name} -1")).is_refused().says(&[name]);
    }
}

#[test]
fn a_grid_of_more_samples_than_can_be_counted_is_refused() {
    let outcome = Workspace::new().with_log(&boom()).estimate("log.csv --resample 1e-9");
    outcome.is_refused().says(&["log.csv", "resample"]);
}

#[test]
fn a_smoothing_that_cannot_be_designed_is_refused() {
    let workspace = Workspace::new().with_log(&boom());
    for setting in ["--passband 1e-320", "--passband 1e-9"] {
        workspace.estimate(&format!("log.csv {setting}")).is_refused().says(&["passband"]);
    }
}

#[test]
fn signals_whose_squares_are_no_numbers_are_refused() {
    let good = boom();
    for (signal, column) in [("boom.input", 1), ("boom.output", 2)] {
        let value = |k: usize| good.lines[k + 1][column].clone();
        for exponent in ["e300", "e200", "e-200", "e-300"] {
            let log = boom().column(signal, |k| value(k) + exponent);
            let outcome = Workspace::new().with_log(&log).estimate("log.csv --format json");
            outcome.is_refused().says(&["log.csv", signal, "what double precision can square"]);
        }
        let small = boom().column(signal, |k| value(k) + "e-70");
        let outcome = Workspace::new().with_log(&small).estimate("log.csv --format json");
        assert_eq!(outcome.joints()[0]["accepted"], 3, "{}", outcome.stdout);
    }
}

#[test]
fn a_filter_order_that_is_too_high_is_refused_with_its_name() {
    let outcome = Workspace::new().with_log(&boom()).estimate("log.csv --filter-order 13");
    outcome.is_refused().says(&["filter order", "13", "12"]);
}

#[test]
fn a_smoothing_that_the_log_is_too_slow_for_says_what_it_allows() {
    let outcome = Workspace::new().with_log(&boom()).estimate("log.csv --passband 50");
    outcome.is_refused().says(&["50 Hz", "Nyquist", "`--passband none`"]);
}

#[test]
fn an_output_folder_that_is_missing_is_named() {
    let workspace = Workspace::new().with_log(&boom());
    for option in ["--decisions", "--delays", "-o"] {
        let outcome = workspace.estimate(&format!("log.csv {option} absent/out.csv"));
        outcome.is_refused().says(&["absent"]);
    }
}

#[test]
fn an_output_below_a_file_or_on_a_folder_is_refused() {
    let workspace = Workspace::new().with_log(&boom());
    workspace
        .estimate("log.csv --decisions log.csv/out.csv")
        .is_refused()
        .says(&["log.csv/out.csv"]);
    fs::create_dir(workspace.path("folder")).unwrap();
    workspace.estimate("log.csv --decisions folder").is_refused().says(&["folder"]);
}

#[cfg(unix)]
#[test]
fn an_output_folder_that_cannot_be_written_to_is_named() {
    use std::os::unix::fs::PermissionsExt as _;

    let workspace = Workspace::new().with_log(&boom());
    let locked = workspace.path("locked");
    fs::create_dir(&locked).unwrap();
    fs::set_permissions(&locked, fs::Permissions::from_mode(0o555)).unwrap();
    if fs::write(locked.join("probe"), "").is_ok() {
        // Not `eprintln`, which the test runner keeps to itself.
        let mut terminal = std::io::stderr();
        std::io::Write::write_all(&mut terminal, b"skipped: this user may write to every folder\n")
            .unwrap();
        return;
    }
    workspace.estimate("log.csv --decisions locked/out.csv").is_refused().says(&["locked/out.csv"]);
}

#[cfg(target_os = "linux")]
#[test]
fn a_full_disk_is_told_with_the_name_of_the_file() {
    let workspace = Workspace::new().with_log(&boom());
    for option in ["--decisions", "--delays"] {
        let outcome = workspace.estimate(&format!("log.csv {option} /dev/full"));
        outcome.is_refused().says(&["No space left", "/dev/full"]);
    }
}

#[cfg(target_os = "linux")]
#[test]
fn a_full_disk_leaves_the_other_output_as_it_was_or_whole() {
    for other in ["--delays", "--decisions"] {
        let full = if other == "--delays" { "--decisions" } else { "--delays" };
        let workspace = Workspace::new().with_log(&boom()).with("old.csv", "old");
        let whole = Workspace::new().with_log(&boom());
        whole.estimate(&format!("log.csv {other} new.csv")).is_whole();
        let outcome = workspace.estimate(&format!("log.csv {full} /dev/full {other} old.csv"));
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
