//! `add` as text and JSON: the error before and after.

use serde_json::{Value, json};

use super::compare::{compare_table, error_json, model_json};
use super::explain::conclusion_json;
use super::json::{document, joined};
use super::ladder::change_in_words;
use super::{ComparedJoint, ImprovedJoint};
use crate::model::JointModel;
use crate::numerics::to_decimals;
use crate::wording::{effect_ids, number, p_text, with_unit};

/// A joint whose model got another effect.
#[derive(Clone, Copy, Debug)]
pub(crate) struct AddedJoint<'a> {
    /// The model before and after, as revisions.
    pub(crate) improved: ImprovedJoint<'a>,
    /// Id of the effect.
    pub(crate) effect: &'static str,
    /// Probability of so much or more when the effect is not there; none where the models do not nest.
    pub(crate) p_value: Option<f64>,
}

/// Ids of the effects that `after` has no more.
pub(crate) fn gone(before: &JointModel, after: &JointModel) -> Vec<&'static str> {
    let left = effect_ids(after);
    effect_ids(before).into_iter().filter(|id| !left.contains(id)).collect()
}

impl<'a> AddedJoint<'a> {
    /// The model before and after.
    fn compared(&self) -> [ComparedJoint<'a>; 2] {
        let after = self.improved.finding.compared;
        [self.improved.compared().next().unwrap_or(after), after]
    }

    /// `boom: with dead_band the error falls from 2.9 to 0.4 deg, by 87 %`.
    fn sentence(&self) -> String {
        let error = |of: ComparedJoint<'_>| of.comparison.judged().map_or(f64::NAN, |it| it.rmse);
        let ([before, after], joint) = (self.compared().map(error), self.improved.name());
        let unit = self.improved.finding.compared.joint.output_unit.as_deref();
        let p_value = self.p_value.map_or_else(String::new, |p| {
            let verdict = if p < 0.01 { "" } else { ": not significant" };
            format!(" ({}{verdict})", p_text(p))
        });
        format!("{joint}: with {} the error {}{p_value}", self.effect, change(before, after, unit))
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
    let revisions = joints.iter().flat_map(|joint| joint.improved.numbered());
    // `revision 0, integrator` and `revision 1, + dead_band`.
    let label = |(number, step)| format!("revision {number}, {}", change_in_words(step));
    let labels: Vec<String> = revisions.map(label).collect();
    let models = joints.iter().flat_map(|joint| joint.improved.compared());
    let named = models.zip(&labels).map(|(one, label)| ComparedJoint { model: label, ..one });
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
            "p_value": added.p_value,
            "before": {
                "revision": before.revision,
                "effects": effect_ids(model),
                "error": error_json(before.comparison),
            },
            "conclusion": conclusion_json(&added.sentence(), &added.improved.finding.consequence()),
        });
        joined([model_json(&after), change])
    };
    let joints: Value = joints.iter().map(joint).collect();
    let facts = json!({ "model_file": model_file, "joints": joints, "failures": failures });
    document("tauscope/add/1", facts)
}
