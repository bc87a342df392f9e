//! The delay of a model beside the delays that were measured.

use super::{DelayRange, EstimatedJoint, JointSummary};
use crate::delay::Finding;
use crate::effect::Stage;
use crate::fit::{AssessedModel, Status};
use crate::wording::parameter_value;

/// What is to be said of the delay of a model: its value beside the measured ones, where it is one
/// number that a fit found, or that is fixed.
pub(super) fn model_delay(of: &AssessedModel, measured: EstimatedJoint<'_>) -> Option<String> {
    let is_law =
        of.model.components().iter().any(|part| part.effect().spec().stage == Stage::Transport);
    let delay =
        of.parameters.iter().find(|parameter| parameter.name == "delay").filter(|_| !is_law)?;
    let measured = match measured.estimate.dead_time.as_ref().map(|found| found.finding) {
        Some(Finding::Known(bounds) | Finding::LagOnly(bounds)) => {
            format!("the dead time of the record is {:.3} to {:.3} s", bounds.low_s, bounds.high_s)
        }
        Some(Finding::Unknown(_)) => return None,
        None => {
            let DelayRange { min, median, max } = JointSummary::of(measured).delay_s?;
            format!("those measured at the steps are {min:.3} to {max:.3} s, median {median:.3} s")
        }
    };
    let fitted = if delay.status == Status::Fixed {
        ""
    } else {
        " A measured delay includes lags after it, which a model may describe by another effect."
    };
    Some(format!("The delay of the model is {}; {measured}.{fitted}", parameter_value(delay, "s")))
}
