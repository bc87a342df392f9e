//! Why a model is a first order with dead time.

use crate::experiment::Joint;
use crate::fit::{AssessedModel, follows_input, time_constant_s};
use crate::wording::rounded;

/// `The output follows the input itself, not its integral (r² 0.93): the model is a first order
/// with dead time, of time constant 0.16 s.`
pub(super) fn first_order(joint: &Joint, of: &AssessedModel) -> Option<String> {
    let time_constant_s = time_constant_s(&of.model)?;
    let r_squared = follows_input(joint)?;
    Some(format!(
        "The output follows the input itself, not its integral (r² {r_squared:.2}): the model is \
         a first order with dead time, of time constant {} s.",
        rounded(time_constant_s)
    ))
}
