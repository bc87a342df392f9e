//! One delay for a whole record, in whole samples, where no single step can be told.
//!
//! For every delay `d` the change of the output is regressed on its own past and on the
//! input so long before,
//!
//! ```text
//! Δy_k = a + b·Δy_(k−1) + c·u_(k−d) + c′·u_(k−d−1) + e
//! ```
//!
//! over the same samples for all `d`; the least squared error tells which it is. A joint that
//! follows in more than one way may have its least elsewhere: it is a value to start from.

use super::normal_equations::NormalEquations;

/// Samples that are enough.
const ENOUGH: usize = 20_000;

/// Columns before the target.
const COLUMNS: usize = 4;

/// The squared error of every delay from 0 to `longest` samples; empty for a record that is
/// too short.
pub fn delay_scan(input: &[f64], output: &[f64], longest: usize) -> Vec<f64> {
    let first = longest + 2;
    let end = input.len().min(output.len()).min(first + ENOUGH);
    let samples = end.saturating_sub(first);
    if samples <= 2 * COLUMNS {
        return Vec::new();
    }
    let change = |k: usize| at(output, k) - at(output, k - 1);
    let error = |delay: usize| {
        let column = |value: &dyn Fn(usize) -> f64| (first..end).map(value).collect::<Vec<_>>();
        let columns = [
            column(&|_| 1.0),
            column(&|k| change(k - 1)),
            column(&|k| at(input, k - delay)),
            column(&|k| at(input, k - delay - 1)),
            column(&change),
        ];
        let mut equations = NormalEquations::of(&columns.concat(), samples, &[]);
        (0..COLUMNS).for_each(|column| equations.eliminate(column));
        equations.error()
    };
    (0..=longest).map(error).collect()
}

fn at(values: &[f64], k: usize) -> f64 {
    values.get(k).copied().unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The place of the least value.
    fn least(errors: &[f64]) -> usize {
        (0..errors.len()).min_by(|a, b| errors[*a].total_cmp(&errors[*b])).unwrap()
    }

    #[test]
    fn a_delay_is_found_behind_a_gain_and_behind_an_integrator() {
        let mut state = 9_u32;
        let mut noise = || {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            f64::from(state >> 8) / f64::from(1_u32 << 24) - 0.5
        };
        let input: Vec<f64> = (0..300).map(|_| noise()).collect();
        let follows: Vec<f64> = (0..300)
            .map(|k| if k < 7 { 0.0 } else { 2.0 * input[k - 7] } + 0.1 * noise())
            .collect();
        let mut sum = 0.0;
        let integrates: Vec<f64> = follows
            .iter()
            .map(|speed| {
                sum += speed;
                sum
            })
            .collect();
        assert_eq!(least(&delay_scan(&input, &follows, 20)), 7);
        assert_eq!(least(&delay_scan(&input, &integrates, 20)), 7);
        assert!(delay_scan(&input[..20], &follows[..20], 20).is_empty());
    }
}
