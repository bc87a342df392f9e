//! `compare`: models beside the measurement, as text and JSON.

use serde_json::{Value, json};

use super::TextTable;
use super::json::{document, without_empty};
use super::ladder::{errors_of, errors_table, figures};
use super::parameters::{model_text, parameters_json};
use crate::diagnosis::failure::{FailsWhere, WorstSegment};
use crate::diagnosis::{Comparison, ErrorFigures, ModelDifference, RegionPair};
use crate::experiment::{Joint, Trial};
use crate::fit::Horizon;
use crate::wording::{
    self, correlation_sentences, counted, effect_ids, effects_text, feature_with_level, measure,
    p_text,
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

impl<'a> ComparedJoint<'a> {
    /// What the model simulates in the trial with this place among those of the joint.
    pub(crate) fn simulated(&self, trial: usize) -> &'a [f64] {
        let all = &self.comparison.fit.evaluation.simulated;
        all.get(trial).map_or(&[], |simulated| simulated.output.as_slice())
    }

    /// What it leaves of the measured output there.
    pub(crate) fn residual(&self, trial: usize) -> &'a [f64] {
        self.comparison.fit.evaluation.residuals.get(trial).map_or(&[], Vec::as_slice)
    }
}

/// A heading, and a line for each joint and model of which there is something to say.
pub(crate) type Section = (String, Vec<String>);

/// A table of errors, one row per joint and model, the parameters below it, and how the first model
/// of each joint compares with its others.
pub(crate) fn compare_text(joints: &[ComparedJoint<'_>]) -> String {
    compare_table(joints) + &section_text(difference_section(joints))
}

/// A section below an empty line; nothing where there are no lines.
fn section_text((heading, lines): Section) -> String {
    if lines.is_empty() { String::new() } else { format!("\n{heading}:\n{}\n", lines.join("\n")) }
}

/// How the residuals of models are correlated, and where their errors arise.
pub(crate) fn sections(joints: &[ComparedJoint<'_>]) -> [Section; 2] {
    let arising = horizons_of(joints.iter().copied(), |comparison| comparison.arising);
    let failures = joints.iter().flat_map(failure_sentences).collect();
    let residuals = joints.iter().filter_map(residual_line).collect();
    [
        ("residual of the training part".to_owned(), residuals),
        (format!("where the error arises ({arising})"), failures),
    ]
}

/// How the first model of each joint compares with its others.
pub(crate) fn difference_section(joints: &[ComparedJoint<'_>]) -> Section {
    let differences = model_differences(joints);
    let line = |of: &ComparedModels<'_>, said| format!("{}: {said}", of.joint.name);
    let lines = differences.iter().flat_map(|of| of.sentences().into_iter().map(|it| line(of, it)));
    let lines = lines.collect();
    ("one model against another".to_owned(), lines)
}

/// A table of errors, one row per joint and model, and the parameters below it.
pub(crate) fn compare_table(joints: &[ComparedJoint<'_>]) -> String {
    let row = |of: &ComparedJoint<'_>| {
        let effects = effects_text(&of.comparison.fit.model);
        ([of.joint.name.clone(), effects], figures(of.joint, &errors_of(of.comparison)))
    };
    let table = errors_table(["joint", "model"], joints.iter().map(row));
    let model = |of: &ComparedJoint<'_>| model_text(of.joint, of.comparison, Some(of.model));
    let models: Vec<_> = joints.iter().map(model).collect();
    let sections = sections(joints).map(section_text).concat();
    let (horizon, models) = (horizons(joints.iter().copied()), models.join("\n"));
    format!("{table}\n{}\n\n{models}\n{sections}", errors_note(&horizon))
}

/// The errors of models of one joint, a column each.
pub(crate) fn model_table(models: &[ComparedJoint<'_>]) -> TextTable {
    let header = ["model", "training", "validation", "raw", "free run", "fit", "lack of fit"];
    let row = |of: &ComparedJoint<'_>| {
        let [training, validation, raw, free, fit, _, lack] =
            figures(of.joint, &errors_of(of.comparison));
        [of.model.to_owned(), training, validation, raw, free, fit, lack]
    };
    TextTable::of(header, &[], models.iter().map(row)).turned()
}

/// The first model of a joint beside another one.
#[derive(Debug)]
struct ComparedModels<'a> {
    joint: &'a Joint,
    model: &'a str,
    other: &'a str,
    difference: ModelDifference,
}

impl ComparedModels<'_> {
    /// Which of the two is better, how surely, and where.
    fn sentences(&self) -> Vec<String> {
        let Self { joint, model, other, difference: found } = self;
        let unit = joint.output_unit.as_deref();
        let part = if found.is_validation { "validation part" } else { "whole record" };
        let steps = counted(found.steps, "step");
        let (own, others) = (measure(found.rmse, unit), measure(found.other_rmse, unit));
        let errors = format!(
            "error {own} of {model}, {others} of {other} ({steps} of the {part}, restarted at each); \
             {model} is better in {} of them",
            found.better_steps
        );
        let better = if found.rmse < found.other_rmse { model } else { other };
        let test = found.test.map_or_else(
            || "too few steps, or no difference, to test whether it is more than chance".to_owned(),
            |test| {
                let p = p_text(test.p_value);
                let said = if found.is_significant() == Some(true) {
                    format!("{better} is better by more than chance")
                } else {
                    "the difference may be chance".to_owned()
                };
                format!("{said} ({p}, Diebold and Mariano's test over the steps)")
            },
        );
        let places = [(&found.better_where, model), (&found.worse_where, other)];
        let places = places.into_iter().filter(|(pairs, _)| !pairs.is_empty());
        let places = places.map(|(pairs, name)| {
            let place = |pair: &RegionPair| {
                let (own, others) =
                    (measure(pair.region.rmse, unit), measure(pair.other_rmse, unit));
                format!("{} ({own}, {others})", feature_with_level(joint, &pair.region))
            };
            let places: Vec<_> = pairs.iter().map(place).collect();
            format!("where {name} is better (error of {model}, of {other}): {}", places.join("; "))
        });
        [errors, test].into_iter().chain(places).collect()
    }
}

/// The first model of each joint beside each of its others.
fn model_differences<'a>(joints: &[ComparedJoint<'a>]) -> Vec<ComparedModels<'a>> {
    let mut found = Vec::new();
    for (index, other) in joints.iter().enumerate() {
        let of_joint = |it: &&ComparedJoint<'a>| it.joint.name == other.joint.name;
        let before = joints.get(..index).unwrap_or_default();
        let Some(first) = before.iter().find(of_joint) else { continue };
        let difference = ModelDifference::of(first.comparison, other.comparison);
        found.extend(difference.map(|difference| ComparedModels {
            joint: first.joint,
            model: first.model,
            other: other.model,
            difference,
        }));
    }
    found
}

