//! Numbers, units, probabilities and shares as a person reads them.

use crate::numerics::{decimal_exponent, to_decimals};

/// `value` to five significant digits, without trailing zeros: `0.012346`, `1.2e-9`.
pub fn number(value: f64) -> String {
    /// Digits that are shown; files hold all of them.
    const SIGNIFICANT: i32 = 5;
    to_digits(value, SIGNIFICANT)
}

/// `value` as it is said in a sentence: to three significant digits.
pub(crate) fn rounded(value: f64) -> String {
    to_digits(value, 3)
}

fn to_digits(value: f64, significant: i32) -> String {
    if value == 0.0 || !value.is_finite() {
        return value.to_string();
    }
    let exponent = decimal_exponent(value);
    if !(-4..9).contains(&exponent) {
        let decimals = usize::try_from(significant - 1).unwrap_or(0);
        return tidy(&format!("{value:.decimals$e}"));
    }
    let decimals = usize::try_from(significant - 1 - exponent).unwrap_or(0);
    tidy(&format!("{value:.decimals$}"))
}

/// Removes trailing zeros after a decimal point.
fn tidy(text: &str) -> String {
    let (mantissa, exponent) = text.split_at(text.find('e').unwrap_or(text.len()));
    if mantissa.contains('.') {
        let mantissa = mantissa.trim_end_matches('0').trim_end_matches('.');
        return format!("{mantissa}{exponent}");
    }
    format!("{mantissa}{exponent}")
}

/// `value` with so many digits after the point, without trailing zeros.
pub(crate) fn to_place(value: f64, decimals: i32) -> String {
    number(to_decimals(value, decimals))
}

/// A unit as it is written after a number: ` V`, or nothing.
pub(crate) fn unit_suffix(unit: Option<&str>) -> String {
    unit.map_or_else(String::new, |unit| format!(" {unit}"))
}

/// A quantity's name with its unit, as a heading: `input [V]`.
pub(crate) fn bracketed(name: &str, unit: Option<&str>) -> String {
    unit.map_or_else(|| name.to_owned(), |unit| format!("{name} [{unit}]"))
}

/// So many samples, which may lie between two: `1 sample`, `12.4 samples`.
pub(crate) fn samples_text(count: f64) -> String {
    let count = number(count);
    let noun = if count == "1" { "sample" } else { "samples" };
    format!("{count} {noun}")
}

/// A number to five digits, with its unit where there is one.
pub(crate) fn with_unit(value: f64, unit: Option<&str>) -> String {
    number(value) + &unit_suffix(unit)
}

/// A number to three digits, with its unit where there is one.
pub(crate) fn measure(value: f64, unit: Option<&str>) -> String {
    rounded(value) + &unit_suffix(unit)
}

/// The least and the largest of `values`: `-2 to 2 V`.
pub(crate) fn range_text(values: impl Iterator<Item = f64>, unit: Option<&str>) -> String {
    let ends = |(low, high): (f64, f64), value: f64| (low.min(value), high.max(value));
    let (low, high) = values.fold((f64::INFINITY, f64::NEG_INFINITY), ends);
    format!("{} to {}", rounded(low), measure(high, unit))
}

/// A value to the digits that its standard error leaves: `0.612 ± 0.021`.
pub(crate) fn with_error(value: f64, std_error: f64) -> String {
    let known = std_error.is_finite() && std_error > 0.0;
    let decimals = if known { 1 - decimal_exponent(std_error) } else { 0 };
    match usize::try_from(decimals) {
        Ok(decimals) if known && decimals < 9 => {
            format!("{value:.decimals$} ± {std_error:.decimals$}")
        }
        _ => format!("{} ± {}", number(value), number(std_error)),
    }
}

/// An interval to the digits that its width leaves: `13.92 … 14.08`.
pub(crate) fn interval((low, high): (f64, f64)) -> String {
    let width = high - low;
    let is_known = width.is_finite() && width > 0.0;
    let decimals = if is_known { (1 - decimal_exponent(width)).max(0) } else { 9 };
    format!("{} … {}", to_place(low, decimals), to_place(high, decimals))
}

/// A p-value in a sentence: `p = 0.0312`.
pub(crate) fn p_text(p_value: f64) -> String {
    if p_value < 1e-4 { "p < 0.0001".to_owned() } else { format!("p = {p_value:.4}") }
}

/// A p-value in a table, to the thousandth: a rank test gives it no better.
pub(crate) fn p_cell(p_value: Option<f64>) -> String {
    match p_value {
        None => "-".to_owned(),
        Some(p_value) if p_value < 0.001 => "< 0.001".to_owned(),
        Some(p_value) => to_place(p_value, 3),
    }
}

/// A share in percent: `31 %`.
pub(crate) fn percent(share: f64) -> String {
    format!("{:.0} %", 100.0 * share)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn five_digits_are_shown() {
        let shown = [0.0, 104.0, 0.150_000_000_1, -0.012_345_67, 123_456.78, 1.23e-9, 5e12];
        let expected = ["0", "104", "0.15", "-0.012346", "123457", "1.23e-9", "5e12"];
        assert_eq!(shown.map(number), expected);
        assert_eq!([0.050_622, 1.8021, 1234.0].map(rounded), ["0.0506", "1.8", "1234"]);
    }

    #[test]
    fn an_interval_has_the_digits_that_its_width_leaves() {
        let shown = [(13.9231, 14.0784), (-0.5, 2312.4), (0.1, 0.1), (0.012_345, 0.012_399)];
        let expected = ["13.92 … 14.08", "-1 … 2312", "0.1 … 0.1", "0.012345 … 0.012399"];
        assert_eq!(shown.map(interval), expected);
    }

    #[test]
    fn a_value_has_the_digits_that_its_error_leaves() {
        let shown = [(0.612_34, 0.0213), (11.9, 1.5e-4), (1234.5, 37.0), (2.0, 0.0), (0.3, 1e-12)];
        let expected = ["0.612 ± 0.021", "11.90000 ± 0.00015", "1234 ± 37", "2 ± 0", "0.3 ± 1e-12"];
        assert_eq!(shown.map(|(value, error)| with_error(value, error)), expected);
    }
}

#[cfg(test)]
mod probability_tests {
    use super::*;

    #[test]
    fn small_probabilities_are_bounds() {
        assert_eq!([0.031_24, 3e-7].map(p_text), ["p = 0.0312", "p < 0.0001"]);
        let cells = [None, Some(0.0004), Some(0.0316)].map(p_cell);
        assert_eq!(cells, ["-", "< 0.001", "0.032"]);
    }
}
