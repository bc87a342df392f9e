//! `estimate` as JSON, numbers in full precision.

use serde::Serialize;

use super::{DecisionRow, DelayRange, EstimatedJoint, JointSummary, decision_rows};
use crate::delay::{AgainstState, Condition, Settings};
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
    notes: &'a [String],
    failures: &'a [String],
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
    against_state: AgainstState,
    decisions: Vec<DecisionRow<'a>>,
}

impl<'a> EstimateJson<'a> {
    /// Collects the results; `failures` are messages on joints and files that failed.
    pub fn new(
        experiment: &'a Experiment,
        settings: &'a Settings,
        joints: &[EstimatedJoint<'a>],
        failures: &'a [String],
    ) -> Self {
        let source = |source: &'a Source| SourceJson {
            path: source.path.display().to_string(),
            sha256: &source.sha256,
            bytes: source.bytes,
        };
        Self {
            schema: "tauscope/estimate/1",
            version: env!("CARGO_PKG_VERSION"),
            sources: experiment.sources.iter().map(source).collect(),
            reading: &experiment.options,
            settings,
            joints: joints.iter().copied().map(JointJson::new).collect(),
            notes: &experiment.notes,
            failures,
        }
    }
}

impl<'a> JointJson<'a> {
    fn new(joint: EstimatedJoint<'a>) -> Self {
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
            against_state: joint.against_state(),
            decisions: decision_rows(joint).map(|(_, row)| row).collect(),
        }
    }
}
