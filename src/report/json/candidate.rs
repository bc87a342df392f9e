//! A candidate of a ranking, and the experiment that would distinguish it from another.

use serde::Serialize;
use serde_json::{Map, Value};

use super::joint::parameters;
use crate::experiment::Joint;
use crate::explain::{Candidate, Judgement, Pattern, Separation, Start};
use crate::report::finding::{decision_id, specs};
use crate::report::separation::experiment;

#[derive(Debug, Serialize)]
pub(super) struct CandidateJson<'a> {
    effect: String,
    effects: &'a [&'static str],
    equation: Vec<&'static str>,
    train_rmse: Option<f64>,
    validation_rmse: Option<f64>,
    error_reduction_percent: f64,
    p_value: f64,
    share_of_misfit: f64,
    parameters: Map<String, Value>,
    indistinguishable_from: &'a [&'static str],
    separated_by: Vec<SeparationJson<'a>>,
    judgement: JudgementJson,
}

/// Whether an effect is worth adding, and why.
#[derive(Debug, Serialize)]
struct JudgementJson {
    evidence: f64,
    determined: bool,
    plausible: bool,
    generalises: bool,
    consequence_percent: f64,
    decision: &'static str,
    reason: String,
}

impl From<&Judgement> for JudgementJson {
    fn from(judgement: &Judgement) -> Self {
        Self {
            evidence: judgement.evidence,
            determined: judgement.determined,
            plausible: judgement.plausible,
            generalises: judgement.generalises,
            consequence_percent: judgement.consequence_percent,
            decision: decision_id(judgement),
            reason: judgement.reason(),
        }
    }
}

impl<'a> CandidateJson<'a> {
    pub(super) fn new(joint: &Joint, candidate: &'a Candidate) -> Self {
        let separations = candidate.separated_by.iter();
        Self {
            effect: candidate.name(),
            effects: &candidate.effects,
            equation: specs(candidate).map(|spec| spec.equation).collect(),
            train_rmse: candidate.training.map(|error| error.rmse),
            validation_rmse: candidate.validation.map(|error| error.rmse),
            error_reduction_percent: candidate.error_reduction_percent,
            p_value: candidate.p_value,
            share_of_misfit: candidate.share_of_misfit,
            parameters: own_parameters(joint, candidate),
            indistinguishable_from: &candidate.indistinguishable_from,
            separated_by: separations.map(|s| SeparationJson::new(joint, s)).collect(),
            judgement: (&candidate.judgement).into(),
        }
    }
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

#[derive(Debug, Serialize)]
struct SeparationJson<'a> {
    other: &'static str,
    experiment: Option<String>,
    times_noise: f64,
    after_s: f64,
    pattern: &'static str,
    levels: &'a [f64],
    hold_s: f64,
    duration_s: f64,
    starts: Vec<StartJson>,
}

#[derive(Debug, Serialize)]
struct StartJson {
    output: f64,
    others: f64,
    worked_s: f64,
}

impl<'a> SeparationJson<'a> {
    fn new(joint: &Joint, separation: &'a Separation) -> Self {
        let Separation { other, proposal, times_noise, after_s, is_clear } = separation;
        let start =
            |s: &Start| StartJson { output: s.angle, others: s.others, worked_s: s.worked_s };
        Self {
            other,
            experiment: is_clear.then(|| experiment(joint, separation)),
            times_noise: *times_noise,
            after_s: *after_s,
            pattern: pattern_id(proposal.pattern),
            levels: &proposal.levels,
            hold_s: proposal.hold_s,
            duration_s: proposal.duration_s(),
            starts: proposal.starts.iter().map(start).collect(),
        }
    }
}

/// The order in which an input takes its levels.
pub(super) fn pattern_id(pattern: Pattern) -> &'static str {
    match pattern {
        Pattern::Ladder => "ladder",
        Pattern::Pulses => "pulses",
        Pattern::Reversals => "reversals",
    }
}