/// Where the simulations of `joints` were restarted: `restarted every 2 s`, each way once.
pub(crate) fn horizons<'a>(joints: impl IntoIterator<Item = ComparedJoint<'a>>) -> String {
    horizons_of(joints, |comparison| comparison.fit.evaluation.horizon)
}

fn horizons_of<'a>(
    joints: impl IntoIterator<Item = ComparedJoint<'a>>,
    which: fn(&Comparison) -> Horizon,
) -> String {
    let mut horizons: Vec<String> = Vec::new();
    for horizon in joints.into_iter().map(|joint| which(joint.comparison).to_string()) {
        if !horizons.contains(&horizon) {
            horizons.push(horizon);
        }
    }
    horizons.join(" or ")
}

/// How the residual of a joint is correlated, in a line.
fn residual_line(compared: &ComparedJoint<'_>) -> Option<String> {
    let parts = correlation_sentences(compared.comparison);
    (!parts.is_empty())
        .then(|| format!("{} ({}): {}", compared.joint.name, compared.model, parts.join("; ")))
}

/// Where a model fails, in lines that start with the joint.
fn failure_sentences(compared: &ComparedJoint<'_>) -> Vec<String> {
    let ComparedJoint { joint, comparison, .. } = compared;
    let fails = wording::fails_or_errs(comparison);
    let sentences = wording::failure_sentences(joint, comparison).into_iter();
    sentences
        .map(|sentence| format!("{} ({}) {fails} {sentence}", joint.name, compared.model))
        .collect()
}

