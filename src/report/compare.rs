//! `compare` as text and JSON.

use std::ops::Range;

use comfy_table::{CellAlignment, Table, presets};
use serde::Serialize;
use serde_json::{Map, Value, json};

use crate::diagnosis::failure::{FailsWhere, Region, WorstSegment};
use crate::diagnosis::{Comparison, ErrorFigures, InputCorrelation, LackOfFit, Whiteness};
use crate::experiment::Joint;
use crate::fit::{Assessment, Parameter, Status};
use crate::wording::{
    self, correlation_sentences, effect_ids, effects_text, number, parameter_units, with_remark,
    with_unit,
};

/// A joint, its model, and how the two compare.
#[derive(Clone, Copy, Debug)]
pub struct ComparedJoint<'a> {
    /// What was measured.
    pub joint: &'a Joint,
    /// Name of the model: that of its file.
    pub model: &'a str,
    /// Number of its revision.
    pub revision: u32,
    /// The figures.
    pub comparison: &'a Comparison,
}

/// The document of `compare --format json`, schema `tauscope/compare/1`.
#[derive(Debug, Serialize)]
pub struct CompareJson<'a> {
    schema: &'static str,
    version: &'static str,
    joints: Vec<JointJson<'a>>,
    failures: &'a [String],
}

/// A joint and its model, as every command that fits models shows them.
#[derive(Debug, Serialize)]
pub(super) struct JointJson<'a> {
    joint: &'a str,
    model: &'a str,
    revision: u32,
    effects: Vec<&'static str>,
    parameters: Map<String, Value>,
    error: ErrorJson,
    lack_of_fit: Option<LackOfFit>,
    whiteness: Option<&'a Whiteness>,
    input_correlation: Option<&'a InputCorrelation>,
    fails_where: &'a [FailsWhere],
    worst_segments: &'a [WorstSegment],
    regions: &'a [Region],
    termination: String,
}

#[derive(Debug, Serialize)]
pub(super) struct ErrorJson {
    train: Option<ErrorFigures>,
    validation: Option<ErrorFigures>,
    noise_floor: Option<f64>,
}

impl<'a> CompareJson<'a> {
    /// Collects the results; `failures` are messages on joints and files that failed.
    pub fn new(joints: &[ComparedJoint<'a>], failures: &'a [String]) -> Self {
        let joints = joints.iter().map(JointJson::new).collect();
        let version = env!("CARGO_PKG_VERSION");
        Self { schema: "tauscope/compare/1", version, joints, failures }
    }
}

impl<'a> JointJson<'a> {
    pub(super) fn new(compared: &ComparedJoint<'a>) -> Self {
        let comparison = compared.comparison;
        Self {
            joint: &compared.joint.name,
            model: compared.model,
            revision: compared.revision,
            effects: effect_ids(&comparison.fit.model),
            parameters: parameters_json(compared.joint, &comparison.fit),
            error: ErrorJson::new(comparison),
            lack_of_fit: comparison.lack_of_fit,
            whiteness: comparison.whiteness.as_ref(),
            input_correlation: comparison.input_correlation.as_ref(),
            fails_where: comparison.failure.as_ref().map_or(&[], |f| &f.fails_where),
            worst_segments: comparison.failure.as_ref().map_or(&[], |f| &f.worst_segments),
            regions: &comparison.regions,
            termination: comparison.termination.to_string(),
        }
    }
}

impl ErrorJson {
    pub(super) fn new(comparison: &Comparison) -> Self {
        let Comparison { training, validation, noise_floor, .. } = comparison;
        Self { train: *training, validation: *validation, noise_floor: *noise_floor }
    }
}

/// Parameters by name, with their standard errors and units.
pub(super) fn parameters_json(joint: &Joint, fit: &Assessment) -> Map<String, Value> {
    let parameter = |(parameter, unit): (&Parameter, String)| {
        let Parameter { name, value, std_error, status } = parameter;
        let status = status_id(*status);
        let value = json!({
            "value": value, "std_error": std_error, "unit": unit, "status": status,
        });
        (name.clone(), value)
    };
    fit.parameters.iter().zip(parameter_units(joint, &fit.model)).map(parameter).collect()
}

fn status_id(status: Status) -> &'static str {
    match status {
        Status::Fitted => "fitted",
        Status::Fixed => "fixed",
        Status::AtBound => "at_bound",
        Status::Undetermined => "undetermined",
    }
}

