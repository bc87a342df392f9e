//! Decisions of an earlier run, read from its JSON or from its table of decisions.

use std::io::ErrorKind;
use std::ops::RangeInclusive;
use std::path::Path;

use serde::Deserialize;

use super::difference::{JointResult, OtherResult, StepResult, verdict_of};
use super::sheet::{FileError, table_reader};
use crate::experiment::read_text;
use crate::numerics::Line;

/// The schema of an estimate.
const SCHEMA: &str = "tauscope/estimate/1";

/// What a file is known by that has a table of decisions.
const COLUMNS: [&str; 6] = ["joint", "trial", "i", "p", "verdict", "failed"];

/// Delays that there may be, s: a log is sampled at least once in so many seconds.
const DELAYS_S: RangeInclusive<f64> = -1e8..=1e8;

#[derive(Debug, Deserialize)]
struct Document {
    settings: Option<SettingsRead>,
    joints: Vec<JointRead>,
}

/// What is said of the settings.
#[derive(Debug, Deserialize)]
struct SettingsRead {
    method: String,
    alpha: Option<f64>,
    alpha_s: Option<f64>,
    beta: Option<f64>,
    beta_s: Option<f64>,
    low_pass: Option<LowPassRead>,
}

#[derive(Debug, Deserialize)]
struct LowPassRead {
    cutoff_hz: f64,
}

#[derive(Debug, Deserialize)]
struct JointRead {
    joint: String,
    decisions: Vec<Row>,
}

/// A decision as both kinds of file have it.
#[derive(Debug, Deserialize)]
struct Row {
    joint: String,
    trial: String,
    i: usize,
    p: usize,
    r: usize,
    end: usize,
    delta: Option<f64>,
    delta_s: Option<f64>,
    slope_before: Option<f64>,
    intercept_before: Option<f64>,
    slope_after: Option<f64>,
    intercept_after: Option<f64>,
    verdict: String,
    #[serde(default)]
    delta_low: Option<f64>,
    #[serde(default)]
    delta_high: Option<f64>,
    /// In a table of several methods: the first one is the answer.
    #[serde(default)]
    method: Option<String>,
}

impl OtherResult {
    /// Reads what an earlier `estimate` found: its JSON, or its table of decisions as CSV. Of
    /// several methods the first one is read. None where the file is neither, or is longer than
    /// any result.
    ///
    /// # Errors
    /// [`FileError`] for what cannot be opened, and for what is one of both and cannot be understood.
    pub fn read(path: &Path) -> Result<Option<Self>, FileError> {
        match read_text(path) {
            Ok(text) => Self::parse(text.trim_start_matches('\u{feff}'), path),
            // A log may be long, and may be no text.
            Err(error) if error.kind() == ErrorKind::InvalidData => Ok(None),
            Err(error) => Err(FileError::unreadable(path, "cannot be read")(error)),
        }
    }

    fn parse(text: &str, path: &Path) -> Result<Option<Self>, FileError> {
        let name = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
        if text.trim_start().starts_with(['{', '[']) {
            let document = document(text, path)?;
            let settings = document.settings.map(SettingsRead::in_short);
            let joints = document.joints.into_iter();
            let joints = joints.map(|joint| joint_of(joint.joint, joint.decisions, path));
            return Ok(Some(Self { name, settings, joints: joints.collect::<Result<_, _>>()? }));
        }
        let Some(rows) = rows(text, path)? else { return Ok(None) };
        let method = rows.first().and_then(|row| row.method.clone());
        let mut joints: Vec<(String, Vec<Row>)> = Vec::new();
        for row in rows.into_iter().filter(|row| row.method == method) {
            match joints.iter_mut().find(|(joint, _)| *joint == row.joint) {
                Some((_, rows)) => rows.push(row),
                None => joints.push((row.joint.clone(), vec![row])),
            }
        }
        let joints = joints.into_iter().map(|(joint, rows)| joint_of(joint, rows, path));
        Ok(Some(Self { name, settings: method, joints: joints.collect::<Result<_, _>>()? }))
    }
}

fn document(text: &str, path: &Path) -> Result<Document, FileError> {
    let json = FileError::unreadable(path, "this is not a complete result of `estimate`");
    let value: serde_json::Value = serde_json::from_str(text).map_err(&json)?;
    let schema = value.get("schema").and_then(serde_json::Value::as_str);
    if schema != Some(SCHEMA) {
        let found = schema.map_or_else(|| "none".to_owned(), |schema| format!("`{schema}`"));
        let problem = format!("expected the JSON of an estimate, schema `{SCHEMA}`; found {found}");
        return Err(FileError::wrong(path, String::new(), problem));
    }
    serde_json::from_value(value).map_err(json)
}

/// The rows of a table of decisions; none where `text` is no such table.
fn rows(text: &str, path: &Path) -> Result<Option<Vec<Row>>, FileError> {
    let table = FileError::unreadable(path, "the table of decisions cannot be read");
    let mut reader = table_reader(text, Some(b'#'));
    let Ok(found) = reader.headers().cloned() else { return Ok(None) };
    if COLUMNS.into_iter().any(|name| found.iter().all(|column| column != name)) {
        return Ok(None);
    }
    reader.deserialize().collect::<Result<Vec<Row>, _>>().map(Some).map_err(table)
}

