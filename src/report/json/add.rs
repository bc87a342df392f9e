//! Schema `tauscope/add/1`.

use serde::Serialize;

use super::conclusion::ConclusionJson;
use super::header::Header;
use super::joint::{ErrorJson, JointJson};
use crate::report::add::{AddedJoint, gone};
use crate::wording::effect_ids;

/// The document of `add --format json`.
#[derive(Debug, Serialize)]
pub(crate) struct AddJson<'a> {
    #[serde(flatten)]
    header: Header,
    model_file: String,
    joints: Vec<AddedJson<'a>>,
    failures: &'a [String],
}

#[derive(Debug, Serialize)]
struct AddedJson<'a> {
    #[serde(flatten)]
    joint: JointJson<'a>,
    added: &'static str,
    removed: Vec<&'static str>,
    p_value: Option<f64>,
    before: BeforeJson,
    conclusion: ConclusionJson,
}

#[derive(Debug, Serialize)]
struct BeforeJson {
    revision: u32,
    effects: Vec<&'static str>,
    error: ErrorJson,
}

impl<'a> AddJson<'a> {
    /// Collects the results; `failures` are messages on joints and files that failed.
    pub(crate) fn new(
        model_file: String,
        joints: &[AddedJoint<'a>],
        failures: &'a [String],
    ) -> Self {
        let joint = |added: &AddedJoint<'a>| {
            let [before, after] = added.compared();
            let model = &before.comparison.fit.model;
            AddedJson {
                joint: JointJson::new(&after),
                added: added.effect,
                removed: gone(model, &after.comparison.fit.model),
                p_value: added.addition.p_value,
                before: BeforeJson {
                    revision: before.revision,
                    effects: effect_ids(model),
                    error: ErrorJson::new(before.comparison),
                },
                conclusion: ConclusionJson::new(added.sentence(), &added.consequence()),
            }
        };
        let joints = joints.iter().map(joint).collect();
        Self { header: Header::of("tauscope/add/1"), model_file, joints, failures }
    }
}
