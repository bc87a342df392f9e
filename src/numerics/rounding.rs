//! Numbers rounded to so many digits, so that they can be said and typed.

/// Power of ten of the first digit: -2 for `0.0123`. For a finite number other than 0.
pub(crate) fn decimal_exponent(value: f64) -> i32 {
    #[expect(clippy::cast_possible_truncation, reason = "an exponent is small")]
    let exponent = value.abs().log10().floor().clamp(-300.0, 300.0) as i32;
    exponent
}

/// `value` as a multiple of `10^exponent`, the nearest one.
pub(crate) fn to_multiple(value: f64, exponent: i32) -> f64 {
    to_multiple_by(value, exponent, f64::round)
}

/// `value` with so many digits after the point.
pub(crate) fn to_decimals(value: f64, decimals: i32) -> f64 {
    to_multiple(value, -decimals)
}

/// Seconds to the nanosecond: `0.07`, not `0.07000000000000001`.
pub(crate) fn to_nanoseconds(seconds: f64) -> f64 {
    to_decimals(seconds, 9)
}

/// `value` with so many significant digits.
pub(crate) fn to_digits(value: f64, digits: i32) -> f64 {
    to_digits_by(value, digits, f64::round)
}

/// `value` with so many significant digits, where `round` says what becomes of what is after
/// them: [`f64::ceil`] gives no number below `value`.
pub(crate) fn to_digits_by(value: f64, digits: i32, round: impl Fn(f64) -> f64) -> f64 {
    if value == 0.0 || !value.is_finite() {
        return value;
    }
    to_multiple_by(value, decimal_exponent(value) - (digits - 1), round)
}

fn to_multiple_by(value: f64, exponent: i32, round: impl Fn(f64) -> f64) -> f64 {
    // The negative powers of ten are no doubles: dividing by a whole power gives the double that
    // is nearest to the decimal fraction, so that `0.07` is not `0.07000000000000001`.
    let unit = 10_f64.powi(exponent.abs());
    if exponent < 0 { round(value * unit) / unit } else { round(value / unit) * unit }
}

/// The number that is read where `value` is written with so many significant digits. Unlike
/// [`to_digits`] it decides by the exact value, a tie to the even digit.
pub(crate) fn as_written(value: f64, digits: usize) -> f64 {
    let decimals = digits.saturating_sub(1);
    format!("{value:.decimals$e}").parse().unwrap_or(value)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn as_many_digits_as_asked_for_are_kept() {
        let values = [12.345_678, -0.001_239, 987_654.0, 0.5, 0.0];
        let shown = values.map(|value| to_digits(value, 3).to_string());
        assert_eq!(shown, ["12.3", "-0.00124", "988000", "0.5", "0"]);
        let values = [8.593_75, 0.123_4, 12.34, 0.996, 104.0, 1.25];
        let shown = values.map(|value| to_digits(value, 2).to_string());
        assert_eq!(shown, ["8.6", "0.12", "12", "1", "100", "1.3"]);
        let shown = values.map(|value| as_written(value, 2).to_string());
        assert_eq!(shown, ["8.6", "0.12", "12", "1", "100", "1.2"]);
        assert!(to_digits(f64::NAN, 3).is_nan() && as_written(f64::INFINITY, 3).is_infinite());
    }

    #[test]
    fn a_direction_can_be_given() {
        let shown = |round: fn(f64) -> f64| {
            [0.070_01, 123.4].map(|value| to_digits_by(value, 3, round).to_string())
        };
        assert_eq!(shown(f64::ceil), ["0.0701", "124"]);
        assert_eq!(shown(f64::floor), ["0.07", "123"]);
    }

    #[test]
    fn decimals_are_those_behind_the_point() {
        let shown = [7.0 * 0.01, 1234.567].map(|value| to_decimals(value, 2).to_string());
        assert_eq!(shown, ["0.07", "1234.57"]);
        assert_eq!(to_multiple(1234.5, 2).to_string(), "1200");
    }
}
