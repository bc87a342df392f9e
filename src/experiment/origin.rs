//! Where the times of a log count from.
//!
//! Clocks that count from 1970, or from when a machine was switched on, give times of many digits,
//! the first of which are the same in every row. Such times are counted from the log's first second.

/// Times from which on they are counted anew, in seconds: beyond it five digits leave no tenths.
const LATE_S: f64 = 1e4;

/// What the log's clock shows where its times are counted from, in seconds; `first_s` is the time of
/// its first row.
fn origin_s(first_s: f64) -> f64 {
    // Whole seconds, so that the digits after the point are those of the log.
    if first_s.is_finite() && first_s.abs() >= LATE_S { first_s.floor() } else { 0.0 }
}

/// How the times of a log count.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Counting {
    /// Their column.
    pub(super) column: usize,
    /// The time of the first row, as it stands there.
    pub(super) first: f64,
    /// Seconds of their unit.
    seconds: f64,
    /// What the clock shows in 1970; 0 of one that does not know the date.
    in_1970: f64,
    /// The name in words of a unit that is known by the size of the times.
    name: &'static str,
    /// Whether the unit is named in the log.
    pub(super) is_named: bool,
}

/// Seconds of a unit, what a clock that counts in it shows in 1970, and its name in words.
type Size = (f64, f64, &'static str);

impl Counting {
    /// How these times of a column count: in the unit of `named` seconds where that is known, else as their size
    /// says.
    pub(super) fn of(column: usize, times: &[f64], named: Option<f64>) -> Self {
        let first = times.iter().copied().find(|time| !time.is_nan()).unwrap_or_default();
        let later = times.iter().copied().find(|time| *time > first).unwrap_or(f64::NAN);
        let by_size = || since_1970(first).or_else(|| in_days(first, later - first));
        let unit = named.map(|seconds| (seconds, 0.0, "")).or_else(by_size);
        let (seconds, in_1970, name) = unit.unwrap_or((1.0, 0.0, ""));
        Self { column, first, seconds, in_1970, name, is_named: named.is_some() }
    }

    /// The name of its unit, where that is known by the size of its times and is not the second.
    pub(super) fn inferred_unit(self) -> Option<&'static str> {
        #[expect(clippy::float_cmp, reason = "seconds are 1 as it was written")]
        let is_second = self.seconds == 1.0;
        (!is_second && !self.name.is_empty()).then_some(self.name)
    }

    /// The time that the clock shows as `value`, in seconds.
    pub(super) fn seconds_of(self, value: f64) -> f64 {
        (value - self.in_1970) * self.seconds
    }

    /// What the log's clock shows where its times are counted from, in seconds.
    pub(super) fn origin_s(self) -> f64 {
        origin_s(self.seconds_of(self.first))
    }

    /// Whether the unit of the times is named, or plain from their size.
    pub(super) fn is_known(self) -> bool {
        self.is_named || !self.name.is_empty()
    }
}

/// The unit of times since 1970, known by their size.
fn since_1970(first: f64) -> Option<Size> {
    let of = |seconds, name| Some((seconds, 0.0, name));
    match first {
        // From the year 2001 to 2128 in each unit.
        1e9..5e9 => of(1.0, "seconds since 1970"),
        1e12..5e12 => of(1e-3, "milliseconds since 1970"),
        1e15..5e15 => of(1e-6, "microseconds since 1970"),
        1e18..5e18 => of(1e-9, "nanoseconds since 1970"),
        _ => None,
    }
}

/// Dates as numbers of days: of spreadsheets, from the end of 1899 on, and those of MATLAB's
/// `datenum`, from the year 0. No log in seconds has samples so near to one another, so long after its
/// clock began.
fn in_days(first: f64, step: f64) -> Option<Size> {
    /// Days between two samples, at most: two seconds.
    const MOST: f64 = 2.5e-5;
    let of = |in_1970, name| Some((86_400.0, in_1970, name));
    if !(step > 0.0 && step < MOST) {
        return None;
    }
    match first {
        // The years 1990 to 2099.
        32_874.0..73_051.0 => of(25_569.0, "days as spreadsheets count them"),
        726_834.0..767_011.0 => of(719_529.0, "days as MATLAB's datenum counts them"),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(first: f64, step: f64) -> Counting {
        Counting::of(0, &[first, first + step], None)
    }

    #[test]
    fn a_late_clock_counts_from_its_first_second() {
        let origins = [0.0, -3.5, 9999.9, f64::NAN, 86_400.25, 1.7e9].map(origin_s);
        assert_eq!(origins.map(|s| s.to_string()), ["0", "0", "0", "0", "86400", "1700000000"]);
    }

    #[test]
    fn numbers_of_days_are_told_by_their_size_and_their_steps() {
        // Noon of the first of January 2025.
        for (first, period_s) in [(45_658.5, 0.01), (739_618.5, 0.01), (45_658.5, 1.0)] {
            let days = of(first, period_s / 86_400.0);
            assert!((days.seconds_of(first) - 1_735_732_800.0).abs() < 1e-3, "{days:?}");
        }
        // A machine that has been on for half a day, logged at 100 Hz.
        assert!(!of(45_658.5, 0.01).is_known());
    }

    #[test]
    fn the_unit_of_times_since_1970_is_told_by_their_size() {
        let micros = of(1.7e15, 1e4);
        assert_eq!((micros.seconds, micros.in_1970), (1e-6, 0.0));
        assert!(micros.is_known() && !of(86_400.0, 0.01).is_known());
    }
}
