//! The tail of Fisher's distribution.

use statrs::distribution::{ContinuousCDF as _, FisherSnedecor};

/// The probability of `statistic` or more, with these degrees of freedom above and below
/// the line; `None` where a number of them is zero.
pub fn fisher_tail(statistic: f64, above: usize, below: usize) -> Option<f64> {
    let fisher = FisherSnedecor::new(above as f64, below as f64).ok()?;
    Some(fisher.sf(statistic))
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
    }
}
