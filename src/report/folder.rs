//! The results of many logs, each by itself, in one table, and schema `tauscope/folder/1`.

use serde_json::{Map, Value, json};

use super::decisions::decision_columns;
use super::json::document;
use super::{DataTable, DelayRange, Kind, TextTable};
use crate::wording::counted;

/// The result of one log: the document that the command prints as JSON.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct LogResult {
    /// The log, as it was given.
    pub(crate) file: String,
    /// The document, schema `tauscope/estimate/1` or `tauscope/improve/1`.
    pub(crate) document: Value,
}

/// The results of many logs, in the order of the logs' names.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct FolderReport {
    pub(super) command: String,
    pub(super) logs: Vec<LogResult>,
}

impl FolderReport {
    /// Brings the results of `command` together.
    pub(crate) fn new(command: &str, mut logs: Vec<LogResult>) -> Self {
        logs.sort_by(|a, b| a.file.cmp(&b.file));
        Self { command: command.to_owned(), logs }
    }

    /// Whether there is no result at all.
    pub(crate) fn is_empty(&self) -> bool {
        self.logs.is_empty()
    }

    /// What failed in the logs that have a result.
    pub(crate) fn failures(&self) -> impl Iterator<Item = String> {
        let of = |log: &LogResult| {
            let failures = texts(&log.document, "failures");
            let name = |failure: String| {
                if failure.contains(&log.file) {
                    failure
                } else {
                    format!("{}: {failure}", log.file)
                }
            };
            failures.into_iter().map(name).collect::<Vec<_>>()
        };
        self.logs.iter().flat_map(of)
    }

    /// The joints of all logs, each with its log.
    fn joints(&self) -> impl Iterator<Item = (&LogResult, &Value)> {
        self.logs
            .iter()
            .flat_map(|log| array(&log.document, "joints").map(move |joint| (log, joint)))
    }

    /// The decisions of all logs: the columns of `--decisions` after one for the log.
    pub(crate) fn decisions(&self) -> DataTable {
        let all_runs = self.logs.iter().flat_map(runs);
        let methods = all_runs.map(|run| run.pointer("/settings/method").and_then(Value::as_str));
        let columns = decision_columns(methods.map(Option::unwrap_or_default));
        let mut table = DataTable::new([("file", Kind::Text)].into_iter().chain(columns));
        for log in &self.logs {
            let joints = runs(log).flat_map(|run| array(run, "joints"));
            for decision in joints.flat_map(|joint| array(joint, "decisions")) {
                let mut row = decision.as_object().cloned().unwrap_or_default();
                row.insert("file".to_owned(), log.file.clone().into());
                table.push(&row);
            }
        }
        table
    }

    /// A row per log and joint.
    pub(crate) fn summary(&self) -> DataTable {
        let columns = self.summary_columns().iter().map(|(name, kind, _)| (*name, *kind));
        let mut table = DataTable::new(columns);
        for row in self.summary_rows() {
            table.push(&row);
        }
        table
    }

    /// Columns of [`Self::summary`], and where in the JSON of a joint each stands.
    fn summary_columns(&self) -> &'static [SummaryColumn] {
        if self.command == "improve" { &IMPROVED } else { &ESTIMATED }
    }

    pub(super) fn summary_rows(&self) -> impl Iterator<Item = Map<String, Value>> {
        let row = |(log, joint): (&LogResult, &Value)| {
            let cell = |(name, _, place): &SummaryColumn| {
                let value = match *name {
                    "file" => log.file.clone().into(),
                    "effects" => texts(joint, "effects").join(" ").into(),
                    _ => joint.pointer(place).cloned().unwrap_or_default(),
                };
                ((*name).to_owned(), value)
            };
            self.summary_columns().iter().map(cell).collect()
        };
        self.joints().map(row)
    }

    /// What each joint has in all its logs.
    fn across(&self) -> Vec<Value> {
        let name = |joint: &Value| {
            joint.get("joint").and_then(Value::as_str).unwrap_or_default().to_owned()
        };
        let mut joints: Vec<(String, Vec<&Value>)> = Vec::new();
        for (_, joint) in self.joints() {
            let name = name(joint);
            match joints.iter_mut().find(|(known, _)| *known == name) {
                Some((_, logs)) => logs.push(joint),
                None => joints.push((name, vec![joint])),
            }
        }
        joints.iter().map(|(name, logs)| across(name, logs)).collect()
    }

    /// A table of the joints across all logs.
    pub(crate) fn text(&self) -> String {
        let joints = self.across();
        let columns = if self.command == "improve" { IMPROVED_TEXT } else { ESTIMATED_TEXT };
        let row = |joint: &Value| columns.map(|(_, place)| cell(joint.pointer(place)));
        let header = columns.map(|(name, _)| name);
        let table = TextTable::of(header, &[1, 2, 3, 4, 5, 6], joints.iter().map(row));
        format!("{table}\n{}, each by itself\n", counted(self.logs.len(), "log"))
    }
}

