//! Schema `tauscope/report/1`.

use serde::Serialize;

use super::header::Header;
use crate::report::page::Report;

/// The document of `report --format json`: a sentence or two per joint.
#[derive(Debug, Serialize)]
pub(crate) struct ReportJson<'a> {
    #[serde(flatten)]
    header: Header,
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
    pub(crate) fn new(report: &'a Report<'_>, path: String, recording: Option<String>) -> Self {
        let joints = report.sentences().into_iter();
        Self {
            header: Header::of("tauscope/report/1"),
            report: path,
            recording,
            joints: joints.map(|(joint, sentence)| SentenceJson { joint, sentence }).collect(),
            failures: report.failures,
        }
    }
}
