//! `explain` as text and JSON: verdict, ranking, and what is concluded.

use serde_json::{Map, Value, json};

use super::compare::{horizons, model_json};
use super::conclusion::Conclusion;
use super::finding::Consequence;
use super::json::{document, joined};
use super::parameters::{model_text, parameters_json};
use super::ranking::{candidate_json, ranking_table};
use super::{ComparedJoint, Finding};
use crate::diagnosis::ErrorFigures;
use crate::explain::Contribution;

/// For each joint the verdict, the ranking and what they mean.
pub(crate) fn explain_text(findings: &[Finding<'_>]) -> String {
    let joint = |finding: &Finding<'_>| {
        let ComparedJoint { joint, comparison, .. } = finding.compared;
        let conclusion = finding.conclusion();
        let ranking = match finding.ranking {
            [] => String::new(),
            ranking => format!("{}\n", ranking_table(joint, ranking)),
        };
        let (text, model) = (conclusion.printed(), model_text(joint, comparison, None));
        format!("{}\n{ranking}\n{text}\n{model}\n", conclusion.headline)
    };
    let joints: Vec<String> = findings.iter().map(joint).collect();
    let horizon = horizons(findings.iter().map(|finding| finding.compared));
    format!(
        "{}\nroot-mean-square errors, less the mean of each run between restarts, {horizon}; ± is \
         one standard error\n",
        joints.join("\n\n")
    )
}

/// Verdict, ranking and words.
pub(super) fn finding_json(finding: &Finding<'_>, conclusion: &Conclusion) -> Value {
    let joint = finding.compared.joint;
    let candidates = finding.ranking.iter();
    json!({
        "verdict": finding.verdict.id(),
        "ranking": candidates.map(|candidate| candidate_json(joint, candidate)).collect::<Value>(),
        "conclusion": conclusion_json(&conclusion.headline, &finding.consequence()),
        "headline": conclusion.headline,
        "in_words": conclusion.sentences(),
        "commands": conclusion.commands,
    })
}

/// What was found, how much it explains, and what remains.
pub(super) fn conclusion_json(headline: &str, of: &Consequence<'_>) -> Value {
    let all = parameters_json(of.joint, of.fit);
    let found = |one: &Contribution| {
        let prefix = format!("{}.", one.effect);
        let own = all.iter().filter(|(name, _)| name.starts_with(&prefix));
        let own = own.map(|(name, value)| (name.clone(), value.clone()));
        json!({
            "effect": one.effect,
            "error_share_percent": 100.0 * one.error_share,
            "alternatives": one.alternative_names(),
            "parameters": own.collect::<Map<_, _>>(),
        })
    };
    let remaining = |error: ErrorFigures| {
        json!({
            "rmse": error.rmse,
            "times_sensor_noise": of.times_noise(),
            "percent_of_motion": 100.0 - error.fit_percent,
        })
    };
    let known = of.attribution.iter();
    json!({
        "headline": headline,
        "found": known.clone().flat_map(|one| &one.found).map(found).collect::<Value>(),
        "doubtful": known.clone().flat_map(|one| &one.doubtful).map(found).collect::<Value>(),
        "refinements": known.flat_map(|one| &one.refinements).collect::<Vec<_>>(),
        "explained_percent": of.explained().map(|share| 100.0 * share),
        "sensor_noise": of.sensor_noise,
        "remaining": of.after.map(remaining),
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
