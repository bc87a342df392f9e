//! What a band about zero leaves of a signal: that of a valve's overlap, and that of a friction at rest.

use super::RecordRange;

/// Levels within a band that show that it is flat: with rest three points, where any curve through
/// rest may be low at one.
const FLAT: usize = 2;

/// Whether the input of `record` is held at levels within the band, at which the joint stands still:
/// from those outside alone a band is not distinguished from a curve that rises slowly at first.
pub(super) fn is_seen(lower: f64, upper: f64, record: &RecordRange<'_>) -> bool {
    let is_within = |level: &&f64| 0.0 < **level && **level < upper.max(-lower);
    record.input_levels.iter().filter(is_within).count() >= FLAT
}

/// `signal` less the band from `lower` to `upper`.
pub(super) fn shifted(signal: f64, lower: f64, upper: f64) -> f64 {
    (signal - upper).max(0.0) + (signal - lower).min(0.0)
}
