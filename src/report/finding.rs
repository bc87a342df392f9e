//! What `explain` and `improve` have found of a joint: the effects that were tried, what they explain of its
//! error, what remains, and the experiment that would distinguish two of them. To add something on a
//! candidate to all outputs, add it to [`RANKING`].

use Kind::{Real, Text};
use Part::{Json, People};
use serde_json::{Map, Value, json};

use super::facts::{self, Fact, Part, Place, UNSAID, Unit, fact};
use super::parameters::parameters_json;
use super::{Before, ComparedJoint, Kind, TextTable};
use crate::diagnosis::{ErrorFigures, sensor_noise};
use crate::effect::Spec;
use crate::experiment::Joint;
use crate::explain::{
    Attribution, Candidate, Contribution, Judgement, Pattern, Proposal, Separation, Start, Verdict,
};
use crate::fit::AssessedModel;
use crate::model::Component;
use crate::study::JointEstimate;
use crate::wording::{
    listed, measure, p_text, percent, rounded, times_noise, unit_suffix, with_unit,
};

/// A joint, the verdict on its model, and the ranking it follows from.
#[derive(Clone, Copy, Debug)]
pub struct Finding<'a> {
    /// The model that the verdict is about.
    pub compared: ComparedJoint<'a>,
    /// The verdict.
    pub verdict: Verdict,
    /// The candidates, best first.
    pub ranking: &'a [Candidate],
    /// What follows the effect on the command line that adds it.
    pub add_arguments: &'a str,
    /// The model to which effects were added, where any were.
    pub before: Option<Before<'a>>,
    /// What each effect carries that was added, or is proposed, where that was found out.
    pub attribution: Option<&'a Attribution>,
    /// The delays of its steps, where they were estimated.
    pub delays: Option<&'a JointEstimate>,
}

impl<'a> Finding<'a> {
    /// The candidate that is proposed.
    pub(super) fn proposed(&self) -> Option<&'a Candidate> {
        let mut added = self.ranking.iter().filter(|candidate| candidate.judgement.is_added());
        added.next().filter(|_| self.verdict == Verdict::MissingEffect)
    }

    /// What the effects explain that were added, or that are proposed.
    pub(super) fn consequence(&self) -> Consequence<'a> {
        let comparison = self.compared.comparison;
        let (fit, before, after) = match (self.before, self.proposed()) {
            (None, Some(best)) => {
                let before = comparison.judged().map(|error| error.rmse);
                (&best.fit.assessed, before, best.validation.or(best.training))
            }
            (before, _) => {
                let before = before.and_then(|before| before.rmse());
                (&comparison.fit.assessed, before, comparison.judged())
            }
        };
        let (joint, attribution) = (self.compared.joint, self.attribution);
        Consequence {
            joint,
            fit,
            attribution,
            before,
            after,
            sensor_noise: sensor_noise(&joint.trials),
        }
    }
}

/// The effects that a candidate added, in its order.
pub(super) fn added(candidate: &Candidate) -> impl Iterator<Item = &Component> {
    let components = candidate.fit.model.components();
    let of_id =
        |id: &&'static str| components.iter().find(|component| component.effect().spec().id == *id);
    candidate.effects.iter().filter_map(of_id)
}

pub(super) fn specs(candidate: &Candidate) -> impl Iterator<Item = &'static Spec> {
    added(candidate).map(|component| component.effect().spec())
}

/// `added: shown, …` or `refused: …`.
pub(super) fn judgement_text(judgement: &Judgement) -> String {
    format!("{}: {}", decision_id(judgement), judgement.reason())
}

/// What became of a candidate.
pub(super) fn decision_id(judgement: &Judgement) -> &'static str {
    if judgement.is_added() { "added" } else { "refused" }
}

/// A model with effects that were added, or are proposed, beside the model without them.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Consequence<'a> {
    pub(crate) joint: &'a Joint,
    /// The model with the effects.
    pub(crate) fit: &'a AssessedModel,
    /// What each of them carries, where that was found out.
    pub(crate) attribution: Option<&'a Attribution>,
    /// The root-mean-square error without them, where there are any.
    pub(crate) before: Option<f64>,
    /// The error with them.
    pub(crate) after: Option<ErrorFigures>,
    /// The noise of the sensor, from the record alone.
    pub(crate) sensor_noise: Option<f64>,
}

/// `5.6 times the noise`; where that is not known, `a fit of 88 % to the output`.
pub(crate) fn in_proportion(error: ErrorFigures, noise: Option<f64>) -> String {
    match (noise, error.fit_percent / 100.0) {
        (Some(noise), _) => times_noise(error.rmse / noise),
        (None, fit) if fit > 0.0 => format!("a fit of {} to the output", percent(fit)),
        // A model that runs away, or an output that hardly moves.
        (None, _) => "no better than the mean of the output".to_owned(),
    }
}

