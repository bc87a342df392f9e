//! Tails and quantiles of distributions.

use statrs::distribution::{
    Binomial, ChiSquared, ContinuousCDF as _, DiscreteCDF as _, FisherSnedecor, Normal, StudentsT,
};

/// The probability that a standard normal variable is below `value`.
pub(crate) fn normal_below(value: f64) -> f64 {
    Normal::standard().cdf(value)
}

/// The probability of `statistic` or more with so many degrees of freedom; `None` where
/// that number is zero.
///
/// With one degree it is the probability that a normal variable is at least as far from
/// zero as the root of `statistic`.
pub(crate) fn chi_square_tail(statistic: f64, freedom: usize) -> Option<f64> {
    let chi_square = ChiSquared::new(freedom as f64).ok()?;
    Some(chi_square.sf(statistic))
}

/// The probability of `statistic` or more, with these degrees of freedom above and below
/// the line; `None` where a number of them is zero, or the statistic is not a number.
pub(crate) fn fisher_tail(statistic: f64, above: usize, below: usize) -> Option<f64> {
    /// Beyond this the tail is zero in any number, and the library's sum fails.
    const BEYOND: f64 = 1e12;
    let fisher = FisherSnedecor::new(above as f64, below as f64).ok()?;
    (!statistic.is_nan()).then(|| if statistic > BEYOND { 0.0 } else { fisher.sf(statistic) })
}

/// Degrees of freedom from which a series in their inverse is exact to 1e-6.
const SERIES_FREEDOM: f64 = 40.0;

/// The number that Student's variable of `freedom` degrees stays below with `probability`;
/// NaN where there is no such distribution.
///
/// From 40 degrees on by Cornish and Fisher's series, which is much faster.
pub(crate) fn student_quantile(probability: f64, freedom: f64) -> f64 {
    if freedom < SERIES_FREEDOM {
        let student = StudentsT::new(0.0, 1.0, freedom);
        return student.map_or(f64::NAN, |student| student.inverse_cdf(probability));
    }
    let z = Normal::standard().inverse_cdf(probability);
    let z2 = z * z;
    let terms = [
        z * (z2 + 1.0) / 4.0,
        z * ((5.0 * z2 + 16.0) * z2 + 3.0) / 96.0,
        z * (((3.0 * z2 + 19.0) * z2 + 17.0) * z2 - 15.0) / 384.0,
    ];
    let series = terms.iter().rev().fold(0.0, |sum, term| (sum + term) / freedom);
    z + series
}

/// The fewest heads of so many throws of a fair coin that are exceeded with a probability below
/// `1 − probability`.
pub(crate) fn coin_quantile(probability: f64, throws: usize) -> usize {
    let heads = Binomial::new(0.5, throws as u64).map(|heads| heads.inverse_cdf(probability));
    heads.ok().and_then(|heads| usize::try_from(heads).ok()).unwrap_or(0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_tabulated_normal_values_are_met() {
        for (value, below) in [(0.0, 0.5), (1.644_854, 0.95), (-2.326_348, 0.01)] {
            assert!((normal_below(value) - below).abs() < 1e-6, "{value}");
        }
    }

    #[test]
    fn five_percent_lie_beyond_the_tabulated_values() {
        for (statistic, freedom) in [(3.841_459, 1), (18.307_038, 10), (124.342_113, 100)] {
            let tail = chi_square_tail(statistic, freedom).unwrap();
            assert!((tail - 0.05).abs() < 1e-6, "{freedom}: {tail}");
        }
        assert_eq!(chi_square_tail(1.0, 0), None);
    }

    #[test]
    fn five_percent_lie_beyond_the_tabulated_ratio() {
        // F(0.95; 5, 10) = 3.3258.
        let tail = fisher_tail(3.3258, 5, 10).unwrap();
        assert!((tail - 0.05).abs() < 1e-5, "{tail}");
        assert_eq!(fisher_tail(1.0, 0, 10), None);
        assert_eq!(fisher_tail(f64::NAN, 5, 10), None);
        assert!(fisher_tail(f64::INFINITY, 5, 10).unwrap() <= 0.0);
    }

    #[test]
    fn quantiles_are_the_tabulated_ones() {
        for (freedom, expected) in
            [(1.0, 12.706_205), (10.0, 2.228_139), (60.0, 2.000_298), (200.0, 1.971_896)]
        {
            let found = student_quantile(0.975, freedom);
            assert!((found - expected).abs() < 2e-6, "{freedom}: {found}");
        }
    }
}
