//! Whether an input follows the output.

use super::record::{changes, whiten, whitening};
use super::result::Feedback;
use crate::numerics::{autocovariances, chi_square_tail};

/// Samples after which an input may have answered.
const LAGS: usize = 20;

/// Longest memory of the input, samples.
const MEMORY: usize = 20;

/// Of `errors`, the residuals of a fit of the output, and the `inputs` of the same samples.
///
/// With `r_l` the correlation of an error with what is new in the input `l` samples later,
/// `n Σ r_l²` is `χ²` distributed where there is no feedback.
pub(super) fn feedback(errors: &[Vec<f64>], inputs: &[&[f64]]) -> Feedback {
    let news = innovations(inputs);
    let power = |all: &[Vec<f64>]| all.iter().flatten().map(|x| x * x).sum::<f64>();
    let scale = (power(errors) * power(&news)).sqrt();
    let samples: usize = errors.iter().map(Vec::len).sum();
    // Of e_k with w_(k+l), l > 0: an input that follows the output answers its errors.
    let correlation = |lag: usize| {
        let products = errors.iter().zip(&news).map(|(errors, news)| {
            errors.iter().zip(news.iter().skip(lag)).map(|(e, w)| e * w).sum::<f64>()
        });
        products.sum::<f64>() / scale
    };
    let correlations: Vec<f64> = (1..=LAGS).map(correlation).filter(|r| r.is_finite()).collect();
    let statistic = samples as f64 * correlations.iter().map(|r| r * r).sum::<f64>();
    Feedback {
        p_value: chi_square_tail(statistic, LAGS).unwrap_or(1.0),
        largest: correlations.iter().fold(0.0, |largest, r| largest.max(r.abs())),
    }
}

/// What the past of the changes of the inputs does not predict.
fn innovations(inputs: &[&[f64]]) -> Vec<Vec<f64>> {
    let changes: Vec<Vec<f64>> = inputs.iter().map(|input| changes(input)).collect();
    let samples: usize = changes.iter().map(Vec::len).sum();
    let filter = whitening(&autocovariances(&changes, MEMORY.min(samples / 20)), samples);
    changes.iter().map(|changes| whiten(changes, &filter)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::numerics::testing::uniform;

    #[test]
    fn an_input_that_follows_the_output_is_told_from_one_that_does_not() {
        let (mut one, mut other) = (uniform(5), uniform(11));
        let errors: Vec<f64> = (0..2000).map(|_| one()).collect();
        let mut at = 0.0;
        let free: Vec<f64> = (0..2000)
            .map(|_| {
                at = 0.9 * at + other();
                at
            })
            .collect();
        let follows: Vec<f64> = (0..2000_usize)
            .map(|k| free[k] + k.checked_sub(3).map_or(0.0, |k| errors[k]))
            .collect();
        let of = |input: &[f64]| feedback(std::slice::from_ref(&errors), &[input]);
        assert!(!of(&free).is_present(), "{:?}", of(&free));
        assert!(of(&follows).is_present(), "{:?}", of(&follows));
    }
}
