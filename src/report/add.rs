//! `add` as text and JSON: the error before and after.

use serde_json::{Value, json};

use super::ComparedJoint;
use super::compare::{compare_table, error_json, model_json};
use super::explain::conclusion_json;
use super::finding::Consequence;
use super::json::{document, joined};
use crate::diagnosis::{Comparison, sensor_noise};
use crate::experiment::Joint;
use crate::explain::Addition;
use crate::model::JointModel;
use crate::numerics::to_decimals;
use crate::wording::{effect_ids, effects_text, number, p_text, with_unit};

/// A joint whose model got another effect.
#[derive(Clone, Copy, Debug)]
pub(crate) struct AddedJoint<'a> {
    /// What was measured.
    pub(crate) joint: &'a Joint,
    /// Name of the model: that of its file.
    pub(crate) model: &'a str,
    /// Id of the effect.
    pub(crate) effect: &'static str,
    /// Number of the revision that has it.
    pub(crate) revision: u32,
    /// The model before and after.
    pub(crate) addition: &'a Addition,
}

/// Ids of the effects that `after` has no more.
pub(crate) fn gone(before: &JointModel, after: &JointModel) -> Vec<&'static str> {
    let left = effect_ids(after);
    effect_ids(before).into_iter().filter(|id| !left.contains(id)).collect()
}

impl<'a> AddedJoint<'a> {
    /// The model before and after, as revisions.
    pub(crate) fn compared(&self) -> [ComparedJoint<'a>; 2] {
        let Self { joint, model, revision, addition, .. } = *self;
        let compared = |revision, comparison| ComparedJoint { joint, model, revision, comparison };
        let before = compared(revision.saturating_sub(1), &addition.before);
        [before, compared(revision, &addition.after)]
    }

    /// What the effect explains.
    pub(super) fn consequence(&self) -> Consequence<'a> {
        let Addition { before, after, attribution, .. } = self.addition;
        Consequence {
            joint: self.joint,
            fit: &after.fit,
            attribution: Some(attribution),
            before: before.judged().map(|error| error.rmse),
            after: after.judged(),
            sensor_noise: sensor_noise(&self.joint.trials),
        }
    }

    /// Names of both models, as `revision 0, integrator` and `revision 1, + dead_band`.
    fn labels(&self) -> [String; 2] {
        let [before, after] = self.compared();
        let had = effects_text(&before.comparison.fit.model);
        let (first, second) = (before.revision, after.revision);
        [format!("revision {first}, {had}"), format!("revision {second}, + {}", self.effect)]
    }

    /// `boom: with dead_band the error falls from 2.9 to 0.4 deg, by 87 %`.
    pub(super) fn sentence(&self) -> String {
        let error =
            |comparison: &Comparison| comparison.judged().map_or(f64::NAN, |error| error.rmse);
        let (before, after) = (error(&self.addition.before), error(&self.addition.after));
        let unit = self.joint.output_unit.as_deref();
        let p_value = self.addition.p_value.map_or_else(String::new, |p| {
            let verdict = if p < 0.01 { "" } else { ": not significant" };
            format!(" ({}{verdict})", p_text(p))
        });
        let Self { joint, effect, .. } = self;
        format!("{}: with {effect} the error {}{p_value}", joint.name, change(before, after, unit))
    }
}

/// `falls from 2.9 to 0.4 deg, by 87 %`; `stays 0 deg` where there is nothing to divide by.
fn change(before: f64, after: f64, unit: Option<&str>) -> String {
    let (from, to) = (number(before), with_unit(after, unit));
    let taken = 100.0 * (1.0 - after / before);
    if before.total_cmp(&after).is_eq() {
        return format!("stays {to}");
    }
    let falls = if after < before { "falls" } else { "rises" };
    if !taken.is_finite() {
        return format!("{falls} from {from} to {to}");
    }
    let share = to_decimals(taken.abs(), 1);
    format!("{falls} from {from} to {to}, by {share} %")
}

/// Each joint's model before and after, and what it means.
pub(crate) fn add_text(joints: &[AddedJoint<'_>]) -> String {
    let labels: Vec<_> = joints.iter().map(AddedJoint::labels).collect();
    let named = joints.iter().zip(&labels).flat_map(|(joint, [first, second])| {
        let [before, after] = joint.compared();
        [ComparedJoint { model: first, ..before }, ComparedJoint { model: second, ..after }]
    });
    let compared: Vec<_> = named.collect();
    let sentences: Vec<_> = joints.iter().map(AddedJoint::sentence).collect();
    format!("{}\n{}\n", compare_table(&compared), sentences.join("\n"))
}

/// The document of `add --format json`.
pub(crate) fn add_json(model_file: &str, joints: &[AddedJoint<'_>], failures: &[String]) -> Value {
    let joint = |added: &AddedJoint<'_>| {
        let [before, after] = added.compared();
        let model = &before.comparison.fit.model;
        let change = json!({
            "added": added.effect,
            "removed": gone(model, &after.comparison.fit.model),
            "p_value": added.addition.p_value,
            "before": {
                "revision": before.revision,
                "effects": effect_ids(model),
                "error": error_json(before.comparison),
            },
            "conclusion": conclusion_json(&added.sentence(), &added.consequence()),
        });
        joined([model_json(&after), change])
    };
    let joints: Value = joints.iter().map(joint).collect();
    let facts = json!({ "model_file": model_file, "joints": joints, "failures": failures });
    document("tauscope/add/1", facts)
}
