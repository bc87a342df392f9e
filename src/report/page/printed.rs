//! What `report` prints: a line or two per joint.

use serde::Serialize;

use super::Report;

/// The document of `report --format json`, schema `tauscope/report/1`.
#[derive(Debug, Serialize)]
pub struct ReportJson<'a> {
    schema: &'static str,
    version: &'static str,
    report: String,
    recording: Option<String>,
    joints: Vec<SentenceJson<'a>>,
    failures: &'a [String],
}

#[derive(Debug, Serialize)]
struct SentenceJson<'a> {
    joint: &'a str,
    sentence: String,
}

impl<'a> ReportJson<'a> {
    /// What was written where, and what is said of each joint.
    pub fn new(report: &'a Report<'_>, path: String, recording: Option<String>) -> Self {
        let joints = report.sentences().into_iter();
        Self {
            schema: "tauscope/report/1",
            version: env!("CARGO_PKG_VERSION"),
            report: path,
            recording,
            joints: joints.map(|(joint, sentence)| SentenceJson { joint, sentence }).collect(),
            failures: report.failures,
        }
    }
}

/// What is said of each joint.
pub fn report_text(report: &Report<'_>) -> String {
    let lines = report.sentences().into_iter();
    lines.map(|(joint, sentence)| [joint, ": ", &sentence, "\n"].concat()).collect()
}
