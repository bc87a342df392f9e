//! Fitted parameters: status, certainty and units.

use super::number;
use crate::effect::Dimension;
#[cfg(feature = "rrd")]
use crate::effect::UNLIMITED;
use crate::experiment::Joint;
use crate::fit::{Parameter, Status};
use crate::model::JointModel;

/// What is remarkable about how a parameter was found; nothing where it was simply fitted.
pub(crate) fn remark(status: Status) -> Option<&'static str> {
    match status {
        Status::Fitted => None,
        Status::Fixed => Some("fixed"),
        Status::AtBound => Some("at its bound"),
        Status::Undetermined | Status::BeyondReach => Some("not determined by this record"),
    }
}

/// `text` with the remark in brackets behind it, where there is one.
pub(crate) fn with_remark(text: &str, status: Status) -> String {
    let remark = remark(status).map_or_else(String::new, |remark| format!(" ({remark})"));
    format!("{}{remark}", text.trim_end())
}

/// The standard error of a parameter, or why it has none.
pub(crate) fn certainty(parameter: &Parameter) -> String {
    match (remark(parameter.status), parameter.std_error) {
        (Some(remark), _) => remark.to_owned(),
        (None, Some(error)) => number(error),
        (None, None) => "not determined by this record".to_owned(),
    }
}

/// The value of a parameter with its unit; `none` for a limit that there is not.
#[cfg(feature = "rrd")]
pub(crate) fn parameter_value(parameter: &Parameter, unit: &str) -> String {
    if parameter.value.abs() >= UNLIMITED {
        return "none".to_owned();
    }
    format!("{} {unit}", number(parameter.value))
}

/// Units of a model's parameters, in the order of [`JointModel::values`].
pub(crate) fn parameter_units(joint: &Joint, model: &JointModel) -> Vec<String> {
    let unit = |unit: &Option<String>, kind: &str| unit.clone().unwrap_or_else(|| kind.to_owned());
    let (input, output) = (unit(&joint.input_unit, "input"), unit(&joint.output_unit, "output"));
    let own = [format!("{output}/s/{input}"), "s".to_owned()].into_iter();
    let of = |dimension: Dimension| dimension.unit(Some(&input), Some(&output));
    let parameters = model.components().iter().flat_map(|c| c.effect().spec().parameters);
    own.chain(parameters.map(|parameter| of(parameter.dimension))).collect()
}
