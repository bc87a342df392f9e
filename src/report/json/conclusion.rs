//! What was found of a joint: verdict, ranking, and what is concluded.

use serde_json::{Map, Value, json};

use crate::diagnosis::ErrorFigures;
use crate::explain::Contribution;
use crate::report::conclusion::Conclusion;
use crate::report::consequence::Consequence;
use crate::report::finding::Finding;
use crate::report::parameters::parameters_json;
use crate::report::ranking::candidate_json;

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
