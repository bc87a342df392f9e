//! Schema `tauscope/estimate/1`, numbers in full precision.

use std::collections::BTreeMap;

use serde::{Serialize, Serializer};
use serde_json::{Map, Value, json};

use super::difference::differences_json;
use super::document::{document, joined, without_empty};
use super::settings::settings_json;
use crate::delay::{
    AgainstState, Bounds, DeadTime, DelayTable, Finding, KindDelay, OnsetModel, Settings, Tracking,
    Unknown, Window,
};
use crate::experiment::{Experiment, Joint, Source};
use crate::report::dead_time_sentences;
use crate::report::decisions::decision_json;
use crate::report::delay_table::level_json;
use crate::report::doubt::doubted;
use crate::report::settings::own_settings;
use crate::report::{Against, EstimatedJoint, JointSummary};

/// The document of `estimate --format json`.
#[derive(Debug, Serialize)]
pub(crate) struct EstimateJson<'a> {
    /// What was read.
    #[serde(flatten)]
    head: Value,
    #[serde(flatten)]
    first: RunJson<'a>,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    also: Vec<RunJson<'a>>,
    /// What the results are compared with, notes and failures.
    #[serde(flatten)]
    end: Value,
}

/// All joints by one method.
#[derive(Debug, Serialize)]
struct RunJson<'a> {
    settings: Value,
    joints: Vec<JointJson<'a>>,
}

#[derive(Debug, Serialize)]
struct JointJson<'a> {
    #[serde(flatten)]
    facts: Value,
    against_state: AgainstState,
    decisions: DecisionsJson<'a>,
}

/// All decisions on a joint, each made as it is written: there may be hundreds of thousands.
#[derive(Debug)]
struct DecisionsJson<'a>(EstimatedJoint<'a>);

impl Serialize for DecisionsJson<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_seq(doubted(self.0).map(|found| decision_json(&found)))
    }
}

