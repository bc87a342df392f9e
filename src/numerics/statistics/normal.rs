//! The normal distribution.

use statrs::distribution::{ContinuousCDF as _, Normal};

/// The probability that a standard normal variable is below `value`.
pub(crate) fn normal_below(value: f64) -> f64 {
    Normal::standard().cdf(value)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tabulated_values_are_met() {
        for (value, below) in [(0.0, 0.5), (1.644_854, 0.95), (-2.326_348, 0.01)] {
            assert!((normal_below(value) - below).abs() < 1e-6, "{value}");
        }
    }
}
