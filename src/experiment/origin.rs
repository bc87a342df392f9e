//! Where the times of a log count from.
//!
//! Clocks that count from 1970, or from when a machine was switched on, give times of many digits,
//! the first of which are the same in every row. Such times are counted from the log's first second.

/// Times from which on they are counted anew, in seconds: beyond it five digits leave no tenths.
const LATE_S: f64 = 1e4;

/// What the log's clock shows where its times are counted from, in seconds; `first_s` is the time of
/// its first row.
pub(super) fn origin_s(first_s: f64) -> f64 {
    // Whole seconds, so that the digits behind the point are those of the log.
    if first_s.is_finite() && first_s.abs() >= LATE_S { first_s.floor() } else { 0.0 }
}

/// The unit of times since 1970, known by their size: its seconds and its name.
pub(super) fn since_1970(first: f64) -> Option<(f64, &'static str)> {
    match first {
        // From the year 2001 to 2128 in each unit.
        1e9..5e9 => Some((1.0, "seconds")),
        1e12..5e12 => Some((1e-3, "milliseconds")),
        1e15..5e15 => Some((1e-6, "microseconds")),
        1e18..5e18 => Some((1e-9, "nanoseconds")),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_late_clock_counts_from_its_first_second() {
        let origins = [0.0, -3.5, 9999.9, f64::NAN, 86_400.25, 1.7e9].map(origin_s);
        assert_eq!(origins.map(|s| s.to_string()), ["0", "0", "0", "0", "86400", "1700000000"]);
    }

    #[test]
    fn the_unit_of_times_since_1970_is_told_by_their_size() {
        assert_eq!(since_1970(1.7e15), Some((1e-6, "microseconds")));
        assert_eq!(since_1970(86_400.0), None);
    }
}