fn joint_of(joint: String, rows: Vec<Row>, path: &Path) -> Result<JointResult, FileError> {
    let steps = rows.into_iter().map(|row| row.step(path));
    Ok(JointResult { joint, steps: steps.collect::<Result<_, _>>()? })
}

impl Row {
    fn step(self, path: &Path) -> Result<StepResult, FileError> {
        let wrong = |problem| {
            let Self { joint, trial, i, .. } = &self;
            let place = format!(": joint `{joint}`, trial {trial}, step {i}");
            FileError::wrong(path, place, problem)
        };
        let Some(verdict) = verdict_of(&self.verdict) else {
            return Err(wrong(format!("there is no verdict `{}`", self.verdict)));
        };
        if let Some(got) = self.delta_s.filter(|delay| !DELAYS_S.contains(delay)) {
            let problem = format!("{got:e} s is not a delay; expected at most 1e8 s");
            return Err(wrong(problem));
        }
        let line = |slope: Option<f64>, intercept: Option<f64>| {
            Some(Line { slope: slope?, intercept: intercept? })
        };
        let before = line(self.slope_before, self.intercept_before);
        let after = line(self.slope_after, self.intercept_after);
        Ok(StepResult {
            trial: self.trial,
            i: self.i,
            p: self.p,
            segment: (self.r, self.end),
            verdict,
            delay: self.delta,
            delay_s: self.delta_s,
            interval: self.delta_low.zip(self.delta_high),
            lines: before.zip(after).map(|(before, after)| [before, after]),
        })
    }
}

impl SettingsRead {
    fn in_short(self) -> String {
        let length = |samples: Option<f64>, seconds: Option<f64>| {
            let samples = samples.map(|samples| format!("{samples} samples"));
            samples.or_else(|| seconds.map(|seconds| format!("{seconds} s")))
        };
        let alpha = length(self.alpha, self.alpha_s).map(|length| format!("α {length}"));
        let beta = length(self.beta, self.beta_s).map(|length| format!("β {length}"));
        let low_pass = self.low_pass.map(|filter| format!("{} Hz", filter.cutoff_hz));
        let parts = [alpha, beta, low_pass].into_iter().flatten();
        std::iter::once(self.method).chain(parts).collect::<Vec<_>>().join(", ")
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::delay::{Condition, Verdict};

    const HEADER: &str = "joint,trial,i,p,r,end,candidates,f_opt,q,delta,delta_s,sse,\
        slope_before,intercept_before,slope_after,intercept_after,verdict,failed";

    fn parse(text: &str) -> Result<Option<OtherResult>, FileError> {
        OtherResult::parse(text, Path::new("earlier.csv"))
    }

    #[test]
    fn a_table_of_decisions_is_read() {
        let rows = "boom,1,1,89,79,126,8,5,104,15,0.15,1.5,0,2,0.1,-8,accepted,\n\
                    boom,1,2,120,110,126,0,,,,,,,,,,too_short,too_short\n";
        let read = parse(&format!("{HEADER}\n{rows}")).unwrap().unwrap();
        let [joint] = read.joints.as_slice() else { panic!("{read:?}") };
        let [first, second] = joint.steps.as_slice() else { panic!("{joint:?}") };
        assert_eq!((read.name.as_str(), first.p, first.delay), ("earlier", 89, Some(15.0)));
        assert_eq!(first.lines.map(|lines| lines[1].slope), Some(0.1));
        assert_eq!(second.verdict, Verdict::Rejected(Condition::TooShort));
        assert_eq!((second.delay, second.lines), (None, None));
    }

    #[test]
    fn what_is_no_result_is_none_and_what_is_a_broken_one_names_its_place() {
        assert_eq!(parse("time_s,boom.input,boom.output\n0,1,2\n").unwrap(), None);
        let said = |text: &str| parse(text).map_err(|error| error.to_string()).unwrap_err();
        let other = said(r#"{"schema": "tauscope/sweep/1"}"#);
        assert!(other.ends_with("found `tauscope/sweep/1`"), "{other}");
        assert!(matches!(parse("{"), Err(FileError::Unreadable { .. })));
        let unknown = "boom,1,1,89,79,126,8,5,104,15,0.15,1.5,0,2,0.1,-8,perhaps,\n";
        let unknown = said(&format!("{HEADER}\n{unknown}"));
        assert!(unknown.ends_with("step 1: there is no verdict `perhaps`"), "{unknown}");
        let endless = "boom,1,1,89,79,126,8,5,104,15,1e308,1.5,0,2,0.1,-8,accepted,\n";
        let endless = said(&format!("{HEADER}\n{endless}"));
        assert!(endless.contains("step 1: 1e308 s is not a delay"), "{endless}");
        let ragged = parse(&format!("{HEADER}\nboom,1\n"));
        assert!(matches!(ragged, Err(FileError::Unreadable { .. })));
    }
}