/// What the errors of a table are.
pub(crate) fn errors_note(horizon: &str) -> String {
    format!(
        "root-mean-square errors, {horizon}; training, validation: on the fitted and on the other \
         part of the record, less the mean of each run between restarts; raw: validation, nothing \
         subtracted; free run: each trial simulated from its start; fit: 100 % is a perfect match \
         of the validation part; noise: of the sensor; ± is one standard error"
    )
}

/// A model and how it compares with the measurement; `fails_horizon` is where the simulation restarts
/// of which `fails_where` and `regions` are.
pub(super) fn model_json(compared: &ComparedJoint<'_>) -> Value {
    let ComparedJoint { joint, model, revision, comparison } = compared;
    let conditions = comparison.failure.iter().flat_map(|failure| &failure.fails_where);
    let segments = comparison.failure.iter().flat_map(|failure| &failure.worst_segments);
    json!({
        "joint": joint.name,
        "model": model,
        "revision": revision,
        "effects": effect_ids(&comparison.fit.model),
        "parameters": parameters_json(joint, &comparison.fit),
        "error": error_json(comparison),
        "lack_of_fit": comparison.lack_of_fit,
        "whiteness": comparison.whiteness,
        "input_correlation": comparison.input_correlation,
        "fails_horizon": comparison.arising.to_string(),
        "fails_where": conditions.map(condition).collect::<Value>(),
        "worst_segments": segments.map(|worst| segment(worst, joint)).collect::<Value>(),
        "regions": comparison.regions,
        "curves": comparison.curves,
        "termination": comparison.termination.to_string(),
    })
}

/// The error on both parts, and the noise, which has the older name `noise_floor` as well.
pub(super) fn error_json(comparison: &Comparison) -> Value {
    let Comparison { training, validation, raw, free, sensor_noise, .. } = comparison;
    json!({
        "train": training.map(|error| part_json(error, raw.training, free.training)),
        "validation": validation.map(|error| part_json(error, raw.validation, free.validation)),
        "sensor_noise": sensor_noise,
        "noise_floor": sensor_noise,
    })
}

/// The figures of one part, with the errors from which nothing is removed: restarted, and of a free
/// run.
fn part_json(error: ErrorFigures, rmse_raw: Option<f64>, rmse_free: Option<f64>) -> Value {
    json!({
        "rmse": error.rmse,
        "rmse_raw": rmse_raw,
        "rmse_free": rmse_free,
        "fit_percent": error.fit_percent,
        "max": error.max,
    })
}

fn condition(found: &FailsWhere) -> Value {
    json!({
        "condition": found.condition,
        "share_of_time": found.share_of_time,
        "share_of_squared_error": found.share_of_squared_error,
        "error_of": if found.of_speed { "speed" } else { "output" },
        "rmse": found.rmse,
        "p_value": found.p_value,
    })
}

/// With times by the clock of the log.
fn segment(worst: &WorstSegment, joint: &Joint) -> Value {
    let trial = joint.trials.iter().find(|trial| trial.label() == worst.trial);
    let origin_s = trial.map_or(0.0, Trial::origin_s);
    json!({
        "trial": worst.trial,
        "start_s": origin_s + worst.start_s,
        "end_s": origin_s + worst.end_s,
        "rmse": worst.rmse,
        "largest_residual": worst.largest_residual,
        "share_of_squared_error": worst.share_of_squared_error,
    })
}

/// The document of `compare --format json`.
pub(crate) fn compare_json(joints: &[ComparedJoint<'_>], failures: &[String]) -> Value {
    let facts = json!({
        "joints": joints.iter().map(model_json).collect::<Value>(),
        "against": model_differences(joints).iter().map(against).collect::<Value>(),
        "failures": failures,
    });
    document("tauscope/compare/1", without_empty(facts, &["against"]))
}

/// The first model of a joint beside another one.
fn against(models: &ComparedModels<'_>) -> Value {
    let ComparedModels { joint, model, other, difference } = models;
    json!({
        "joint": joint.name,
        "model": model,
        "other": other,
        "steps": difference.steps,
        "validation": difference.is_validation,
        "rmse": difference.rmse,
        "other_rmse": difference.other_rmse,
        "better_steps": difference.better_steps,
        "statistic": difference.test.map(|test| test.statistic),
        "p_value": difference.test.map(|test| test.p_value),
        "significant": difference.is_significant(),
        "better_where": difference.better_where,
        "worse_where": difference.worse_where,
    })
}
