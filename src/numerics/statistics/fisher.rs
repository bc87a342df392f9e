//! The tail of Fisher's distribution.

use statrs::distribution::{ContinuousCDF as _, FisherSnedecor};

/// The probability of `statistic` or more, with these degrees of freedom above and below
/// the line; `None` where a number of them is zero, or the statistic is not a number.
pub(crate) fn fisher_tail(statistic: f64, above: usize, below: usize) -> Option<f64> {
    /// Beyond this the tail is zero in any number, and the library's sum fails.
    const BEYOND: f64 = 1e12;
    let fisher = FisherSnedecor::new(above as f64, below as f64).ok()?;
    (!statistic.is_nan()).then(|| if statistic > BEYOND { 0.0 } else { fisher.sf(statistic) })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn five_percent_lie_beyond_the_tabulated_value() {
        // F(0.95; 5, 10) = 3.3258.
        let tail = fisher_tail(3.3258, 5, 10).unwrap();
        assert!((tail - 0.05).abs() < 1e-5, "{tail}");
        assert_eq!(fisher_tail(1.0, 0, 10), None);
        assert_eq!(fisher_tail(f64::NAN, 5, 10), None);
        assert!(fisher_tail(f64::INFINITY, 5, 10).unwrap() <= 0.0);
    }
}
