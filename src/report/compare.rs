//! `compare` as text and JSON.

use std::ops::Range;

use comfy_table::{CellAlignment, Table, presets};
use serde::Serialize;
use serde_json::{Map, Value, json};

use super::number::{number, probability, with_unit};
use crate::diagnosis::failure::{FailsWhere, Region, Units, WorstSegment};
use crate::diagnosis::{
    CONFIDENCE, Comparison, ErrorFigures, InputCorrelation, LackOfFit, SIGNIFICANCE, ShownBy,
    Whiteness,
};
use crate::effect::Dimension;
use crate::experiment::Joint;
use crate::fit::{Fit, Parameter, Status};
use crate::model::JointModel;

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
            effects: effects(&comparison.fit.model),
            parameters: parameters_json(compared.joint, &comparison.fit),
            error: ErrorJson::new(comparison),
            lack_of_fit: comparison.lack_of_fit,
            whiteness: comparison.whiteness.as_ref(),
            input_correlation: comparison.input_correlation.as_ref(),
            fails_where: comparison.failure.as_ref().map_or(&[], |f| &f.fails_where),
            worst_segments: comparison.failure.as_ref().map_or(&[], |f| &f.worst_segments),
            regions: &comparison.regions,
            termination: comparison.fit.termination.to_string(),
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
pub(super) fn parameters_json(joint: &Joint, fit: &Fit) -> Map<String, Value> {
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

/// Ids of the effects of a model.
pub(super) fn effects(model: &JointModel) -> Vec<&'static str> {
    model.components().iter().map(|component| component.effect().spec().id).collect()
}

fn status_id(status: Status) -> &'static str {
    match status {
        Status::Fitted => "fitted",
        Status::Fixed => "fixed",
        Status::AtBound => "at_bound",
        Status::Undetermined => "undetermined",
    }
}

/// Units of a model's parameters, in the order of [`JointModel::values`].
pub fn parameter_units(joint: &Joint, model: &JointModel) -> Vec<String> {
    let unit = |unit: &Option<String>, kind: &str| unit.clone().unwrap_or_else(|| kind.to_owned());
    let (input, output) = (unit(&joint.input_unit, "input"), unit(&joint.output_unit, "output"));
    let own = [format!("{output}/s/{input}"), "s".to_owned()].into_iter();
    let of = |dimension: Dimension| dimension.unit(Some(&input), Some(&output));
    let parameters = model.components().iter().flat_map(|c| c.effect().spec().parameters);
    own.chain(parameters.map(|parameter| of(parameter.dimension))).collect()
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

/// How the residual is correlated with itself and with the input, in a sentence each.
pub fn correlation_sentences(comparison: &Comparison) -> Vec<String> {
    let Comparison { whiteness, input_correlation, .. } = comparison;
    let white = whiteness.as_ref().map(whiteness_sentence);
    white.into_iter().chain(input_correlation.as_ref().map(input_sentence)).collect()
}

fn whiteness_sentence(whiteness: &Whiteness) -> String {
    let p = probability(whiteness.p_value);
    if whiteness.p_value >= 1.0 - CONFIDENCE {
        return format!("white ({p})");
    }
    let last = whiteness.lag_step_s * whiteness.correlation.len() as f64;
    let seconds = number(whiteness.correlated_s);
    match whiteness.correlated_s {
        correlated if correlated <= 0.0 => format!("not white ({p})"),
        correlated if correlated >= last => format!("correlated over {seconds} s and more ({p})"),
        _ => format!("correlated over {seconds} s ({p})"),
    }
}

fn input_sentence(correlation: &InputCorrelation) -> String {
    let acting = &correlation.acting;
    let p = probability(acting.p_value);
    if acting.p_value >= 1.0 - CONFIDENCE {
        return format!("steps of the input do not show ({p})");
    }
    let lag = number(acting.peak_lag_s.abs());
    let place = match acting.peak_lag_s {
        lag_s if lag_s.abs() < correlation.lag_step_s / 2.0 => "as they act".to_owned(),
        lag_s if lag_s > 0.0 => format!("{lag} s after they act"),
        _ => format!("{lag} s before they act"),
    };
    let percent = number((1000.0 * acting.share_outside).round() / 10.0);
    format!("steps of the input show, most {place} ({p}, {percent} % of lags)")
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
    let joint = compared.joint;
    let sentences = sentences(compared).into_iter();
    sentences.map(|sentence| format!("{} ({}): {sentence}", joint.name, compared.model)).collect()
}

/// Where a model fails, a sentence for each condition.
pub fn sentences(compared: &ComparedJoint<'_>) -> Vec<String> {
    let joint = compared.joint;
    let units = Units { input: joint.input_unit.clone(), output: joint.output_unit.clone() };
    let conditions = compared.comparison.failure.iter().flat_map(|failure| &failure.fails_where);
    conditions.map(|condition| condition.sentence(&units)).collect()
}

fn row(compared: &ComparedJoint<'_>) -> [String; 7] {
    let effects = effects(&compared.comparison.fit.model);
    let effects = if effects.is_empty() { "integrator".to_owned() } else { effects.join(" + ") };
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
    let verdict = lack_of_fit.map_or_else(dash, shown);
    let noise = noise_floor.map_or_else(dash, output);
    [rmse(training), rmse(validation), percent, noise, verdict]
}

/// Whether a lack of fit is shown, and by what.
fn shown(test: LackOfFit) -> String {
    let p_value = probability(test.p_value);
    match test.shown_by {
        None => format!("not shown ({p_value})"),
        _ if test.p_value < SIGNIFICANCE => format!("shown ({p_value})"),
        Some(ShownBy::FewWindows) => "shown (in few windows)".to_owned(),
        Some(ShownBy::UnseenPart) => "shown (on unseen data)".to_owned(),
        Some(ShownBy::Size | ShownBy::Shapes) => "shown (beyond noise)".to_owned(),
    }
}

/// The parameters of a model in one line.
pub(super) fn parameters(compared: &ComparedJoint<'_>) -> String {
    let fit = &compared.comparison.fit;
    let units = parameter_units(compared.joint, &fit.model);
    let parameter = |(parameter, unit): (&Parameter, String)| {
        let Parameter { name, value, std_error, status } = parameter;
        let error = std_error.map_or_else(String::new, |error| format!(" ± {}", number(error)));
        let remark = match status {
            Status::Fitted => "",
            Status::Fixed => " (fixed)",
            Status::AtBound => " (at its bound)",
            Status::Undetermined => " (not determined by this record)",
        };
        format!("{name} {}{error} {unit}{remark}", number(*value)).trim_end().to_owned()
    };
    let parameters: Vec<_> = fit.parameters.iter().zip(units).map(parameter).collect();
    format!("{}: {}; {}", compared.joint.name, parameters.join(", "), fit.termination)
}
