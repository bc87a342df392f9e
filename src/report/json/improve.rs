//! Schema `tauscope/improve/1`.

use serde::Serialize;
use serde_json::{Map, Value};

use super::explain::FindingJson;
use super::header::Header;
use super::joint::{ErrorJson, JointJson, parameters};
use super::misfit::LackOfFitJson;
use crate::experiment::Joint;
use crate::explain::{Change, Revision};
use crate::report::improve::ImprovedJoint;
use crate::wording::effect_ids;

/// The document of `improve --format json`.
#[derive(Debug, Serialize)]
pub(crate) struct ImproveJson<'a> {
    #[serde(flatten)]
    header: Header,
    joints: Vec<ImprovedJson<'a>>,
    failures: &'a [String],
}

#[derive(Debug, Serialize)]
struct ImprovedJson<'a> {
    #[serde(flatten)]
    joint: JointJson<'a>,
    revisions: Vec<RevisionJson>,
    interrupted: bool,
    #[serde(flatten)]
    finding: FindingJson<'a>,
}

#[derive(Debug, Serialize)]
struct RevisionJson {
    revision: u32,
    added: Option<&'static str>,
    removed: Option<&'static str>,
    effects: Vec<&'static str>,
    parameters: Map<String, Value>,
    error: ErrorJson,
    lack_of_fit: Option<LackOfFitJson>,
}

impl<'a> ImproveJson<'a> {
    /// Collects the results; `failures` are messages on joints and files that failed.
    pub(crate) fn new(joints: &[ImprovedJoint<'a>], failures: &'a [String]) -> Self {
        let joint = |improved: &ImprovedJoint<'a>| {
            let compared = &improved.finding.compared;
            let revision = |(number, revision)| RevisionJson::new(compared.joint, number, revision);
            ImprovedJson {
                joint: JointJson::new(compared),
                revisions: improved.numbered().map(revision).collect(),
                interrupted: improved.interrupted,
                finding: FindingJson::new(&improved.finding, improved.conclusion()),
            }
        };
        let joints = joints.iter().map(joint).collect();
        Self { header: Header::of("tauscope/improve/1"), joints, failures }
    }
}

impl RevisionJson {
    fn new(joint: &Joint, number: u32, revision: &Revision) -> Self {
        let (added, removed) = match revision.change {
            Change::Start => (None, None),
            Change::Added(id) => (Some(id), None),
            Change::Removed(id) => (None, Some(id)),
            Change::Replaced { old, new } => (Some(new), Some(old)),
        };
        let fit = &revision.comparison.fit;
        Self {
            revision: number,
            added,
            removed,
            effects: effect_ids(&fit.model),
            parameters: parameters(joint, fit),
            error: ErrorJson::new(&revision.comparison),
            lack_of_fit: revision.comparison.lack_of_fit.as_ref().map(Into::into),
        }
    }
}
