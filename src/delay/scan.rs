//! One delay for a whole record, in whole samples, where no single step can be estimated.
//!
//! For every delay `d` the change of the output is regressed on its own past and on one to
//! three values of the input so long before,
//!
//! ```text
//! Δy_k = a + b·Δy_(k−1) + b′·y_(k−1) + c_0·u_(k−d) + … + c_m·u_(k−d−m) + e      m = 0, 1, 2
//! ```
//!
//! over the same samples for all `d`. With `b′ = 0` the joint integrates; without, it follows
//! a lag, and noise may wander. A delay that is too short by one explains as much, with a first
//! coefficient of nothing: Schwarz's penalty for each coefficient distinguishes the two. A joint
//! that follows in more than one way may have its least elsewhere: it is a value to start from.
//!
//! # References
//! G. E. P. Box and G. M. Jenkins, Time series analysis: forecasting and control, 1970, whose
//! series J and M are found.

use crate::numerics::NormalEquations;

/// Samples that are enough.
const ENOUGH: usize = 20_000;

/// Columns of the output's own past.
const PAST: usize = 3;

/// Most values of the input.
const INPUTS: usize = 3;

/// Squared errors below this part of the output's are rounding.
const ROUNDING: f64 = 1e-12;

/// The squared error of every delay from 0 to `longest` samples, larger by Schwarz's penalty
/// for the values of the input that it takes; empty for a record that is too short. The least
/// one is the delay.
pub fn delay_scan(input: &[f64], output: &[f64], longest: usize) -> Vec<f64> {
    // All delays are compared over the same samples: those that the longest one leaves.
    let first = longest + INPUTS;
    let end = input.len().min(output.len()).min(first + ENOUGH);
    let samples = end.saturating_sub(first);
    if samples <= 2 * (PAST + INPUTS) {
        return Vec::new();
    }
    let column = |value: &dyn Fn(usize) -> f64| (first..end).map(value).collect::<Vec<_>>();
    let change = |k: usize| output[k] - output[k - 1];
    // About a value in the record, so that the column of y_(k−1) is not nearly constant.
    let origin = output[first];
    let past = [column(&|_| 1.0), column(&|k| change(k - 1)), column(&|k| output[k - 1] - origin)];
    let changes = column(&change);
    let error = |delay: usize| {
        let inputs = (delay..delay + INPUTS).flat_map(|by| column(&|k| input[k - by]));
        let columns = past.iter().flatten().copied().chain(inputs).chain(changes.iter().copied());
        penalised(&columns.collect::<Vec<_>>(), samples)
    };
    (0..=longest).map(error).collect()
}

/// The least squared error with one value of the input or more, with its penalty.
fn penalised(columns: &[f64], samples: usize) -> f64 {
    let mut equations = NormalEquations::of(columns, samples);
    // The past of the output is known whatever the delay.
    (0..PAST).for_each(|column| equations.eliminate(column));
    let rounding = ROUNDING * equations.error();
    // n ln SSE + p ln n = n ln (SSE · n^(p/n)): the criterion as a factor of the squared error.
    let per_value = ((samples as f64).ln() / samples as f64).exp();
    let mut penalty = 1.0;
    let error = |column: usize| {
        equations.eliminate(column);
        penalty *= per_value;
        equations.error().max(rounding) * penalty
    };
    (PAST..PAST + INPUTS).map(error).fold(f64::INFINITY, f64::min)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::numerics::testing::uniform;

    /// The place of the least value.
    fn least(errors: &[f64]) -> usize {
        (0..errors.len()).min_by(|a, b| errors[*a].total_cmp(&errors[*b])).unwrap()
    }

    /// Twice the input 7 samples before, with as much noise.
    fn follows(input: &[f64], level: f64) -> Vec<f64> {
        let mut noise = uniform(77);
        let value = |k: usize| if k < 7 { 0.0 } else { 2.0 * input[k - 7] };
        (0..input.len()).map(|k| value(k) + level * noise()).collect()
    }

    /// What becomes of `from` when a part `kept` of the value before stays.
    fn behind(from: &[f64], kept: f64) -> Vec<f64> {
        let mut value = 0.0;
        let next = |by: &f64| {
            value = kept * value + by;
            value
        };
        from.iter().map(next).collect()
    }

    #[test]
    fn a_delay_is_found_behind_a_gain_a_lag_and_an_integrator() {
        let mut white = uniform(9);
        let input: Vec<f64> = (0..300).map(|_| white()).collect();
        // An input that remembers itself shows less well where the output comes from.
        for input in [behind(&input, 0.9), input] {
            for level in [0.0, 0.1] {
                let follows = follows(&input, level);
                for kept in [0.0, 0.6, 1.0] {
                    let found = delay_scan(&input, &behind(&follows, kept), 20);
                    assert_eq!(least(&found), 7, "{level} {kept}");
                }
            }
        }
    }

    #[test]
    fn a_record_that_is_too_short_tells_nothing() {
        assert!(delay_scan(&[0.5; 20], &[0.5; 20], 20).is_empty());
    }
}
