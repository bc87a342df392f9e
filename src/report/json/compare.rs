//! Schema `tauscope/compare/1`.

use serde::Serialize;

use super::header::Header;
use super::joint::JointJson;
use crate::report::compare::ComparedJoint;

/// The document of `compare --format json`.
#[derive(Debug, Serialize)]
pub(crate) struct CompareJson<'a> {
    #[serde(flatten)]
    header: Header,
    joints: Vec<JointJson<'a>>,
    failures: &'a [String],
}

impl<'a> CompareJson<'a> {
    /// Collects the results; `failures` are messages on joints and files that failed.
    pub(crate) fn new(joints: &[ComparedJoint<'a>], failures: &'a [String]) -> Self {
        let joints = joints.iter().map(JointJson::new).collect();
        Self { header: Header::of("tauscope/compare/1"), joints, failures }
    }
}
