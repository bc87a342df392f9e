//! Is the residual white?
//!
//! The first of the two classical questions of residual analysis is asked of the residual
//! itself, as it is plotted: measured minus simulated. It is white when it is nothing but white
//! measurement noise. An integrator keeps every error it made, so a small error of the model
//! correlates it over seconds; so does coloured noise. How long it is correlated separates the
//! two.
//!
//! At high sample rates it is of means over blocks, so that the lags are as many.
//!
//! # References
//! L. Ljung, "System Identification", 1999, chapter 16. G. M. Ljung and G. E. P. Box, "On a
//! measure of lack of fit in time series models", Biometrika 65 (1978), 297-303.

use std::ops::Range;

use serde::Serialize;

use super::lags::{BAND, CONFIDENCE, Lags, TrialSignals, autocovariance, centre, means};
use crate::numerics::chi_square_tail;

/// Whether the residual is white noise.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Whiteness {
    /// Ljung and Box's statistic of all lags together.
    pub statistic: f64,
    /// The probability of so much or more when the residual is white; there are as many
    /// degrees of freedom as lags.
    pub p_value: f64,
    /// Seconds from lag 0 on over which all correlations are outside the band.
    pub correlated_s: f64,
    /// Part of the correlations of white noise that lies within the band.
    pub confidence: f64,
    /// Half the width of the band, about zero.
    pub band: f64,
    /// Seconds from one lag to the next.
    pub lag_step_s: f64,
    /// Autocorrelation of the residual, the first at a lag of one step.
    pub correlation: Vec<f64>,
}

/// Tests whether the residual is white, window by window, each less its own mean.
///
/// `None` where the windows are too short, or the residual is zero.
pub fn whiteness(trials: &[TrialSignals<'_>], period_s: f64) -> Option<Whiteness> {
    let of_trial = |trial: &TrialSignals<'_>| {
        let cut = |window: &Range<usize>| trial.residual.get(window.clone()).map(<[f64]>::to_vec);
        trial.windows.iter().filter_map(cut).collect::<Vec<_>>()
    };
    let windows: Vec<Vec<f64>> = trials.iter().flat_map(of_trial).collect();
    let lags = Lags::new(period_s, windows.iter().map(Vec::len).max()?)?;
    let windows = windows.iter().map(|window| means(window, lags.block));
    let mut windows: Vec<Vec<f64>> = windows.filter(|window| !window.is_empty()).collect();
    for window in &mut windows {
        centre(window);
    }
    let samples: usize = windows.iter().map(Vec::len).sum();
    let correlation = centred_autocorrelation(&windows, lags.count)?;
    let n = samples as f64;
    // Q = n (n + 2) Σ r² / (n − lag), with the pairs that the windows have in place of n − lag.
    let portion = |(r, lag): (&f64, usize)| {
        let pairs: usize = windows.iter().map(|window| window.len().saturating_sub(lag)).sum();
        n * (n + 2.0) * r * r / pairs as f64
    };
    let statistic: f64 = correlation.iter().zip(1..).map(portion).sum();
    // The correlation of white noise has the variance 1/n.
    let band = BAND / n.sqrt();
    let outside = correlation.iter().take_while(|r| r.abs() > band).count();
    Some(Whiteness {
        statistic,
        p_value: chi_square_tail(statistic, lags.count)?,
        correlated_s: outside as f64 * lags.step_s,
        confidence: CONFIDENCE,
        band,
        lag_step_s: lags.step_s,
        correlation,
    })
}

/// Autocorrelation at lags from 1 to `lags` of windows whose means were subtracted; what
/// that removes from the correlation of white noise is put back.
fn centred_autocorrelation(windows: &[Vec<f64>], lags: usize) -> Option<Vec<f64>> {
    let covariance = autocovariance(windows, lags);
    let (&power, covariance) = covariance.split_first().filter(|(power, _)| **power > 0.0)?;
    let samples: usize = windows.iter().map(Vec::len).sum();
    let freedom = samples.checked_sub(windows.len()).filter(|freedom| *freedom > 0)? as f64;
    // E Σ (r_k − r̄)(r_(k+h) − r̄) = −σ²·(1 − h/L) in a window of L samples of white noise.
    let lost = |lag: usize| -> f64 {
        windows.iter().map(|w| (1.0 - lag as f64 / w.len() as f64).max(0.0)).sum()
    };
    let lags = covariance.iter().zip(1..);
    Some(lags.map(|(product, lag)| product / power + lost(lag) / freedom).collect())
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::super::lags::testing::{PERIOD_S, rate, trial};
    use super::*;
    use crate::numerics::testing::noise;

    fn whiteness_of(residual: &[f64]) -> Whiteness {
        whiteness(&[trial(residual, residual)], PERIOD_S).unwrap()
    }

    #[test]
    fn white_noise_is_seldom_called_correlated() {
        let rate = rate(|seed| whiteness_of(&noise(seed, 0.0, 1000)).p_value < 0.01);
        assert!(rate <= 0.03, "{rate}");
    }

    #[test]
    fn short_windows_do_not_make_white_noise_look_correlated() {
        let rate = rate(|seed| {
            let residual = noise(seed, 0.0, 2000);
            let windows = (0..20).map(|i| 100 * i..100 * (i + 1)).collect();
            let trial = TrialSignals { windows, ..trial(&residual, &residual) };
            whiteness(&[trial], PERIOD_S).unwrap().p_value < 0.01
        });
        assert!(rate <= 0.03, "{rate}");
    }

    #[test]
    fn noise_with_a_memory_is_correlated_for_as_long() {
        assert!(rate(|seed| whiteness_of(&noise(seed, 0.3, 1000)).p_value < 0.01) > 0.98);
        // Means over ten neighbours are uncorrelated from lag 10 on.
        let white = noise(1, 0.0, 20_000);
        let found =
            whiteness_of(&white.windows(10).map(|ten| ten.iter().sum()).collect::<Vec<_>>());
        let lags = found.correlated_s / PERIOD_S;
        assert!(found.p_value < 1e-9 && (lags - 9.0).abs() < 3.0, "{lags}");
    }

    #[test]
    fn what_is_short_or_zero_has_no_whiteness() {
        let (values, still) = (noise(1, 0.0, 100), vec![1.0; 100]);
        assert_eq!(whiteness(&[], PERIOD_S), None);
        assert_eq!(whiteness(&[trial(&still, &still)], PERIOD_S), None);
        assert_eq!(whiteness(&[trial(&values[..3], &still[..3])], PERIOD_S), None);
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(40))]

        #[test]
        fn autocorrelations_are_what_their_sums_say(seed in 0_u64..1000, count in 60_usize..200) {
            let values = noise(seed, 0.4, count);
            let found = whiteness_of(&values);
            let n = count as f64;
            let mean = values.iter().sum::<f64>() / n;
            let power: f64 = values.iter().map(|v| (v - mean) * (v - mean)).sum();
            let mut statistic = 0.0;
            for (r, lag) in found.correlation.iter().zip(1..) {
                let pairs = values.iter().zip(values.iter().skip(lag));
                let sum: f64 = pairs.map(|(a, b)| (a - mean) * (b - mean)).sum();
                let expected = sum / power + (1.0 - lag as f64 / n) / (n - 1.0);
                prop_assert!((r - expected).abs() < 1e-12);
                statistic += n * (n + 2.0) * expected * expected / (n - lag as f64);
            }
            prop_assert!((found.statistic / statistic - 1.0).abs() < 1e-9);
        }
    }
}
