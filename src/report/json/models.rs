//! Schemas `tauscope/compare/1`, `explain/1`, `add/1`, `improve/1` and `report/1`: what the commands
//! that fit models print. Their `failures` are messages on joints and files that failed.

use serde_json::{Value, json};

use super::conclusion::{conclusion_json, finding_json};
use super::difference::differences_json;
use super::document::{document, joined, without_empty};
use super::model::{error_json, model_json};
use crate::diagnosis::RegionPair;
use crate::experiment::Joint;
use crate::explain::{Change, Revision};
use crate::report::add::{AddedJoint, gone};
use crate::report::compare::{ComparedJoint, ComparedModels, model_differences};
use crate::report::finding::Finding;
use crate::report::improve::ImprovedJoint;
use crate::report::page::Report;
use crate::report::parameters::parameters_json;
use crate::wording::effect_ids;

/// The document of `compare --format json`.
pub(crate) fn compare_json(joints: &[ComparedJoint<'_>], failures: &[String]) -> Value {
    let facts = json!({
        "joints": joints.iter().map(model_json).collect::<Value>(),
        "against": model_differences(joints).iter().map(against).collect::<Value>(),
        "failures": failures,
    });
    document("tauscope/compare/1", without_empty(facts, &["against"]))
}

/// The first model of a joint beside another one.
fn against(models: &ComparedModels<'_>) -> Value {
    let ComparedModels { joint, model, other, difference } = models;
    let places = |pairs: &[RegionPair]| pairs.iter().map(place).collect::<Value>();
    json!({
        "joint": joint.name,
        "model": model,
        "other": other,
        "steps": difference.steps,
        "validation": difference.is_validation,
        "rmse": difference.rmse,
        "other_rmse": difference.other_rmse,
        "better_steps": difference.better_steps,
        "statistic": difference.test.map(|test| test.statistic),
        "p_value": difference.test.map(|test| test.p_value),
        "significant": difference.is_significant(),
        "better_where": places(&difference.better_where),
        "worse_where": places(&difference.worse_where),
    })
}

/// A part of the record, with the error of both.
fn place(RegionPair { region, other_rmse }: &RegionPair) -> Value {
    json!({
        "feature": region.feature,
        "label": region.label,
        "from": region.from,
        "to": region.to,
        "share_of_time": region.share_of_time,
        "rmse": region.rmse,
        "other_rmse": other_rmse,
    })
}

/// The document of `explain --format json`.
pub(crate) fn explain_json(findings: &[Finding<'_>], failures: &[String]) -> Value {
    let joint = |finding: &Finding<'_>| {
        let found = finding_json(finding, &finding.conclusion());
        joined([model_json(&finding.compared), found])
    };
    let joints: Value = findings.iter().map(joint).collect();
    document("tauscope/explain/1", json!({ "joints": joints, "failures": failures }))
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

/// The document of `improve --format json`.
pub(crate) fn improve_json(joints: &[ImprovedJoint<'_>], failures: &[String]) -> Value {
    let joint = |improved: &ImprovedJoint<'_>| {
        let compared = &improved.finding.compared;
        let revisions = improved.numbered();
        let revisions = revisions.map(|(number, one)| revision(compared.joint, number, one));
        let course = json!({
            "revisions": revisions.collect::<Value>(),
            "interrupted": improved.interrupted,
        });
        let found = finding_json(&improved.finding, &improved.conclusion());
        joined([model_json(compared), course, found])
    };
    let joints: Value = joints.iter().map(joint).collect();
    document("tauscope/improve/1", json!({ "joints": joints, "failures": failures }))
}

fn revision(joint: &Joint, number: u32, revision: &Revision) -> Value {
    let (added, removed) = match revision.change {
        Change::Start => (None, None),
        Change::Added(id) => (Some(id), None),
        Change::Removed(id) => (None, Some(id)),
        Change::Replaced { old, new } => (Some(new), Some(old)),
    };
    let fit = &revision.comparison.fit;
    json!({
        "revision": number,
        "added": added,
        "removed": removed,
        "effects": effect_ids(&fit.model),
        "parameters": parameters_json(joint, fit),
        "error": error_json(&revision.comparison),
        "lack_of_fit": revision.comparison.lack_of_fit,
    })
}

/// The document of `report --format json`: what was written where, and what is said of each joint; its
/// conclusion, where a model is asked for.
pub(crate) fn report_json(
    report: &Report<'_>,
    path: Option<&str>,
    recording: Option<&str>,
) -> Value {
    let joint = |(joint, sentence): (&str, String)| {
        let model = report.models.iter().find(|improved| improved.name() == joint);
        let conclusion = model.map(|ImprovedJoint { finding, .. }| {
            conclusion_json(&finding.conclusion().headline, &finding.consequence())
        });
        json!({ "joint": joint, "sentence": sentence, "conclusion": conclusion })
    };
    let facts = json!({
        "report": path,
        "recording": recording,
        "joints": report.sentences().into_iter().map(joint).collect::<Value>(),
        "against": differences_json(report.against),
        "failures": report.failures,
    });
    document("tauscope/report/1", without_empty(facts, &["against"]))
}