impl Consequence<'_> {
    /// The part of the error that the effects explain, 0 to 1: `1 − (e − s)/(e₀ − s)` with the
    /// root-mean-square errors `e₀` before and `e` with them, and the noise `s`.
    pub(crate) fn explained(&self) -> Option<f64> {
        let (before, after) = (self.before?, self.after?.rmse);
        let noise = self.sensor_noise.unwrap_or(0.0).min(after);
        let share = 1.0 - (after - noise) / (before - noise).max(f64::MIN_POSITIVE);
        Some(share.clamp(0.0, 1.0))
    }

    /// How many times the noise the remaining error is.
    pub(crate) fn times_noise(&self) -> Option<f64> {
        Some(self.after?.rmse / self.sensor_noise?)
    }

    /// `0.28 deg remain, 5.6 times the noise`.
    pub(super) fn remains(&self) -> String {
        let Some(after) = self.after else { return "an error remains".to_owned() };
        let error = measure(after.rmse, self.joint.output_unit.as_deref());
        format!("{error} remain, {}", in_proportion(after, self.sensor_noise))
    }

    /// What each of several effects carries, and what could stand in its place.
    pub(super) fn sentences(&self) -> Vec<String> {
        let others = self.alternatives().chain(self.hidden());
        let sentences = self.shares().into_iter().chain(others);
        sentences.chain(self.doubtful()).chain(self.refinements()).collect()
    }

    /// What each of several effects carries.
    fn shares(&self) -> Option<String> {
        let found = &self.attribution.filter(|known| known.found.len() > 1)?.found;
        let share = |one: &Contribution| format!("{} {}", one.effect, percent(one.error_share));
        let shares: Vec<String> = found.iter().map(share).collect();
        let sum: f64 = found.iter().map(|one| one.error_share).sum();
        let overlap = if sum > 1.0 { " (shares overlap and do not add up)" } else { "" };
        Some(format!(
            "Share of the initial error beyond the noise that each effect explains (growth of the \
             error when it is left out and the rest is refitted): {}{overlap}.",
            shares.join(", ")
        ))
    }

    /// What could stand in the place of each effect.
    fn alternatives(&self) -> impl Iterator<Item = String> {
        let found = self.attribution.iter().flat_map(|known| &known.found);
        found.filter(|one| !one.alternatives.is_empty()).map(|one| {
            let others: Vec<String> = one.alternatives.iter().map(|own| own.join(" + ")).collect();
            let others = others.join(" or ");
            format!("In place of {}, {others} fits about as well.", one.effect)
        })
    }

    /// What would not show beside each effect.
    fn hidden(&self) -> impl Iterator<Item = String> {
        let found = self.attribution.iter().flat_map(|known| &known.found);
        found.filter(|one| !one.hidden.is_empty()).map(|one| {
            let (effect, hidden) = (one.effect, one.hidden.join(" or "));
            format!(
                "Beside {effect}, {hidden} could not be identified from this record: they act alike \
                 on the output."
            )
        })
    }

    /// What may stand for something else.
    fn doubtful(&self) -> Option<String> {
        let doubtful = &self.attribution?.doubtful;
        let share = |one: &Contribution| format!("{} {}", one.effect, percent(one.error_share));
        let shares: Vec<String> = doubtful.iter().map(share).collect();
        (!shares.is_empty()).then(|| {
            format!(
                "Doubtful: {}. Such an effect removes less than half of the squared error beyond the noise \
                 that the model has without it, so it may only imitate an effect outside the \
                 catalogue.",
                shares.join(", ")
            )
        })
    }

    /// What is of no consequence.
    pub(super) fn refinements(&self) -> Option<String> {
        let refinements = self.attribution.map_or(&[][..], |known| &known.refinements);
        (!refinements.is_empty()).then(|| {
            let names = refinements.join(", ");
            format!("Statistically significant, but of no practical consequence: {names}.")
        })
    }
}

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
    facts::text_table(RANKING, Place::Terminal, None, rows)
}

