//! Schema `tauscope/report/1`.

use serde::Serialize;

use super::conclusion::ConclusionJson;
use super::difference::OtherJson;
use super::header::Header;
use crate::report::page::Report;

/// The document of `report --format json`: a sentence or two per joint.
#[derive(Debug, Serialize)]
pub(crate) struct ReportJson<'a> {
    #[serde(flatten)]
    header: Header,
    report: Option<String>,
    recording: Option<String>,
    joints: Vec<SentenceJson<'a>>,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    against: Vec<OtherJson<'a>>,
    failures: &'a [String],
}

#[derive(Debug, Serialize)]
struct SentenceJson<'a> {
    joint: &'a str,
    sentence: String,
    /// Of its model, where one is asked for.
    conclusion: Option<ConclusionJson>,
}

impl<'a> ReportJson<'a> {
    /// What was written where, and what is said of each joint.
    pub(crate) fn new(
        report: &'a Report<'_>,
        path: Option<String>,
        recording: Option<String>,
    ) -> Self {
        let joints = report.sentences().into_iter();
        Self {
            header: Header::of("tauscope/report/1"),
            report: path,
            recording,
            joints: joints.map(|(joint, sentence)| of_joint(report, joint, sentence)).collect(),
            against: report.against.iter().map(OtherJson::new).collect(),
            failures: report.failures,
        }
    }
}

fn of_joint<'a>(report: &Report<'_>, joint: &'a str, sentence: String) -> SentenceJson<'a> {
    let mut models = report.models.iter().map(|improved| &improved.finding);
    let finding = models.find(|finding| finding.compared.joint.name == joint);
    let conclusion = finding.map(ConclusionJson::of);
    SentenceJson { joint, sentence, conclusion }
}
