//! Probabilities and shares.

use super::number::to_place;

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
    fn small_probabilities_are_bounds() {
        assert_eq!([0.031_24, 3e-7].map(p_text), ["p = 0.0312", "p < 0.0001"]);
        let cells = [None, Some(0.0004), Some(0.0316)].map(p_cell);
        assert_eq!(cells, ["-", "< 0.001", "0.032"]);
    }
}
