//! The JSON of `columns`.

use serde::Serialize;

use super::header::Header;
use crate::experiment::{Survey, SurveyedColumn};
use crate::report::columns::role;

/// What a log's columns are taken for.
#[derive(Debug, Serialize)]
pub(crate) struct ColumnsJson<'a> {
    #[serde(flatten)]
    header: Header,
    path: String,
    columns: Vec<ColumnJson<'a>>,
    joints: Vec<JointJson<'a>>,
    open: &'a [String],
    options: &'a str,
    mended: &'a [String],
    /// The options of mappings that could be meant as well.
    #[serde(skip_serializing_if = "<[_]>::is_empty")]
    alternatives: &'a [String],
}

#[derive(Debug, Serialize)]
struct ColumnJson<'a> {
    column: &'a str,
    unit: Option<&'a str>,
    taken_for: String,
    why: &'a str,
}

#[derive(Debug, Serialize)]
struct JointJson<'a> {
    joint: &'a str,
    input: &'a str,
    output: &'a str,
}

impl<'a> ColumnsJson<'a> {
    /// The JSON of `survey`, with the mappings as `options` on the command line, the likeliest first, and
    /// what is `mended` in the log.
    pub(crate) fn new(survey: &'a Survey, options: &'a [String], mended: &'a [String]) -> Self {
        let (options, alternatives) = match options {
            [first, others @ ..] => (first.as_str(), others),
            [] => ("", options),
        };
        let column = |column: &'a SurveyedColumn| ColumnJson {
            column: &column.name,
            unit: column.unit.as_deref(),
            taken_for: role(column),
            why: &column.why,
        };
        let joints = survey.map.joints.iter().map(|joint| JointJson {
            joint: &joint.name,
            input: &joint.input,
            output: &joint.output,
        });
        Self {
            header: Header::of("tauscope/columns/1"),
            path: survey.path.display().to_string(),
            columns: survey.columns.iter().map(column).collect(),
            joints: joints.collect(),
            open: &survey.open,
            options,
            mended,
            alternatives,
        }
    }
}
