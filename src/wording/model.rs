//! What a model consists of: its effects, and its parameters with status, certainty and units.

use super::{number, with_error};
use crate::effect::{Dimension, is_unlimited};
use crate::experiment::Joint;
use crate::fit::{Parameter, Status};
use crate::model::{Component, JointModel};

/// What is remarkable about how a parameter was found; nothing where it was simply fitted.
fn remark(status: Status) -> Option<&'static str> {
    match status {
        Status::Fitted => None,
        Status::Fixed => Some("fixed"),
        Status::AtBound => Some("at its bound"),
        Status::Undetermined | Status::BeyondReach => Some("not determined by this record"),
    }
}

/// A parameter to the digits that its standard error leaves, with its unit and what is remarkable
/// about it: `0.612 ± 0.021 V`, `2.3 s (fixed)`, `none` for a limit that there is not.
pub(crate) fn parameter_value(parameter: &Parameter, unit: &str) -> String {
    /// A smaller value at a bound is the bound 0 but for rounding.
    const NONE: f64 = 1e-12;
    let Parameter { value, std_error, status, .. } = parameter;
    if is_unlimited(*value) {
        return "none".to_owned();
    }
    let is_zero = *status == Status::AtBound && value.abs() < NONE;
    let value = if is_zero { &0.0 } else { value };
    let known = std_error.map_or_else(|| number(*value), |error| with_error(*value, error));
    let remark = remark(*status).map_or_else(String::new, |remark| format!(" ({remark})"));
    format!("{}{remark}", format!("{known} {unit}").trim_end())
}

/// Units of a model's parameters, in the order of [`JointModel::values`].
pub(crate) fn parameter_units(joint: &Joint, model: &JointModel) -> Vec<String> {
    let unit = |unit: &Option<String>, kind: &str| unit.clone().unwrap_or_else(|| kind.to_owned());
    let (input, output) = (unit(&joint.input_unit, "input"), unit(&joint.output_unit, "output"));
    let own = [format!("{output}/s/{input}"), "s".to_owned()].into_iter();
    let of_signal = |name: &str| {
        let signal = joint.covariates.iter().find(|signal| signal.name == name);
        signal.and_then(|signal| signal.unit.as_deref())
    };
    let of = |component: &Component, dimension: Dimension| match dimension {
        Dimension::Signal | Dimension::PerSignal => {
            dimension.of_signal(component.effect().measured_signal().and_then(of_signal))
        }
        _ => dimension.unit(Some(&input), Some(&output)),
    };
    let parameters = model.components().iter().flat_map(|component| {
        let parameters = component.effect().spec().parameters.iter();
        parameters.map(move |parameter| of(component, parameter.dimension))
    });
    own.chain(parameters).collect()
}

/// Ids of the effects of a model, in its order.
pub(crate) fn effect_ids(model: &JointModel) -> Vec<&'static str> {
    model.components().iter().map(|component| component.effect().spec().id).collect()
}

/// `dead_band + stiction`; a model without effects is an integrator.
pub(crate) fn effects_text(model: &JointModel) -> String {
    effects_named(&effect_ids(model))
}

/// As [`effects_text`], of the ids of effects.
pub(crate) fn effects_named(ids: &[&str]) -> String {
    if ids.is_empty() { "integrator".to_owned() } else { ids.join(" + ") }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_limit_is_none_and_a_large_number_is_a_number() {
        let said = |value: f64| {
            let (name, std_error, status) = ("gain".to_owned(), None, Status::Fitted);
            parameter_value(&Parameter { name, value, std_error, status }, "deg/s/V")
        };
        assert_eq!([1e12, -1e12].map(said), ["none", "none"]);
        assert_eq!(said(5e13), format!("{} deg/s/V", number(5e13)));
    }
}
