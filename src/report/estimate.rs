//! `estimate`: its table for the terminal, and schema `tauscope/estimate/1`, numbers in full precision.

use std::collections::BTreeMap;

use serde::{Serialize, Serializer};
use serde_json::{Map, Value, json};

use super::answer::dead_time_sentences;
use super::decisions::{decision_json, doubted, doubtful_text};
use super::delays::level_json;
use super::difference::{Against, differences_json};
use super::estimated::Scatter;
use super::json::{document, joined, without_empty};
use super::settings::{own_settings, settings_json, settings_line};
use super::summary::Headline;
use super::{DelayRange, EstimatedJoint, JointSummary, TextTable};
use crate::delay::{
    AgainstState, Bounds, Condition, DeadTime, DelayTable, Finding, KindDelay, OnsetModel,
    Settings, Unknown, Window,
};
use crate::experiment::{Experiment, Joint, Source};
use crate::wording::{percent, rounded};

/// The table of `estimate`: a row per joint, and the settings below it.
pub(crate) fn estimate_table(joints: &[EstimatedJoint<'_>], settings: &Settings) -> String {
    let table = summary_table(joints);
    let mut kinds = String::new();
    for joint in joints {
        let (name, summary) = (&joint.joint.name, JointSummary::of(*joint));
        let sentences = joint.kind_sentences(summary.headline.kinds()).into_iter();
        kinds.extend(sentences.map(|sentence| format!("{name}: {sentence}\n")));
        kinds.extend(summary.reviewed.map(|count| format!("{name}: {}\n", count.sentence())));
    }
    let doubtful = doubtful_text(joints);
    let dead_times: String = joints.iter().flat_map(dead_time_lines).collect();
    let lines = joints.iter().flat_map(|joint| [onset_line(joint), tracking_line(joint)]);
    let lags: String = lines.flatten().collect();
    let own = joints.iter().filter_map(|joint| {
        let own = own_settings(joint, settings)?;
        Some(format!("{}, settings of its own: {}\n", joint.joint.name, settings_line(own)))
    });
    let own: String = own.collect();
    let settings = format!("settings: {}\n", settings_line(settings));
    // Nothing of it is used where all inputs move all the time.
    let is_used = |joint: &EstimatedJoint<'_>| joint.estimate.dead_time.is_none();
    let settings = if joints.iter().any(is_used) { settings } else { String::new() };
    format!("{table}\n{kinds}{doubtful}{dead_times}{lags}{own}{settings}")
}

/// What is said of the dead time of a joint, a line each.
fn dead_time_lines<'a>(joint: &EstimatedJoint<'a>) -> impl Iterator<Item = String> + use<'a> {
    let name = joint.joint.name.as_str();
    dead_time_sentences(joint).into_iter().map(move |sentence| format!("{name}: {sentence}\n"))
}

/// The response of a joint after its dead times in words, where the method fits one and onsets are
/// delays.
pub(super) fn onset_line(joint: &EstimatedJoint<'_>) -> Option<String> {
    let model = joint.onset_model().filter(|model| model.obstacle().is_none())?;
    let response = onset_sentence(model);
    let agree = Scatter::of(&joint.fine_delays())
        .filter(|scatter| !scatter.is_more_than_noise() && !joint.against_state().has_dependence());
    let agree = agree.map_or_else(String::new, |scatter| {
        format!("; its delays are constant within {} s", rounded(scatter.within_s))
    });
    Some(format!("{}: {response}{agree}\n", joint.joint.name))
}

/// The response after the dead times in words, with what it leaves over.
pub(crate) fn onset_sentence(model: &OnsetModel) -> String {
    let parameters = model.parameters();
    let value = |name: &str| {
        let found = parameters.iter().find(|(known, _)| *known == name);
        found.map_or_else(String::new, |(_, value)| rounded(*value))
    };
    let response = match model.shape() {
        "bend" => "the speed changes at once".to_owned(),
        "bend_lag" => {
            format!(
                "the speed follows through a lag with time constant {} s",
                value("time_constant_s")
            )
        }
        "bend_lag2" => {
            let lags: Vec<String> = parameters.iter().map(|(_, lag)| rounded(*lag)).collect();
            format!("the speed follows through lags with time constants {} s", lags.join(", "))
        }
        "oscillation" => {
            let lag = value("time_constant_s");
            let behind = if lag.is_empty() {
                lag
            } else {
                format!(", after a lag with time constant {lag} s")
            };
            format!(
                "the speed follows with an oscillation, period {} s and damping {}{behind}",
                value("period_s"),
                value("damping")
            )
        }
        "settling" => {
            format!("the output settles with time constant {} s", value("time_constant_s"))
        }
        _ => "the output goes to a level at a constant rate".to_owned(),
    };
    let others = model.responses().into_iter().filter(|one| one.shape != model.shape());
    let others = others.map(|one| format!(", {}s `{}`", one.transition.id(), one.shape));
    format!(
        "after the delay {response} (`{}`{}); residual {} times the sensor noise; the input steps \
         explain {} of the changes of speed or level (R²)",
        model.shape(),
        others.collect::<String>(),
        rounded(model.misfit()),
        percent(model.follows_input_r2())
    )
}

