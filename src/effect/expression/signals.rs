//! What an expression sees of the joint.

use super::super::{InputChange, Moment, Stage};

/// The angle of the joint.
pub(super) const POSITION: &str = "position";

/// The activity of the other joints.
pub(super) const OTHERS: &str = "others";

/// What an expression of any stage but the transport sees of a [`Moment`].
const SIGNALS: [&str; 7] = ["signal", POSITION, "velocity", "time", "dt", OTHERS, "radians"];

/// What an expression of the transport stage sees of an [`InputChange`].
const CHANGES: [&str; 4] = ["before", "after", "held", "time"];

/// The names of what an expression of this stage sees.
pub(super) fn signals(stage: Stage) -> &'static [&'static str] {
    if stage == Stage::Transport { &CHANGES } else { &SIGNALS }
}

/// The values of [`SIGNALS`].
pub(super) fn of_moment(at: &Moment) -> [f64; 7] {
    let Moment { signal, position, velocity, time_s, dt_s, others, .. } = *at;
    [signal, position, velocity, time_s, dt_s, others, at.radians_per_output_unit]
}

/// The values of [`CHANGES`].
pub(super) fn of_change(change: &InputChange) -> [f64; 4] {
    [change.before, change.after, change.held_s, change.time_s]
}
