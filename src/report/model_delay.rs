//! The delay of a model beside the delays that were measured.

use super::EstimatedJoint;
use super::summary::{DelayRange, JointSummary};
use crate::effect::Stage;
use crate::fit::{Assessment, Status};
use crate::model::Component;

/// Measured delays that a model's is held against, at least.
const FEWEST: usize = 3;

/// Standard errors that a fitted delay is off at most by chance.
const BY_CHANCE: f64 = 3.0;

/// Why a fitted delay is shorter than those measured: a step seems late by the lag behind it, too.
fn why_shorter(of: &Assessment) -> String {
    let is_lag = |component: &&Component| component.effect().spec().stage == Stage::Dynamics;
    match of.model.components().iter().find(is_lag) {
        Some(lag) => {
            format!("those include the lag that the model describes by {}", lag.effect().spec().id)
        }
        None => "with it the fit makes up for a motion that the model has too slow after a step"
            .to_owned(),
    }
}

/// What is to be said of the delay of a model: that it was held, or that it lies outside the
/// delays that were measured, and why a fit puts it there. Nothing of a delay that a law gives
/// to each step.
pub(super) fn model_delay(of: &Assessment, measured: EstimatedJoint<'_>) -> Option<String> {
    let by_law = |component: &Component| component.effect().spec().stage == Stage::Transport;
    let is_constant = !of.model.components().iter().any(by_law);
    let summary = JointSummary::of(measured);
    let measured = summary.delay_s.filter(|_| is_constant && summary.accepted >= FEWEST)?;
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
            "The fitted delay, {value:.3} s, is below all that were measured ({range}): {}.",
            why_shorter(of)
        )),
        _ if value - leeway > max => Some(format!(
            "The fitted delay, {value:.3} s, is above all that were measured ({range}): with it \
             the fit makes up for a motion that the model has too fast after a step."
        )),
        _ => None,
    }
}
