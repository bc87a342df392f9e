//! A joint and its model, as every command that fits models shows them.

use serde_json::{Value, json};

use crate::diagnosis::failure::{FailsWhere, WorstSegment};
use crate::diagnosis::{Comparison, ErrorFigures};
use crate::experiment::{Joint, Trial};
use crate::report::compare::ComparedJoint;
use crate::report::parameters::parameters_json;
use crate::wording::effect_ids;

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
        "train": training.map(|error| figures(error, raw.training, free.training)),
        "validation": validation.map(|error| figures(error, raw.validation, free.validation)),
        "sensor_noise": sensor_noise,
        "noise_floor": sensor_noise,
    })
}

/// The figures of one part, with the errors from which nothing is removed: restarted, and of a free
/// run.
fn figures(error: ErrorFigures, rmse_raw: Option<f64>, rmse_free: Option<f64>) -> Value {
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
