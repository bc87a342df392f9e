//! `explain` as text and JSON.

use serde::Serialize;

use super::compare::{JointJson, parameters};
use super::finding::{CandidateJson, Finding, ranking_table};
use super::words::printed;
use crate::explain::Verdict;

/// The document of `explain --format json`, schema `tauscope/explain/1`.
#[derive(Debug, Serialize)]
pub struct ExplainJson<'a> {
    schema: &'static str,
    version: &'static str,
    joints: Vec<ExplainedJson<'a>>,
    failures: &'a [String],
}

#[derive(Debug, Serialize)]
struct ExplainedJson<'a> {
    #[serde(flatten)]
    joint: JointJson<'a>,
    #[serde(flatten)]
    finding: FindingJson<'a>,
}

/// Verdict, ranking and words.
#[derive(Debug, Serialize)]
pub(super) struct FindingJson<'a> {
    verdict: Verdict,
    ranking: Vec<CandidateJson<'a>>,
    headline: String,
    in_words: String,
    commands: Vec<String>,
}

impl<'a> ExplainJson<'a> {
    /// Collects the results; `failures` are messages on joints and files that failed.
    pub fn new(findings: &[Finding<'a>], failures: &'a [String]) -> Self {
        let joint = |finding: &Finding<'a>| ExplainedJson {
            joint: JointJson::new(&finding.compared),
            finding: FindingJson::new(finding),
        };
        let joints = findings.iter().map(joint).collect();
        let version = env!("CARGO_PKG_VERSION");
        Self { schema: "tauscope/explain/1", version, joints, failures }
    }
}

impl<'a> FindingJson<'a> {
    pub(super) fn new(finding: &Finding<'a>) -> Self {
        let joint = finding.compared.joint;
        let words = finding.words();
        let ranking = finding.ranking.iter();
        Self {
            verdict: finding.verdict,
            ranking: ranking.map(|candidate| CandidateJson::new(joint, candidate)).collect(),
            headline: words.headline,
            in_words: words.paragraph,
            commands: words.commands,
        }
    }
}

/// For each joint the verdict, the ranking and what they mean.
pub fn explain_text(findings: &[Finding<'_>], horizon: &str) -> String {
    let joint = |finding: &Finding<'_>| {
        let words = finding.words();
        let ranking = match finding.ranking {
            [] => String::new(),
            ranking => format!("{}\n", ranking_table(finding.compared.joint, ranking)),
        };
        let (said, model) = (printed(&words), parameters(&finding.compared));
        format!("{}\n{ranking}\n{said}\nmodel of {model}\n", words.headline)
    };
    let joints: Vec<String> = findings.iter().map(joint).collect();
    format!("{}\nroot-mean-square errors, {horizon}\n", joints.join("\n\n"))
}
