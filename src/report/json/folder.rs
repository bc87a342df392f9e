//! Schema `tauscope/folder/1`.

use serde_json::{Map, Value, json};

use super::document::document;
use crate::report::DelayRange;
use crate::report::folder::{Across, FolderReport};

/// The document of `--results … --format json` and `merge`; `failures` are messages on logs that
/// failed.
pub(crate) fn folder_json(report: &FolderReport, failures: &[String]) -> Value {
    let facts = json!({
        "command": report.command,
        "logs": report.logs.iter().map(|log| log.file.as_str()).collect::<Vec<_>>(),
        "joints": report.across().iter().map(across).collect::<Value>(),
        "summary": report.summary_rows().map(Value::Object).collect::<Value>(),
        "failures": failures,
    });
    document("tauscope/folder/1", facts)
}

/// One joint in all its logs.
fn across(joint: &Across) -> Value {
    let range = |values: &[f64]| DelayRange::of(values.to_vec());
    let effects: Map<String, Value> =
        joint.effects.iter().map(|(name, logs)| (name.clone(), (*logs).into())).collect();
    json!({
        "joint": joint.joint,
        "logs": joint.logs,
        "steps": joint.steps,
        "accepted": joint.accepted,
        "delay_s": range(&joint.delays_s),
        "median_delay_s_of_logs": range(&joint.medians_s),
        "adequate": joint.adequate,
        "validation_rmse": range(&joint.rmse),
        "effects": effects,
    })
}
