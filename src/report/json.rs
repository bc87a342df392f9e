//! `estimate` as JSON, numbers in full precision.

use serde::Serialize;

use super::decisions::detailed_rows;
use super::{DecisionDetail, DecisionRow, DelayRange, EstimatedJoint, JointSummary};
use crate::delay::{AgainstState, Chosen, Condition, Lag, LagPart, Settings};
use crate::experiment::{Experiment, ReadOptions, Source};

/// The document of `estimate --format json`, schema `tauscope/estimate/1`.
#[derive(Debug, Serialize)]
pub struct EstimateJson<'a> {
    schema: &'static str,
    version: &'static str,
    sources: Vec<SourceJson<'a>>,
    reading: &'a ReadOptions,
    settings: &'a Settings,
    joints: Vec<JointJson<'a>>,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    also: Vec<RunJson<'a>>,
    notes: &'a [String],
    failures: &'a [String],
}

/// The same joints by another method.
#[derive(Debug, Serialize)]
struct RunJson<'a> {
    settings: &'a Settings,
    joints: Vec<JointJson<'a>>,
}

/// The lag that a method found, in seconds.
#[derive(Debug, Serialize)]
struct LagJson {
    mean_s: LagPart,
    time_constant_s: Option<LagPart>,
    period_s: Option<LagPart>,
    damping: Option<LagPart>,
}

/// A row with all that is told of it.
#[derive(Debug, Serialize)]
struct DecisionJson<'a> {
    #[serde(flatten)]
    row: DecisionRow<'a>,
    #[serde(flatten)]
    detail: DecisionDetail,
}

#[derive(Debug, Serialize)]
struct SourceJson<'a> {
    path: String,
    sha256: &'a str,
    bytes: u64,
}

#[derive(Debug, Serialize)]
struct JointJson<'a> {
    joint: &'a str,
    input_unit: Option<&'a str>,
    output_unit: Option<&'a str>,
    steps: usize,
    accepted: usize,
    rejected: serde_json::Map<String, serde_json::Value>,
    delay_samples: Option<DelayRange>,
    delay_s: Option<DelayRange>,
    #[serde(skip_serializing_if = "Option::is_none")]
    settings: Option<&'a Settings>,
    #[serde(skip_serializing_if = "Option::is_none")]
    chosen: Option<Chosen>,
    #[serde(skip_serializing_if = "Option::is_none")]
    lag: Option<LagJson>,
    against_state: AgainstState,
    decisions: Vec<DecisionJson<'a>>,
}

impl<'a> EstimateJson<'a> {
    /// Collects the results of one or several runs, the first of which is the answer;
    /// `failures` are messages on joints and files that failed.
    pub fn new(
        experiment: &'a Experiment,
        runs: &[(&'a Settings, &'a [EstimatedJoint<'a>])],
        failures: &'a [String],
    ) -> Option<Self> {
        let joints = |joints: &[EstimatedJoint<'a>]| {
            joints.iter().map(|joint| JointJson::new(*joint)).collect()
        };
        let (&(settings, first), others) = runs.split_first()?;
        let run = |run: &(&'a Settings, &'a [EstimatedJoint<'a>])| RunJson {
            settings: run.0,
            joints: joints(run.1),
        };
        let source = |source: &'a Source| SourceJson {
            path: source.path.display().to_string(),
            sha256: &source.sha256,
            bytes: source.bytes,
        };
        Some(Self {
            schema: "tauscope/estimate/1",
            version: env!("CARGO_PKG_VERSION"),
            sources: experiment.sources.iter().map(source).collect(),
            reading: &experiment.options,
            settings,
            joints: joints(first),
            also: others.iter().map(run).collect(),
            notes: &experiment.notes,
            failures,
        })
    }
}

impl<'a> JointJson<'a> {
    fn new(joint: EstimatedJoint<'a>) -> Self {
        let chosen = joint.estimate.chosen;
        let JointSummary { steps, accepted, rejected, delay_samples, delay_s } =
            JointSummary::of(joint);
        let count = |(condition, count): (Condition, usize)| (condition.to_string(), count.into());
        Self {
            joint: &joint.joint.name,
            input_unit: joint.joint.input_unit.as_deref(),
            output_unit: joint.joint.output_unit.as_deref(),
            steps,
            accepted,
            rejected: rejected.into_iter().map(count).collect(),
            delay_samples,
            delay_s,
            settings: chosen.map(|_| &joint.estimate.settings),
            chosen,
            lag: joint.lag().map(LagJson::new),
            against_state: joint.against_state(),
            decisions: detailed_rows(joint)
                .map(|(row, detail)| DecisionJson { row, detail })
                .collect(),
        }
    }
}

impl LagJson {
    fn new(lag: &Lag) -> Self {
        Self {
            mean_s: lag.mean_s(),
            time_constant_s: lag.time_constant_s(),
            period_s: lag.period_s(),
            damping: lag.damping(),
        }
    }
}
