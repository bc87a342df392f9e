//! What was found of a joint: verdict, ranking, and what is concluded.

use serde_json::{Map, Value, json};

use super::document::joined;
use super::model::parameters;
use crate::diagnosis::ErrorFigures;
use crate::experiment::Joint;
use crate::explain::{Candidate, Contribution, Judgement, Separation, Start};
use crate::report::conclusion::Conclusion;
use crate::report::consequence::Consequence;
use crate::report::finding::{Finding, decision_id, specs};
use crate::report::separation::experiment;

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
    let all = parameters(of.joint, of.fit);
    let found = |one: &Contribution| {
        let prefix = format!("{}.", one.effect);
        let own = all.iter().filter(|(name, _)| name.starts_with(&prefix));
        let own = own.map(|(name, value)| (name.clone(), value.clone()));
        json!({
            "effect": one.effect,
            "error_share_percent": 100.0 * one.error_share,
            "alternatives": one.alternatives,
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

/// A candidate of a ranking.
fn candidate_json(joint: &Joint, candidate: &Candidate) -> Value {
    let separations = candidate.separated_by.iter();
    json!({
        "effect": candidate.name(),
        "effects": candidate.effects,
        "equation": specs(candidate).map(|spec| spec.equation).collect::<Vec<_>>(),
        "train_rmse": candidate.training.map(|error| error.rmse),
        "validation_rmse": candidate.validation.map(|error| error.rmse),
        "error_reduction_percent": candidate.error_reduction_percent,
        "p_value": candidate.p_value,
        "share_of_misfit": candidate.share_of_misfit,
        "parameters": own_parameters(joint, candidate),
        "indistinguishable_from": candidate.indistinguishable_from,
        "separated_by": separations.map(|one| separation_json(joint, one)).collect::<Value>(),
        "judgement": judgement_json(&candidate.judgement),
    })
}

/// Whether an effect is worth adding, and why.
fn judgement_json(judgement: &Judgement) -> Value {
    let decision = json!({ "decision": decision_id(judgement), "reason": judgement.reason() });
    joined([json!(judgement), decision])
}

/// The parameters of what was added: `upper` of one effect, `dead_band.upper` of several.
fn own_parameters(joint: &Joint, candidate: &Candidate) -> Map<String, Value> {
    let own = |name: String| {
        let (effect, short) = name.split_once('.')?;
        let is_added = candidate.effects.contains(&effect);
        let short = if candidate.effects.len() == 1 { short.to_owned() } else { name.clone() };
        is_added.then_some(short)
    };
    let all = parameters(joint, &candidate.fit);
    all.into_iter().filter_map(|(name, value)| Some((own(name)?, value))).collect()
}

/// The experiment that would distinguish a candidate from another.
fn separation_json(joint: &Joint, separation: &Separation) -> Value {
    let Separation { other, proposal, times_noise, after_s, is_clear } = separation;
    let start = |start: &Start| json!({ "output": start.angle, "others": start.others, "worked_s": start.worked_s });
    json!({
        "other": other,
        "experiment": is_clear.then(|| experiment(joint, separation)),
        "times_noise": times_noise,
        "after_s": after_s,
        "pattern": proposal.pattern,
        "levels": proposal.levels,
        "hold_s": proposal.hold_s,
        "duration_s": proposal.duration_s(),
        "starts": proposal.starts.iter().map(start).collect::<Value>(),
    })
}
