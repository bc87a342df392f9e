//! Schema `tauscope/explain/1`.

use serde::Serialize;

use super::candidate::CandidateJson;
use super::conclusion::ConclusionJson;
use super::header::Header;
use super::joint::JointJson;
use crate::report::conclusion::Conclusion;
use crate::report::finding::Finding;

/// The document of `explain --format json`.
#[derive(Debug, Serialize)]
pub(crate) struct ExplainJson<'a> {
    #[serde(flatten)]
    header: Header,
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
    verdict: &'static str,
    ranking: Vec<CandidateJson<'a>>,
    conclusion: ConclusionJson,
    headline: String,
    in_words: String,
    commands: Vec<String>,
}

impl<'a> ExplainJson<'a> {
    /// Collects the results; `failures` are messages on joints and files that failed.
    pub(crate) fn new(findings: &[Finding<'a>], failures: &'a [String]) -> Self {
        let joint = |finding: &Finding<'a>| ExplainedJson {
            joint: JointJson::new(&finding.compared),
            finding: FindingJson::new(finding, finding.conclusion()),
        };
        let joints = findings.iter().map(joint).collect();
        Self { header: Header::of("tauscope/explain/1"), joints, failures }
    }
}

impl<'a> FindingJson<'a> {
    /// What was found, and what is concluded of it.
    pub(super) fn new(finding: &Finding<'a>, conclusion: Conclusion) -> Self {
        let joint = finding.compared.joint;
        let ranking = finding.ranking.iter();
        Self {
            verdict: finding.verdict.id(),
            ranking: ranking.map(|candidate| CandidateJson::new(joint, candidate)).collect(),
            conclusion: ConclusionJson::new(conclusion.headline.clone(), &finding.consequence()),
            in_words: conclusion.sentences(),
            headline: conclusion.headline,
            commands: conclusion.commands,
        }
    }
}
