//! Schema `tauscope/columns/1`.

use serde_json::{Value, json};

use super::document::{document, without_empty};
use crate::experiment::{JointColumns, Survey, SurveyedColumn};
use crate::report::columns::role;

/// The JSON of `survey`, with the mappings as `options` on the command line, the likeliest first, and
/// what is `mended` in the log.
pub(crate) fn columns_json(survey: &Survey, options: &[String], mended: &[String]) -> Value {
    let (options, alternatives) = match options {
        [first, others @ ..] => (first.as_str(), others),
        [] => ("", options),
    };
    let column = |column: &SurveyedColumn| {
        json!({
            "column": column.name,
            "unit": column.unit,
            "taken_for": role(column),
            "why": column.why,
        })
    };
    let joint = |joint: &JointColumns| json!({ "joint": joint.name, "input": joint.input, "output": joint.output });
    let facts = json!({
        "path": survey.path.display().to_string(),
        "columns": survey.columns.iter().map(column).collect::<Value>(),
        "joints": survey.map.joints.iter().map(joint).collect::<Value>(),
        "open": survey.open,
        "options": options,
        "mended": mended,
        "alternatives": alternatives,
    });
    document("tauscope/columns/1", without_empty(facts, &["alternatives"]))
}