impl<'a> EstimateJson<'a> {
    /// Collects the results of one or several runs, the first of which is the answer;
    /// `against` compares it with further ones; the last are notes on reading and results, and
    /// messages on joints and files that failed.
    pub(crate) fn new(
        experiment: &Experiment,
        runs: &[(&Settings, &[EstimatedJoint<'a>])],
        against: &[Against<'_>],
        (notes, failures): (&[String], &[String]),
    ) -> Option<Self> {
        let run = |(settings, joints): &(&Settings, &[EstimatedJoint<'a>])| RunJson {
            settings: settings_json(settings),
            joints: joints.iter().map(|joint| JointJson::new(*joint, settings)).collect(),
        };
        let source = |source: &Source| {
            json!({
                "path": source.path.display().to_string(),
                "sha256": source.sha256,
                "bytes": source.bytes,
            })
        };
        let (first, others) = runs.split_first()?;
        let head = json!({
            "sources": experiment.sources.iter().map(source).collect::<Value>(),
            "reading": experiment.options,
        });
        let end = json!({
            "against": differences_json(against),
            "notes": notes,
            "failures": failures,
        });
        Some(Self {
            head: document("tauscope/estimate/1", head),
            first: run(first),
            also: others.iter().map(run).collect(),
            end: without_empty(end, &["against"]),
        })
    }
}

impl<'a> JointJson<'a> {
    fn new(estimated: EstimatedJoint<'a>, asked: &Settings) -> Self {
        let table = estimated.delay_table();
        Self {
            facts: facts(estimated, asked, &table),
            against_state: estimated.against_state_about(table.neutral.as_ref()),
            decisions: DecisionsJson(estimated),
        }
    }
}

/// What is said of all steps of a joint together.
fn facts(estimated: EstimatedJoint<'_>, asked: &Settings, table: &DelayTable) -> Value {
    let EstimatedJoint { joint, estimate } = estimated;
    let is_own = estimate.chosen.is_some() || own_settings(&estimated, asked).is_some();
    let summary = JointSummary::with(estimated, table.kinds.clone());
    let rejected = summary.rejected.iter();
    let rejected = rejected.map(|(condition, count)| (condition.to_string(), (*count).into()));
    let rows = table.rows.iter().map(|row| level_json(&joint.name, row));
    let facts = json!({
        "joint": joint.name,
        "input_unit": joint.input_unit,
        "output_unit": joint.output_unit,
        "steps": summary.steps,
        "accepted": summary.accepted,
        "rejected": rejected.collect::<Map<_, _>>(),
        "reviewed": summary.reviewed,
        "delay_samples": summary.delay_samples,
        "delay_s": summary.delay_s,
        "input": input_json(estimated),
        "dead_time": estimate.dead_time.as_ref().map(|found| dead_time_json(estimated, found)),
        "settings": is_own.then(|| settings_json(&estimate.settings)),
        "chosen": estimate.chosen,
        "onset_model": estimated.onset_model().map(onset_json),
        "tracking": estimated.tracking().map(tracking_json),
        "warnings": estimated.warnings(),
        "neutral": table.neutral,
        "delay_table": rows.collect::<Value>(),
        "delay_by_transition": table.kinds.iter().map(kind_json).collect::<Value>(),
    });
    let optional = ["reviewed", "dead_time", "settings", "chosen", "onset_model", "tracking"];
    without_empty(facts, &optional)
}

/// What the input is taken for, and what that was decided from.
fn input_json(EstimatedJoint { estimate, .. }: EstimatedJoint<'_>) -> Value {
    let kind = if estimate.dead_time.is_some() { "continuous" } else { "steps" };
    joined([json!({ "kind": kind }), json!(estimate.motion)])
}

/// The response behind the dead times.
fn onset_json(model: &OnsetModel) -> Value {
    json!({
        "shape": model.shape(),
        "parameters": model.parameters().into_iter().collect::<BTreeMap<_, _>>(),
        "misfit": model.misfit(),
        "follows_input_r2": model.follows_input_r2(),
        "by_transition": model.responses().into_iter().map(|one| json!({
            "transition": one.transition,
            "shape": one.shape,
            "parameters": one.parameters.into_iter().collect::<BTreeMap<_, _>>(),
            "fits": one.fits,
        })).collect::<Vec<_>>(),
    })
}

/// Where an output comes to rest: at `offset + gain · input`.
fn tracking_json(found: Tracking) -> Value {
    json!({ "offset": found.offset(), "gain": found.gain() })
}

/// All steps of a kind; a median only where it is typical.
fn kind_json(kind: &KindDelay) -> Value {
    let interval = kind.typical.and_then(|typical| typical.interval_s);
    json!({
        "transition": kind.transition,
        "steps": kind.steps,
        "accepted": kind.accepted,
        "delay_median_s": kind.typical.map(|typical| typical.median_s),
        "delay_low_s": interval.map(|(low, _)| low),
        "delay_high_s": interval.map(|(_, high)| high),
        "most_rejected_as": kind.rejected.map(|(condition, _)| condition.id()),
    })
}

/// A dead time over the record; its numbers are `null` where it is not known.
fn dead_time_json(estimated: EstimatedJoint<'_>, found: &DeadTime) -> Value {
    let windows = found.windows.iter().map(|window| window_json(estimated.joint, window));
    let head = json!({ "verdict": verdict(found) });
    let facts = json!({
        "confidence": found.confidence,
        "reason": dead_time_sentences(&estimated).join("; "),
        "lag_s": found.lag_s,
        "integrates": found.integrates,
        "explained": found.explained,
        "feedback": {
            "present": found.feedback.is_present(),
            "p_value": found.feedback.p_value,
            "correlation": found.feedback.largest,
        },
        "same_in_all_p_value": found.same_in_all,
        "curve": found.curve,
        "windows": windows.collect::<Value>(),
    });
    joined([head, bounds_json(found.bounds()), facts])
}

fn verdict(found: &DeadTime) -> &'static str {
    match found.finding {
        Finding::Known(_) => "dead_time",
        Finding::LagOnly(_) => "lag_without_dead_time",
        Finding::Unknown(Unknown::TooShort) => "too_short",
        Finding::Unknown(Unknown::NotExplained) => "not_explained",
        Finding::Unknown(Unknown::OneFrequency(_)) => "one_frequency",
        Finding::Unknown(Unknown::TooLong(_)) => "too_long",
    }
}

fn bounds_json(bounds: Option<Bounds>) -> Value {
    json!({
        "value_s": bounds.map(|bounds| bounds.value_s),
        "low_s": bounds.map(|bounds| bounds.low_s),
        "high_s": bounds.map(|bounds| bounds.high_s),
    })
}

fn window_json(joint: &Joint, window: &Window) -> Value {
    let trial = joint.trials.get(window.trial);
    let time_s = |sample: usize| trial.map(|trial| trial.logged_time_s(sample));
    let place = json!({
        "trial": trial.map_or("", |trial| trial.label()),
        "first": window.first,
        "last": window.last,
        "start_s": time_s(window.first),
        "end_s": time_s(window.last),
    });
    joined([place, bounds_json(window.estimate)])
}