/// Where the output of a joint comes to rest, in words, where its input says that.
pub(super) fn tracking_line(joint: &EstimatedJoint<'_>) -> Option<String> {
    let tracking = joint.tracking()?;
    let sign = if tracking.gain() < 0.0 { '−' } else { '+' };
    Some(format!(
        "{}: the output tracks the input like the position of a servo (at rest y = {} {sign} \
         {}·u): the bend where it arrives at its new position is not counted as a reaction\n",
        joint.joint.name,
        rounded(tracking.offset()),
        rounded(tracking.gain().abs())
    ))
}

/// What the cells of [`summary_cells`] are.
pub(crate) const SUMMARY_HEADER: [&str; 7] =
    ["joint", "steps", "accepted", "rejected", "delay min", "median", "max"];

/// A row per joint, for people.
pub(crate) fn summary_table(joints: &[EstimatedJoint<'_>]) -> TextTable {
    let row =
        |joint: &EstimatedJoint<'_>| summary_cells(&joint.joint.name, &JointSummary::of(*joint));
    TextTable::of(SUMMARY_HEADER, &[1, 2, 4, 5, 6], joints.iter().map(row))
}

/// A joint in one row, for people.
pub(crate) fn summary_cells(name: &str, summary: &JointSummary) -> [String; 7] {
    let JointSummary { steps, accepted, rejected, delay_s, headline, .. } = summary;
    let accepted = match steps {
        0 => "-".to_owned(),
        _ => format!("{accepted} ({})", percent(*accepted as f64 / *steps as f64)),
    };
    let why = match (steps, rejected.is_empty()) {
        (0, _) => summary.without_steps.clone(),
        (_, true) => "none".to_owned(),
        (_, false) => reasons(rejected),
    };
    let seconds = |value: fn(&DelayRange) -> f64| {
        delay_s.as_ref().map_or_else(|| "-".to_owned(), |range| format!("{:.3} s", value(range)))
    };
    let median = match headline {
        Headline::All => seconds(|range| range.median),
        Headline::Kinds(_) => "by kind".to_owned(),
        Headline::None(_) => "-".to_owned(),
    };
    let [min, max] = [seconds(|range| range.min), seconds(|range| range.max)];
    [name.to_owned(), steps.to_string(), accepted, why, min, median, max]
}

fn reasons(rejected: &[(Condition, usize)]) -> String {
    let parts: Vec<_> = rejected.iter().map(|(why, count)| format!("{why} {count}")).collect();
    parts.join(", ")
}

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
    let is_own = own_settings(&estimated, asked).is_some();
    let summary = JointSummary::with(estimated, table.kinds.clone());
    let rejected = summary.rejected.iter();
    let rejected = rejected.map(|(condition, count)| (condition.to_string(), (*count).into()));
    let rows = table.rows.iter().map(|row| level_json(&joint.name, row));
    let kind = if estimate.dead_time.is_some() { "continuous" } else { "steps" };
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
        // What the input is taken for, and what that was decided from.
        "input": joined([json!({ "kind": kind }), json!(estimate.motion)]),
        "dead_time": estimate.dead_time.as_ref().map(|found| dead_time_json(estimated, found)),
        "settings": is_own.then(|| settings_json(&estimate.settings)),
        "onset_model": estimated.onset_model().map(onset_json),
        // Where the output comes to rest: at `offset + gain · input`.
        "tracking": estimated.tracking().map(|it| json!({ "offset": it.offset(), "gain": it.gain() })),
        "warnings": estimated.warnings(),
        "neutral": table.neutral,
        "delay_table": rows.collect::<Value>(),
        "delay_by_transition": table.kinds.iter().map(kind_json).collect::<Value>(),
    });
    let optional = ["reviewed", "dead_time", "settings", "onset_model", "tracking"];
    without_empty(facts, &optional)
}

/// The response after the dead times.
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
