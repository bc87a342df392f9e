//! What a band about zero leaves of a signal: that of a valve's overlap, and that of a friction at rest.

/// `signal` less the band from `lower` to `upper`.
pub(super) fn shifted(signal: f64, lower: f64, upper: f64) -> f64 {
    (signal - upper).max(0.0) + (signal - lower).min(0.0)
}
