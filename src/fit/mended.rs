//! What models are held against: a record without what its sensors added.

use crate::delay::held_inputs;
use crate::experiment::{Joint, Spikes};

/// `joint` with lines in the place of the `spikes` of its output, and with the levels that its input holds in the
/// place of its noise, which a model would take for changes of the command; none where it has neither.
pub(super) fn mended(joint: &Joint, spikes: &Spikes) -> Option<Joint> {
    let (without_spikes, inputs) = (spikes.taken_out(joint), held_inputs(&joint.trials));
    let Some(inputs) = inputs else { return without_spikes };
    let mut mended = without_spikes.unwrap_or_else(|| joint.clone());
    for (trial, input) in mended.trials.iter_mut().zip(inputs) {
        trial.set_input(input);
    }
    Some(mended)
}
