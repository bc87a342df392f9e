//! Why a model is a first order with dead time.

use crate::experiment::Joint;
use crate::fit::Assessment;
use crate::model::settling;
use crate::wording::rounded;

/// `The output settles at a level that follows the input (16 holds, r² 0.93): the model is a first
/// order with dead time, of time constant 0.16 s.`
pub(super) fn first_order(joint: &Joint, of: &Assessment) -> Option<String> {
    let rate = of.parameters.iter().find(|parameter| parameter.name == "leakage.rate")?;
    let settling = settling(joint).filter(|_| rate.value > 0.0)?;
    Some(format!(
        "The output settles at a level that follows the input ({} holds, r² {:.2}): the model is \
         a first order with dead time, of time constant {} s.",
        settling.holds,
        settling.r_squared,
        rounded(1.0 / rate.value)
    ))
}
