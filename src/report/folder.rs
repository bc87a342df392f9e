//! The results of many logs, each by itself, in one table.

use serde_json::{Map, Value, json};

use super::decisions::decision_columns;
use super::json::document;
use super::{DataTable, DelayRange, Kind, TextTable};
use crate::wording::{counted, percent};

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

    /// The decisions of all logs: the columns of `--decisions` behind one for the log.
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
    pub(super) fn across(&self) -> Vec<Across> {
        let mut across: Vec<Across> = Vec::new();
        for (_, joint) in self.joints() {
            let name = joint.get("joint").and_then(Value::as_str).unwrap_or_default();
            let index = across.iter().position(|known| known.joint == name).unwrap_or_else(|| {
                across.push(Across { joint: name.to_owned(), ..Across::default() });
                across.len() - 1
            });
            across[index].add(joint);
        }
        across
    }

    /// A table of the joints across all logs.
    pub(crate) fn text(&self) -> String {
        let across = self.across();
        let table = if self.command == "improve" {
            let header = [
                "joint",
                "logs",
                "adequate",
                "validation rmse min",
                "median",
                "max",
                "effects (logs)",
            ];
            TextTable::of(header, &[1, 2, 3, 4, 5], across.iter().map(Across::improved_cells))
        } else {
            let header = [
                "joint",
                "logs",
                "steps",
                "accepted",
                "delay min",
                "median",
                "max",
                "medians of the logs",
            ];
            TextTable::of(header, &[1, 2, 3, 4, 5, 6], across.iter().map(Across::estimated_cells))
        };
        format!("{table}\n{}, each by itself\n", counted(self.logs.len(), "log"))
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

/// One joint in all its logs.
#[derive(Debug, Default)]
pub(super) struct Across {
    pub(super) joint: String,
    pub(super) logs: usize,
    pub(super) steps: u64,
    pub(super) accepted: u64,
    pub(super) delays_s: Vec<f64>,
    pub(super) medians_s: Vec<f64>,
    pub(super) adequate: usize,
    pub(super) rmse: Vec<f64>,
    /// Effects, and in how many logs they are in the model.
    pub(super) effects: Vec<(String, usize)>,
}

impl Across {
    fn add(&mut self, joint: &Value) {
        let count = |name: &str| joint.get(name).and_then(Value::as_u64).unwrap_or_default();
        self.logs += 1;
        self.steps += count("steps");
        self.accepted += count("accepted");
        let accepted =
            array(joint, "decisions").filter(|row| row.get("verdict") == Some(&json!("accepted")));
        self.delays_s.extend(accepted.filter_map(|row| row.get("delta_s")?.as_f64()));
        self.medians_s.extend(joint.pointer("/delay_s/median").and_then(Value::as_f64));
        self.adequate += usize::from(joint.get("verdict") == Some(&json!("adequate")));
        self.rmse.extend(joint.pointer("/error/validation/rmse").and_then(Value::as_f64));
        for effect in texts(joint, "effects") {
            match self.effects.iter_mut().find(|(known, _)| *known == effect) {
                Some((_, logs)) => *logs += 1,
                None => self.effects.push((effect, 1)),
            }
        }
    }

    fn estimated_cells(&self) -> [String; 8] {
        let share = percent(self.accepted as f64 / self.steps.max(1) as f64);
        let accepted = format!("{} ({share})", self.accepted);
        let medians = DelayRange::of(self.medians_s.clone())
            .map_or_else(String::new, |range| format!("{:.3} … {:.3} s", range.min, range.max));
        let [min, median, max] = range_cells(&self.delays_s, " s");
        let (logs, steps) = (self.logs.to_string(), self.steps.to_string());
        [self.joint.clone(), logs, steps, accepted, min, median, max, medians]
    }

    fn improved_cells(&self) -> [String; 7] {
        let effects: Vec<_> =
            self.effects.iter().map(|(name, logs)| format!("{name} ({logs})")).collect();
        let [min, median, max] = range_cells(&self.rmse, "");
        let [logs, adequate] = [self.logs, self.adequate].map(|count| count.to_string());
        [self.joint.clone(), logs, adequate, min, median, max, effects.join(", ")]
    }
}

fn range_cells(values: &[f64], unit: &str) -> [String; 3] {
    let range = DelayRange::of(values.to_vec());
    range.map_or_else(Default::default, |range| {
        [range.min, range.median, range.max].map(|value| format!("{value:.3}{unit}"))
    })
}

/// The document of `--results … --format json` and `merge`; `failures` are messages on logs that
/// failed.
pub(crate) fn folder_json(report: &FolderReport, failures: &[String]) -> Value {
    let facts = json!({
        "command": report.command,
        "logs": report.logs.iter().map(|log| log.file.as_str()).collect::<Vec<_>>(),
        "joints": report.across().iter().map(across).collect::<Value>(),
        "summary": report.summary_rows().map(Value::Object).collect::<Value>(),
        "failures": failures,
    });
    document("tauscope/folder/1", facts)
}

/// One joint in all its logs.
fn across(joint: &Across) -> Value {
    let range = |values: &[f64]| DelayRange::of(values.to_vec());
    let effects: Map<String, Value> =
        joint.effects.iter().map(|(name, logs)| (name.clone(), (*logs).into())).collect();
    json!({
        "joint": joint.joint,
        "logs": joint.logs,
        "steps": joint.steps,
        "accepted": joint.accepted,
        "delay_s": range(&joint.delays_s),
        "median_delay_s_of_logs": range(&joint.medians_s),
        "adequate": joint.adequate,
        "validation_rmse": range(&joint.rmse),
        "effects": effects,
    })
}
