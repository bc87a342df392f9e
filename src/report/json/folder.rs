//! Schema `tauscope/folder/1`.

use serde::Serialize;
use serde_json::{Map, Value, json};

use super::header::Header;
use crate::report::DelayRange;
use crate::report::folder::{Across, FolderReport};

/// The document of `--results … --format json` and `merge`.
#[derive(Debug, Serialize)]
pub(crate) struct FolderJson {
    #[serde(flatten)]
    header: Header,
    command: String,
    logs: Vec<String>,
    joints: Vec<Value>,
    summary: Vec<Value>,
    failures: Vec<String>,
}

impl FolderJson {
    /// Collects what `report` holds; `failures` are messages on logs that failed.
    pub(crate) fn new(report: &FolderReport, failures: &[String]) -> Self {
        Self {
            header: Header::of("tauscope/folder/1"),
            command: report.command.clone(),
            logs: report.logs.iter().map(|log| log.file.clone()).collect(),
            joints: report.across().iter().map(across).collect(),
            summary: report.summary_rows().map(Value::Object).collect(),
            failures: failures.to_vec(),
        }
    }
}

/// One joint in all its logs.
fn across(joint: &Across) -> Value {
    let range = |values: &[f64]| DelayRange::of(values.to_vec());
    let effects: Map<String, Value> =
        joint.effects.iter().map(|(name, logs)| (name.clone(), (*logs).into())).collect();
    json!({
        "joint": joint.joint, "logs": joint.logs, "steps": joint.steps,
        "accepted": joint.accepted, "delay_s": range(&joint.delays_s),
        "median_delay_s_of_logs": range(&joint.medians_s), "adequate": joint.adequate,
        "validation_rmse": range(&joint.rmse), "effects": effects,
    })
}