/// The columns of [`FolderReport::text`], and where each stands in what a joint has in all its logs.
const ESTIMATED_TEXT: [(&str, &str); 7] = [
    ("joint", "/joint"),
    ("logs", "/logs"),
    ("steps", "/steps"),
    ("accepted", "/accepted"),
    ("delay min [s]", "/delay_s/min"),
    ("median", "/delay_s/median"),
    ("max", "/delay_s/max"),
];

const IMPROVED_TEXT: [(&str, &str); 7] = [
    ("joint", "/joint"),
    ("logs", "/logs"),
    ("adequate", "/adequate"),
    ("validation rmse min", "/validation_rmse/min"),
    ("median", "/validation_rmse/median"),
    ("max", "/validation_rmse/max"),
    ("effects (logs)", "/effects"),
];

/// A text, a count, a number to three decimals, or how many logs have each effect.
fn cell(value: Option<&Value>) -> String {
    match value {
        Some(Value::String(text)) => text.clone(),
        Some(Value::Object(counts)) => {
            let counts = counts.iter().map(|(id, count)| format!("{id} ({count})"));
            counts.collect::<Vec<_>>().join(", ")
        }
        Some(Value::Number(number)) if !number.is_f64() => number.to_string(),
        Some(Value::Number(number)) => format!("{:.3}", number.as_f64().unwrap_or(f64::NAN)),
        _ => "-".to_owned(),
    }
}

/// Name and kind of a column, and where in the JSON of a joint its value stands.
type SummaryColumn = (&'static str, Kind, &'static str);

const ESTIMATED: [SummaryColumn; 7] = [
    ("file", Kind::Text, ""),
    ("joint", Kind::Text, "/joint"),
    ("steps", Kind::Whole, "/steps"),
    ("accepted", Kind::Whole, "/accepted"),
    ("delay_min_s", Kind::Real, "/delay_s/min"),
    ("delay_median_s", Kind::Real, "/delay_s/median"),
    ("delay_max_s", Kind::Real, "/delay_s/max"),
];

const IMPROVED: [SummaryColumn; 8] = [
    ("file", Kind::Text, ""),
    ("joint", Kind::Text, "/joint"),
    ("verdict", Kind::Text, "/verdict"),
    ("revision", Kind::Whole, "/revision"),
    ("effects", Kind::Text, "/effects"),
    ("train_rmse", Kind::Real, "/error/train/rmse"),
    ("validation_rmse", Kind::Real, "/error/validation/rmse"),
    ("noise_floor", Kind::Real, "/error/noise_floor"),
];

/// The runs of a log, one for each method.
fn runs(log: &LogResult) -> impl Iterator<Item = &Value> {
    std::iter::once(&log.document).chain(array(&log.document, "also"))
}

/// The elements of an array in a document; none where it has no such array.
fn array<'a>(document: &'a Value, name: &str) -> impl Iterator<Item = &'a Value> + use<'a> {
    document.get(name).and_then(Value::as_array).into_iter().flatten()
}

fn texts(document: &Value, name: &str) -> Vec<String> {
    array(document, name).filter_map(Value::as_str).map(str::to_owned).collect()
}

/// One joint in all its `logs`.
fn across(name: &str, logs: &[&Value]) -> Value {
    let sum = |count: &str| logs.iter().filter_map(|joint| joint.get(count)?.as_u64()).sum::<u64>();
    let numbers = |place: &str| {
        let numbers = logs.iter().filter_map(|joint| joint.pointer(place)?.as_f64());
        DelayRange::of(numbers.collect())
    };
    let decisions = logs.iter().flat_map(|joint| array(joint, "decisions"));
    let accepted = decisions.filter(|row| row.get("verdict") == Some(&json!("accepted")));
    let delays_s = accepted.filter_map(|row| row.get("delta_s")?.as_f64());
    let is_adequate = |joint: &&&Value| joint.get("verdict") == Some(&json!("adequate"));
    let mut effects: Map<String, Value> = Map::new();
    for effect in logs.iter().flat_map(|joint| texts(joint, "effects")) {
        let known = effects.get(&effect).and_then(Value::as_u64).unwrap_or_default();
        effects.insert(effect, (known + 1).into());
    }
    json!({
        "joint": name,
        "logs": logs.len(),
        "steps": sum("steps"),
        "accepted": sum("accepted"),
        "delay_s": DelayRange::of(delays_s.collect()),
        "median_delay_s_of_logs": numbers("/delay_s/median"),
        "adequate": logs.iter().filter(is_adequate).count(),
        "validation_rmse": numbers("/error/validation/rmse"),
        "effects": effects,
    })
}

/// The document of `--results … --format json`; `failures` are messages on logs that
/// failed.
pub(crate) fn folder_json(report: &FolderReport, failures: &[String]) -> Value {
    let facts = json!({
        "command": report.command,
        "logs": report.logs.iter().map(|log| log.file.as_str()).collect::<Vec<_>>(),
        "joints": report.across(),
        "summary": report.summary_rows().map(Value::Object).collect::<Value>(),
        "failures": failures,
    });
    document("tauscope/folder/1", facts)
}
