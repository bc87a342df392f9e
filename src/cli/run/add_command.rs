//! The command that adds an effect to a model, to be suggested.

use crate::cli::args::{DataArgs, ProtocolArgs};
use crate::cli::typed::quoted;
use crate::experiment::Joint;

/// What follows the effect in the command that adds it to the model of a joint, for each of
/// `joints`; the model is in the file `model`.
pub(crate) fn add_arguments(
    data: &DataArgs,
    protocol: &ProtocolArgs,
    model: &str,
    joints: &[Joint],
) -> Vec<String> {
    let of_joint = |joint: &Joint| {
        let one_of_several = (joints.len() > 1).then_some(joint.name.as_str());
        let mut words = data.typed(one_of_several);
        words.extend(["--model".to_owned(), model.to_owned()]);
        words.extend(protocol.typed());
        quoted(&words)
    };
    joints.iter().map(of_joint).collect()
}