/// A table of errors, one row per joint and model, and the parameters below it.
pub fn compare_table(joints: &[ComparedJoint<'_>], horizon: &str) -> String {
    let mut table = Table::new();
    table.load_style(presets::UTF8_BORDERS_ONLY).set_header([
        "joint",
        "model",
        "training",
        "validation",
        "fit",
        "noise",
        "lack of fit",
    ]);
    for compared in joints {
        table.add_row(row(compared));
    }
    align_right(&mut table, 2..6);
    let parameters: Vec<_> = joints.iter().map(parameters).collect();
    let failures: Vec<_> = joints.iter().flat_map(failure_sentences).collect();
    let failures = if failures.is_empty() {
        String::new()
    } else {
        format!("\nwhere it fails (restarted at every step):\n{}\n", failures.join("\n"))
    };
    let residuals: Vec<_> = joints.iter().filter_map(residual_line).collect();
    let residuals = if residuals.is_empty() {
        String::new()
    } else {
        format!("\nwhat is left of the training part:\n{}\n", residuals.join("\n"))
    };
    let parameters = parameters.join("\n");
    format!("{table}\nroot-mean-square errors, {horizon}\n\n{parameters}\n{residuals}{failures}")
}

/// How the residual of a joint is correlated, in a line.
fn residual_line(compared: &ComparedJoint<'_>) -> Option<String> {
    let parts = correlation_sentences(compared.comparison);
    (!parts.is_empty())
        .then(|| format!("{} ({}): {}", compared.joint.name, compared.model, parts.join("; ")))
}

/// Numbers stand right.
pub(super) fn align_right(table: &mut Table, columns: Range<usize>) {
    for right in columns {
        if let Some(column) = table.column_mut(right) {
            column.set_cell_alignment(CellAlignment::Right);
        }
    }
}

/// Where a model fails, in sentences that start with the joint.
fn failure_sentences(compared: &ComparedJoint<'_>) -> Vec<String> {
    let ComparedJoint { joint, comparison, .. } = compared;
    let sentences = wording::failure_sentences(joint, comparison).into_iter();
    sentences.map(|sentence| format!("{} ({}): {sentence}", joint.name, compared.model)).collect()
}

fn row(compared: &ComparedJoint<'_>) -> [String; 7] {
    let effects = effects_text(&compared.comparison.fit.model);
    let [training, validation, fit, noise, lack] = figures(compared.joint, compared.comparison);
    [compared.joint.name.clone(), effects, training, validation, fit, noise, lack]
}

/// Error on both parts, fit in percent, noise and lack of fit, for a table.
pub(super) fn figures(joint: &Joint, comparison: &Comparison) -> [String; 5] {
    let Comparison { training, validation, noise_floor, lack_of_fit, .. } = comparison;
    let dash = || "-".to_owned();
    let output = |value: f64| with_unit(value, joint.output_unit.as_deref());
    let rmse = |error: &Option<ErrorFigures>| error.map_or_else(dash, |error| output(error.rmse));
    let percent = validation.map_or_else(dash, |error| format!("{:.1} %", error.fit_percent));
    let verdict = lack_of_fit.map_or_else(dash, wording::lack_of_fit);
    let noise = noise_floor.map_or_else(dash, output);
    [rmse(training), rmse(validation), percent, noise, verdict]
}

/// The parameters of a model in one line.
pub(super) fn parameters(compared: &ComparedJoint<'_>) -> String {
    let fit = &compared.comparison.fit;
    let units = parameter_units(compared.joint, &fit.model);
    let parameter = |(parameter, unit): (&Parameter, String)| {
        let Parameter { name, value, std_error, status } = parameter;
        let error = std_error.map_or_else(String::new, |error| format!(" ± {}", number(error)));
        with_remark(&format!("{name} {}{error} {unit}", number(*value)), *status)
    };
    let parameters: Vec<_> = fit.parameters.iter().zip(units).map(parameter).collect();
    format!(
        "{}: {}; {}",
        compared.joint.name,
        parameters.join(", "),
        compared.comparison.termination
    )
}
