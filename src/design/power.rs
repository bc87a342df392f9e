//! How likely it is that two models are distinguished.
//!
//! Let the first of two models make the data, with white noise of variance `σ²`, and let the
//! second be fitted to them. What the second cannot follow, in units of the noise, is the
//! noncentrality
//!
//! ```text
//! λ = min over θ₂ of Σ (η₁(t_k) − η₂(t_k; θ₂))² / σ²
//! ```
//!
//! which Atkinson and Fedorov (1975) make largest (T-optimality), and of which half is what
//! Box and Hill (1967) call the expected information for discrimination. Twice the difference
//! of the two log-likelihoods is then about normal with mean `λ` and variance `4 λ` (Cox,
//! 1961), and where the noise is estimated with the rest, with `n` samples,
//!
//! ```text
//! D = n ln(R₂ / R₁),   mean n ln(1 + λ/n),   variance 4 λ / (1 + λ/n)² + 2 (k₁ + k₂)
//! ```
//!
//! the last term being what `k₁` and `k₂` parameters of their own take from the noise. The
//! power is the probability that `D` is beyond what `explain` asks for, and that the model
//! with neither effect is seen to fail, which it must before any effect is looked for.
//!
//! # References
//! A. C. Atkinson and V. V. Fedorov, "The design of experiments for discriminating between
//! two rival models", Biometrika 62 (1975), 57-70. G. E. P. Box and W. J. Hill,
//! "Discrimination among mechanistic models", Technometrics 9 (1967), 57-71. D. R. Cox,
//! "Tests of separate families of hypotheses", Proc. 4th Berkeley Symposium (1961), 105-123.

use crate::explain::{ALIKE, BEYOND_DOUBT, BEYOND_DOUBT_PERCENT};
use crate::numerics::{fisher_tail, halved, normal_below};

/// What a model cannot follow of the data of another.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Distance {
    /// On the part that it is fitted to, in variances of the noise.
    pub training: f64,
    /// On the part that it is not fitted to.
    pub validation: f64,
    /// Parameters that are fitted.
    pub parameters: usize,
}

impl Distance {
    /// Both parts together.
    pub fn noncentrality(&self) -> f64 {
        self.training + self.validation
    }
}

/// What a race is expected to show of data that one of two models made.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Expected {
    /// Samples that are fitted, and those that are not.
    pub samples: (usize, usize),
    /// Of the model with the other effect.
    pub rival: Distance,
    /// Of the model with the effect itself: what the part that is fitted does not determine.
    pub own: Distance,
    /// Of the model with neither.
    pub neither: Distance,
}

impl Expected {
    /// The probability that the ranking distinguishes the two, or more.
    pub fn power(&self) -> f64 {
        // Of two events, both happen at least as often as their chances exceed one together.
        (normal_below(self.ranks()) + normal_below(self.fails()) - 1.0).max(0.0)
    }

    /// By how many standard deviations it is on the safe side.
    pub(super) fn margin(&self) -> f64 {
        self.ranks().min(self.fails())
    }

    /// How far, in standard deviations, the effect is expected to be ranked before the other
    /// beyond what makes them alike.
    fn ranks(&self) -> f64 {
        let (n, m) = self.samples;
        let parts = [
            (n, self.rival.training, self.own.training),
            (m, self.rival.validation, self.own.validation),
        ];
        let (mean, variance) =
            parts.into_iter().fold((0.0, 0.0), |(mean, variance), (n, rival, own)| {
                (mean + gain(n, rival) - gain(n, own), variance + spread(n, rival) + spread(n, own))
            });
        let (own, rival) = (self.own.parameters, self.rival.parameters);
        let common = self.neither.parameters;
        let added = own.saturating_sub(common) + rival.saturating_sub(common);
        // Schwarz's penalty for each parameter more.
        let handicap = (own as f64 - rival as f64) * (n.max(2) as f64).ln();
        let needed = ALIKE.max(handicap);
        // 2 (k₁ + k₂).
        (mean - needed) / (variance + 2.0 * added as f64).sqrt().max(1.0)
    }

