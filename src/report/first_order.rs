//! Why a model is a first order with dead time.

use crate::experiment::Joint;
use crate::fit::{Assessment, follows_input};
use crate::wording::rounded;

/// `The output follows the input itself, not its integral (r² 0.93): the model is a first order
/// with dead time, of time constant 0.16 s.`
pub(super) fn first_order(joint: &Joint, of: &Assessment) -> Option<String> {
    let rate = of.parameters.iter().find(|parameter| parameter.name == "leakage.rate")?;
    let r_squared = follows_input(joint).filter(|_| rate.value > 0.0)?;
    Some(format!(
        "The output follows the input itself, not its integral (r² {r_squared:.2}): the model is \
         a first order with dead time, of time constant {} s.",
        rounded(1.0 / rate.value)
    ))
}
