//! Sizes that drawings share, and the values that they span.

use crate::experiment::{Joint, Trial};

/// Width of a drawing by itself, in pixels.
pub(super) const WIDTH: u32 = 760;

/// Width of one of two beside one another.
pub(super) const HALF: u32 = 400;

/// Width of one of three.
pub(super) const NARROW: u32 = 350;

/// A signal's values in all trials.
pub(super) fn values_of(
    joint: &Joint,
    values: fn(&Trial) -> &[f64],
) -> impl Iterator<Item = f64> + '_ {
    joint.trials.iter().flat_map(move |trial| values(trial).iter().copied())
}
