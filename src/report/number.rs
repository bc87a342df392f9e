//! Numbers as a person reads them.

/// `value` to five significant digits, without trailing zeros: `0.012346`, `1.2e-9`.
pub fn number(value: f64) -> String {
    /// Digits that are shown; files hold all of them.
    const SIGNIFICANT: i32 = 5;
    if value == 0.0 || !value.is_finite() {
        return value.to_string();
    }
    #[expect(clippy::cast_possible_truncation, reason = "an exponent is small")]
    let exponent = value.abs().log10().floor() as i32;
    if !(-4..9).contains(&exponent) {
        return tidy(&format!("{value:.4e}"));
    }
    let decimals = usize::try_from(SIGNIFICANT - 1 - exponent).unwrap_or(0);
    tidy(&format!("{value:.decimals$}"))
}

/// Takes the zeros off the end of a number with a point.
fn tidy(text: &str) -> String {
    let (mantissa, exponent) = text.split_at(text.find('e').unwrap_or(text.len()));
    if mantissa.contains('.') {
        let mantissa = mantissa.trim_end_matches('0').trim_end_matches('.');
        return format!("{mantissa}{exponent}");
    }
    format!("{mantissa}{exponent}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn five_digits_are_shown() {
        let shown = [0.0, 104.0, 0.150_000_000_1, -0.012_345_67, 123_456.78, 1.23e-9, 5e12];
        let expected = ["0", "104", "0.15", "-0.012346", "123457", "1.23e-9", "5e12"];
        assert_eq!(shown.map(number), expected);
    }
}
