//! Which sample periods a log may have.

/// Whether samples may be so many seconds apart: from a nanosecond to three years, beyond which the
/// times of a record leave what a clock counts.
pub(crate) fn is_period(seconds: f64) -> bool {
    (1e-9..=1e8).contains(&seconds)
}