    /// How far, in standard deviations, the model with neither effect is expected to be worse
    /// than beyond doubt.
    fn fails(&self) -> f64 {
        let (n, m) = self.samples;
        // Where an effect removes the part p of the error, the squares without it are larger by
        // 1/(1 − p)² − 1, in parts of n.
        let square = (1.0 - BEYOND_DOUBT_PERCENT / 100.0).powi(-2) - 1.0;
        let exceeds = |noncentrality: f64, needed: f64| {
            // About normal with mean λ and variance 4 λ.
            (noncentrality - needed) / (4.0 * noncentrality).sqrt().max(1.0)
        };
        let mut shows = exceeds(self.neither.training, square * n as f64);
        if m > 0 {
            shows = shows.max(exceeds(self.neither.validation, square * m as f64));
        }
        let added = self.own.parameters.saturating_sub(self.neither.parameters).max(1);
        let freedom = n.saturating_sub(self.own.parameters).max(1);
        shows.min(exceeds(self.neither.training, critical(added, freedom)))
    }
}

/// Expected `n ln(1 + λ/n)`.
fn gain(samples: usize, noncentrality: f64) -> f64 {
    let n = samples.max(1) as f64;
    // E D, which keeps its digits where λ ≪ n.
    n * (noncentrality / n).ln_1p()
}

/// Variance of that.
fn spread(samples: usize, noncentrality: f64) -> f64 {
    let part = 1.0 + noncentrality / samples.max(1) as f64;
    4.0 * noncentrality / (part * part)
}

/// The noncentrality at which Fisher's test of so many parameters is beyond doubt.
fn critical(added: usize, freedom: usize) -> f64 {
    /// No test asks for more.
    const MOST: f64 = 1e4;
    const HALVINGS: usize = 40;
    // The tail falls as λ grows.
    let tail = |lambda: f64| fisher_tail(lambda / added as f64, added, freedom).unwrap_or(0.0);
    halved((0.0, MOST), HALVINGS, |lambda| tail(lambda) > BEYOND_DOUBT).1
}

#[cfg(test)]
mod tests {
    use super::*;

    fn expected(rival: f64, neither: f64) -> Expected {
        let distance = |whole: f64, parameters| Distance {
            training: 0.7 * whole,
            validation: 0.3 * whole,
            parameters,
        };
        Expected {
            samples: (700, 300),
            rival: distance(rival, 4),
            own: distance(0.0, 4),
            neither: distance(neither, 2),
        }
    }

    #[test]
    fn power_grows_with_the_distance_of_the_rival() {
        // Without the noise of the parameters, (λ − 10) / 2√λ is 1.645 at λ = 27.1.
        let powers = [0.0, 10.0, 29.0, 60.0].map(|rival| expected(rival, 1000.0).power());
        assert!(powers[0] < 1e-3 && (powers[1] - 0.5).abs() < 0.03, "{powers:?}");
        assert!((powers[2] - 0.94).abs() < 0.02 && powers[3] > 0.999, "{powers:?}");
    }

    #[test]
    fn nothing_is_told_where_the_plain_model_passes() {
        // 5 % less error is 10.8 % less of its square: 76 of 700.
        assert!(expected(60.0, 60.0).power() < 0.2 && expected(60.0, 200.0).power() > 0.99);
    }

    #[test]
    fn more_parameters_must_earn_their_penalty() {
        let even = expected(29.0, 1000.0);
        let own = Distance { parameters: 7, ..even.own };
        // Three more parameters cost 3 ln 700 = 20.
        assert!(Expected { own, ..even }.power() < even.power() - 0.1);
    }

    #[test]
    fn a_test_beyond_doubt_is_that_of_the_tables() {
        // Chi-square with one degree of freedom is beyond 23.93 with probability 1e-6.
        assert!((critical(1, 1_000_000) - 23.93).abs() < 0.02);
    }
}