/// A candidate in JSON.
pub(super) fn candidate_json(joint: &Joint, candidate: &Candidate) -> Value {
    facts::object(RANKING, Json, &(joint, candidate)).into()
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

/// What would distinguish an effect from another, or that nothing would.
pub(super) fn separation_sentence(joint: &Joint, separation: &Separation) -> String {
    let other = separation.other;
    if separation.is_clear {
        return format!("To distinguish it from {other}: {}.", experiment(joint, separation));
    }
    format!(
        "No input that was tried at the angles of this record distinguishes it from {other}: their \
         outputs differ by less than the noise, or by a change of gain."
    )
}

/// `hold 0.3, 0.4, 0.5 V for 2 s each, …: after 6 s the two differ by 14 times the noise`.
pub(super) fn experiment(joint: &Joint, separation: &Separation) -> String {
    let Separation { proposal, times_noise, after_s, .. } = separation;
    let (after, times) = (rounded(*after_s), rounded(*times_noise));
    format!(
        "{}, {}: after {after} s the two differ by {times} times the noise",
        input(joint, proposal),
        starts(joint, &proposal.starts)
    )
}

fn input(joint: &Joint, proposal: &Proposal) -> String {
    let Proposal { pattern, levels, hold_s, .. } = proposal;
    let (levels, hold) = (levels_text(levels, joint.input_unit.as_deref()), rounded(*hold_s));
    let order = match pattern {
        Pattern::Ladder => "rising and then falling, in one direction and then in the other",
        Pattern::Pulses => "each in both directions, followed by a rest of the same length",
        Pattern::Reversals => "each in both directions, without a rest",
    };
    format!("hold {levels} for {hold} s each, {order}")
}

fn starts(joint: &Joint, starts: &[Start]) -> String {
    let all = |value: fn(&Start) -> f64| {
        let mut values: Vec<f64> = starts.iter().map(value).collect();
        values.dedup();
        values
    };
    let angles = all(|start| start.angle);
    let angles: Vec<String> = match angles.split_last() {
        Some((last, before)) => {
            let last = measure(*last, joint.output_unit.as_deref());
            before.iter().map(|angle| rounded(*angle)).chain([last]).collect()
        }
        None => Vec::new(),
    };
    let from = format!("from rest at {}", listed(&angles, "and"));
    match (all(|start| start.worked_s).as_slice(), all(|start| start.others).as_slice()) {
        ([cold, warm], _) => {
            let (cold, warm) = (rounded(*cold), rounded(*warm));
            format!("{from}, once after {cold} s and once after {warm} s of work")
        }
        (_, [_, _]) => {
            format!("{from}, once while the other joints rest and once while they move")
        }
        _ => from,
    }
}

/// `0.3, 0.4 and 0.5 V`.
pub(super) fn levels_text(levels: &[f64], unit: Option<&str>) -> String {
    let levels: Vec<String> = levels.iter().map(|level| rounded(*level)).collect();
    listed(&levels, "and") + &unit_suffix(unit)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::experiment::Trial;
    use crate::units::SamplePeriod;

    fn joint() -> Joint {
        let period = SamplePeriod::from_seconds(0.01).unwrap();
        let trial = Trial::new("1", 0.0, period, vec![-2.0, 1.0], vec![0.0, 0.0]).unwrap();
        Joint {
            name: "boom".to_owned(),
            input_unit: Some("V".to_owned()),
            output_unit: Some("deg".to_owned()),
            covariates: Vec::new(),
            trials: [trial].into(),
        }
    }

    fn separation(levels: &[f64]) -> Separation {
        let start = Start { angle: 12.0, others: 0.0, worked_s: 60.0 };
        let proposal = Proposal {
            pattern: Pattern::Ladder,
            levels: levels.to_vec(),
            hold_s: 2.0,
            starts: vec![start, Start { angle: 40.0, ..start }],
        };
        Separation { other: "stiction", proposal, times_noise: 14.02, after_s: 6.0, is_clear: true }
    }

    #[test]
    fn an_experiment_is_said_with_its_numbers() {
        let expected = "To distinguish it from stiction: hold 0.3, 0.4 and 0.5 V for 2 s each, rising \
                        and then falling, in one direction and then in the other, from rest at \
                        12 and 40 deg: after 6 s the two differ by 14 times the noise.";
        assert_eq!(separation_sentence(&joint(), &separation(&[0.3, 0.4, 0.5])), expected);
    }

    #[test]
    fn that_no_input_distinguishes_them_is_said_too() {
        let separation = Separation { is_clear: false, ..separation(&[1.0]) };
        let said = separation_sentence(&joint(), &separation);
        assert!(said.starts_with("No input that was tried") && said.ends_with("a change of gain."));
    }

    #[test]
    fn runs_differ_in_what_they_are_to_show() {
        let start = Start { angle: 12.0, others: 0.0, worked_s: 60.0 };
        let cold = starts(&joint(), &[Start { worked_s: 0.0, ..start }, start]);
        assert_eq!(cold, "from rest at 12 deg, once after 0 s and once after 60 s of work");
        let moving = starts(&joint(), &[start, Start { others: 1.0, ..start }]);
        assert!(moving.ends_with("once while the other joints rest and once while they move"));
    }
}
