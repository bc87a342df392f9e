//! Times of day, which begin anew at midnight.

use super::repair::Repair;
use super::wrap::Wrap;
use crate::experiment::log::{Log, Times};

pub(super) struct Midnight;

impl Repair for Midnight {
    fn detect(log: &Log<'_>) -> impl IntoIterator<Item = Self> {
        let column = log.layout.time.column().and_then(|column| log.column(column));
        column.filter(|column| column.are_dates || column.are_of_day).map(|_| Self)
    }

    fn apply(self, log: &mut Log<'_>) -> Option<String> {
        if let Times::Stamps(times) = &mut log.times {
            count_over_midnight(times);
        }
        None
    }
}

/// Counts times of day on over midnight.
fn count_over_midnight(times: &mut [f64]) {
    if times.iter().all(|time| (0.0..Wrap::DAY_S).contains(time)) {
        Wrap::OF_CLOCK.unwrap(times);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_of_day_count_on_over_midnight() {
        let mut times = [86_399.98, 86_399.99, 0.0, 0.01];
        count_over_midnight(&mut times);
        let in_ms = times.map(|time| (1e3 * time).round());
        assert_eq!(
            in_ms.map(|ms| format!("{ms}")),
            ["86399980", "86399990", "86400000", "86400010"]
        );
        let mut unsorted = [86_399.98, 0.0, 86_399.99, 0.01];
        count_over_midnight(&mut unsorted);
        let in_ms = unsorted.map(|time| format!("{}", (1e3 * time).round()));
        assert_eq!(in_ms, ["86399980", "86400000", "86399990", "86400010"]);
        // A log that begins anew, and a time that has passed, of which hours are more than 24.
        for times in [[50.0, 60.0, 40.0, 50.0], [86_399.0, 86_400.0, 0.0, 1.0]] {
            let mut counted = times;
            count_over_midnight(&mut counted);
            assert_eq!(counted.map(f64::to_bits), times.map(f64::to_bits));
        }
    }
}
