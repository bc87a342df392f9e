//! The delay of a model beside the delays that were measured.

use super::EstimatedJoint;
use super::summary::{DelayRange, JointSummary};
use crate::effect::Stage;
use crate::fit::{Assessment, Status};
use crate::model::Component;

/// Standard errors that a fitted delay is off at most by chance.
const BY_CHANCE: f64 = 3.0;

/// What is to be said of the delay of a model: that it was held, or that it lies outside the
/// delays that were measured, and why a fit puts it there. Nothing of a delay that a law gives
/// to each step.
pub(super) fn model_delay(of: &Assessment, measured: EstimatedJoint<'_>) -> Option<String> {
    let by_law = |component: &Component| component.effect().spec().stage == Stage::Transport;
    let is_constant = !of.model.components().iter().any(by_law);
    let measured = JointSummary::of(measured).delay_s.filter(|_| is_constant)?;
    let delay = of.parameters.iter().find(|parameter| parameter.name == "delay")?;
    let (value, leeway) = (delay.value, BY_CHANCE * delay.std_error.unwrap_or(0.0));
    let DelayRange { min, median, max } = measured;
    let range = format!("{min:.3} to {max:.3} s, median {median:.3} s");
    match delay.status {
        Status::Fixed => Some(format!(
            "The delay of the model is held at {value:.3} s; those measured at the steps are \
             {range}."
        )),
        _ if value + leeway < min => Some(format!(
            "The fitted delay, {value:.3} s, is below all that were measured ({range}): with it \
             the fit makes up for a motion that the model has too slow after a step."
        )),
        _ if value - leeway > max => Some(format!(
            "The fitted delay, {value:.3} s, is above all that were measured ({range}): with it \
             the fit makes up for a motion that the model has too fast after a step."
        )),
        _ => None,
    }
}
