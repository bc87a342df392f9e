//! Outputs that are mended, one after the other.

use crate::experiment::layout::JointLayout;
use crate::experiment::log::Log;

/// The values of an output as they are mended, and what is said of it.
pub(super) type Mended = (Vec<f64>, Option<String>);

/// Mends each output that needs it.
pub(super) fn mend_outputs(
    log: &mut Log<'_>,
    mend: impl Fn(&Log<'_>, &JointLayout) -> Option<Mended>,
) {
    for joint in log.with_own_outputs() {
        let Some((values, note)) = mend(log, joint) else { continue };
        if let Some(column) = log.column_mut(joint.output.column) {
            column.values = values;
        }
        if let Some(note) = note {
            log.note_on(joint, &note);
        }
    }
}
