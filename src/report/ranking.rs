//! What is said of the effects that were tried: to add something to all outputs, add it to [`RANKING`].

use serde_json::{Map, Value, json};

use super::Kind;
use super::facts::{self, Fact, Part, Place, UNSAID, Unit, fact};
use super::finding::{decision_id, judgement_text, specs};
use super::parameters::parameters_json;
use super::separation::experiment;
use super::text_table::TextTable;
use crate::experiment::Joint;
use crate::explain::{Candidate, Judgement, Separation, Start};
use crate::wording::{p_text, with_unit};
use Kind::{Real, Text};
use Part::{Json, People};

/// A candidate for a model of a joint.
type Ranked<'a> = (&'a Joint, &'a Candidate);

type RankedFact = Fact<fn(&Ranked<'_>) -> Value>;

const SHOWN: &[Place] = &[Place::Terminal];

/// All that is said of a candidate, in the order of the fields of a ranking.
#[rustfmt::skip]
const RANKING: &[RankedFact] = &[
    fact("effect", Text, Json, ("effect", "", Unit::None, SHOWN), |(_, it)| it.name().into()),
    fact("effects", Text, Json, UNSAID, |(_, it)| json!(it.effects)),
    fact("equation", Text, Json, UNSAID, |(_, it)| specs(it).map(|spec| spec.equation).collect()),
    fact("train_rmse", Real, Json, UNSAID, |(_, it)| it.training.map(|error| error.rmse).into()),
    fact("validation_rmse", Real, Json, UNSAID, |(_, it)| it.validation.map(|error| error.rmse).into()),
    fact("rmse", Real, People, ("validation", "", Unit::None, SHOWN), |(joint, it)| with_unit(it.rmse(), joint.output_unit.as_deref()).into()),
    fact("error_reduction_percent", Real, Json, UNSAID, |(_, it)| it.error_reduction_percent.into()),
    fact("reduction", Real, People, ("reduction", "", Unit::None, SHOWN), |(_, it)| format!("{:.1} %", it.error_reduction_percent).into()),
    fact("p_value", Real, Json, UNSAID, |(_, it)| it.p_value.into()),
    fact("p", Text, People, ("p-value", "", Unit::None, SHOWN), |(_, it)| p_text(it.p_value).into()),
    fact("share_of_misfit", Real, Json, UNSAID, |(_, it)| json!(it.share_of_misfit)),
    fact("parameters", Real, Json, UNSAID, |(joint, it)| own_parameters(joint, it).into()),
    fact("indistinguishable_from", Text, Json, UNSAID, |(_, it)| json!(it.indistinguishable_from)),
    fact("same", Text, People, ("indistinguishable from", "", Unit::None, SHOWN), |(_, it)| same(it).into()),
    fact("separated_by", Text, Json, UNSAID, |(joint, it)| it.separated_by.iter().map(|one| separation_json(joint, one)).collect()),
    fact("judgement", Text, Json, UNSAID, |(_, it)| judgement_json(&it.judgement)),
    fact("judged", Text, People, ("judgement", "", Unit::None, SHOWN), |(_, it)| judgement_text(&it.judgement).into()),
];

fn same(candidate: &Candidate) -> String {
    match candidate.indistinguishable_from.as_slice() {
        [] => "-".to_owned(),
        same => same.join(", "),
    }
}

/// A row per candidate, best first.
pub(super) fn ranking_table(joint: &Joint, ranking: &[Candidate]) -> TextTable {
    let rows = ranking.iter().map(|candidate| (joint, candidate));
    facts::text_table(RANKING, Place::Terminal, None, (rows, |value, row| value(row)))
}

/// A candidate in JSON.
pub(super) fn candidate_json(joint: &Joint, candidate: &Candidate) -> Value {
    facts::object(RANKING, Json, |value| value(&(joint, candidate))).into()
}

/// Whether an effect is worth adding, and why.
fn judgement_json(judgement: &Judgement) -> Value {
    let mut all = json!(judgement);
    all["decision"] = decision_id(judgement).into();
    all["reason"] = judgement.reason().into();
    all
}

/// The parameters of what was added: `upper` of one effect, `dead_band.upper` of several.
fn own_parameters(joint: &Joint, candidate: &Candidate) -> Map<String, Value> {
    let own = |name: String| {
        let (effect, short) = name.split_once('.')?;
        let is_added = candidate.effects.contains(&effect);
        let short = if candidate.effects.len() == 1 { short.to_owned() } else { name.clone() };
        is_added.then_some(short)
    };
    let all = parameters_json(joint, &candidate.fit);
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
