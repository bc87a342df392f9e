//! The tail of the chi-square distribution.

use statrs::distribution::{ChiSquared, ContinuousCDF as _};

/// The probability of `statistic` or more with so many degrees of freedom; `None` where
/// that number is zero.
///
/// With one degree it is the probability that a normal variable is at least as far from
/// zero as the root of `statistic`.
pub(crate) fn chi_square_tail(statistic: f64, freedom: usize) -> Option<f64> {
    let chi_square = ChiSquared::new(freedom as f64).ok()?;
    Some(chi_square.sf(statistic))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn five_percent_lie_beyond_the_tabulated_values() {
        for (statistic, freedom) in [(3.841_459, 1), (18.307_038, 10), (124.342_113, 100)] {
            let tail = chi_square_tail(statistic, freedom).unwrap();
            assert!((tail - 0.05).abs() < 1e-6, "{freedom}: {tail}");
        }
        assert_eq!(chi_square_tail(1.0, 0), None);
    }
}
