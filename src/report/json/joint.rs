//! A joint and its model, as every command that fits models shows them.

use serde::Serialize;
use serde_json::{Map, Value, json};

use super::misfit::{
    CorrelationJson, CurveJson, FailsWhereJson, FiguresJson, LackOfFitJson, RegionJson,
    WhitenessJson, WorstSegmentJson,
};
use crate::diagnosis::{Comparison, ErrorFigures};
use crate::experiment::Joint;
use crate::fit::{AssessedModel, Parameter, Status};
use crate::report::compare::ComparedJoint;
use crate::wording::{effect_ids, parameter_units};

/// A model and how it compares with the measurement.
#[derive(Debug, Serialize)]
pub(super) struct JointJson<'a> {
    joint: &'a str,
    model: &'a str,
    revision: u32,
    effects: Vec<&'static str>,
    parameters: Map<String, Value>,
    error: ErrorJson,
    lack_of_fit: Option<LackOfFitJson>,
    whiteness: Option<WhitenessJson<'a>>,
    input_correlation: Option<CorrelationJson<'a>>,
    /// Where the simulation restarts of which `fails_where` and `regions` are.
    fails_horizon: String,
    fails_where: Vec<FailsWhereJson<'a>>,
    worst_segments: Vec<WorstSegmentJson<'a>>,
    regions: Vec<RegionJson<'a>>,
    curves: Vec<CurveJson<'a>>,
    termination: String,
}

/// The error on both parts, and the noise.
#[derive(Debug, Serialize)]
pub(super) struct ErrorJson {
    train: Option<FiguresJson>,
    validation: Option<FiguresJson>,
    sensor_noise: Option<f64>,
    /// The number of `sensor_noise`, under its older name.
    noise_floor: Option<f64>,
}

impl<'a> JointJson<'a> {
    pub(super) fn new(compared: &ComparedJoint<'a>) -> Self {
        let comparison = compared.comparison;
        let failure = || comparison.failure.iter();
        Self {
            joint: &compared.joint.name,
            model: compared.model,
            revision: compared.revision,
            effects: effect_ids(&comparison.fit.model),
            parameters: parameters(compared.joint, &comparison.fit),
            error: ErrorJson::new(comparison),
            lack_of_fit: comparison.lack_of_fit.as_ref().map(Into::into),
            whiteness: comparison.whiteness.as_ref().map(Into::into),
            input_correlation: comparison.input_correlation.as_ref().map(Into::into),
            fails_horizon: comparison.arising.to_string(),
            fails_where: failure().flat_map(|f| &f.fails_where).map(Into::into).collect(),
            worst_segments: failure()
                .flat_map(|f| &f.worst_segments)
                .map(|worst| WorstSegmentJson::new(worst, compared.joint))
                .collect(),
            regions: comparison.regions.iter().map(Into::into).collect(),
            curves: comparison.curves.iter().map(Into::into).collect(),
            termination: comparison.termination.to_string(),
        }
    }
}

impl ErrorJson {
    pub(super) fn new(comparison: &Comparison) -> Self {
        let Comparison { training, validation, raw, free, sensor_noise, .. } = comparison;
        let figures = |error: &ErrorFigures, raw, free| FiguresJson::new(error, raw, free);
        let train = training.as_ref().map(|e| figures(e, raw.training, free.training));
        let unseen = validation.as_ref().map(|e| figures(e, raw.validation, free.validation));
        Self { train, validation: unseen, sensor_noise: *sensor_noise, noise_floor: *sensor_noise }
    }
}

/// Parameters by name, with their standard errors and units.
pub(super) fn parameters(joint: &Joint, fit: &AssessedModel) -> Map<String, Value> {
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
        Status::Undetermined | Status::BeyondReach => "undetermined",
    }
}
