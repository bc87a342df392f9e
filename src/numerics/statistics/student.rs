//! Quantiles of Student's distribution.

use statrs::distribution::{ContinuousCDF as _, Normal, StudentsT};

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

#[cfg(test)]
mod tests {
    use super::*;

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
