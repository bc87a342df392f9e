//! Is the residual as large in one part of a record as in another?
//!
//! A misfit that is there for a few seconds, or at one level of the input, is little of the
//! error of a whole record, and a test of all samples together may take it for noise with a
//! long memory. Noise is the same everywhere. In each window the residual `r` is held against
//! the straight line `p₁` and the parabola `p₂` that are orthogonal to a constant and to each
//! other (Legendre's polynomials on the samples, of length one):
//!
//! ```text
//! e = ½ Σ_d (p_d · r)² / v_d,    v_d = Σ_h c_h Σ_k p_d(k) p_d(k + h)
//! ```
//!
//! `c_h` are the autocovariances of the residual by its autoregression, so that `v_d` is the
//! variance of a product in noise with that memory. For such noise the two products are
//! independent, and `2e` is χ² with two degrees of freedom: `P(e > x) = exp(−x)`. The scale
//! is put right by the median over the windows, `ln 2`, which a misfit in less than half of
//! them does not move. Of `n` windows the largest `e` is beyond `x` with a probability of at
//! most `n exp(−x)` (Bonferroni).

use std::collections::BTreeMap;

use serde::Serialize;

use super::residual_size::BEYOND_NOISE;
use crate::numerics::NoiseModel;
use crate::numerics::dot;

/// The part of a record in which a residual stands out most.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct LocalMisfit {
    /// The probability that noise stands out as much anywhere.
    pub p_value: f64,
    /// Root mean square of the line and parabola there, over the noise of the measurement,
    /// where it is known.
    pub times_noise: Option<f64>,
}

impl LocalMisfit {
    /// Whether it is no noise, and large enough to matter.
    pub(crate) fn is_shown(&self) -> bool {
        /// Far below what a test of one record needs: noise is not quite Gaussian, and a
        /// model that is right not quite the plant.
        const SIGNIFICANCE: f64 = 1e-6;
        self.p_value < SIGNIFICANCE && self.times_noise.is_none_or(|times| times > BEYOND_NOISE)
    }
}

/// Longest stretch that is looked at as one, in samples; longer windows are cut evenly.
const LONGEST: usize = 200;

/// Shortest, in samples.
const SHORTEST: usize = 20;

/// Fewest stretches whose median says what is usual.
const FEWEST: usize = 10;

/// A line and a parabola, of length one.
type Shapes = [Vec<f64>; 2];

/// The stretch of `windows` in which the residual stands out most, with the noise `floor`;
/// `None` where there are too few of them.
pub(super) fn local_misfit(windows: &[Vec<f64>], floor: Option<f64>) -> Option<LocalMisfit> {
    let stretches: Vec<&[f64]> = windows.iter().flat_map(|window| stretches(window)).collect();
    if stretches.len() < FEWEST {
        return None;
    }
    let correlations = NoiseModel::of_centred(windows).correlations(LONGEST);
    let mut usual: BTreeMap<usize, (Shapes, [f64; 2])> = BTreeMap::new();
    let mut energies = Vec::with_capacity(stretches.len());
    let mut largest = (0.0, 0.0);
    for stretch in &stretches {
        let (shapes, variances) = usual.entry(stretch.len()).or_insert_with(|| {
            let shapes = shapes(stretch.len());
            let variances = [0, 1].map(|d| variance(&shapes[d], &correlations));
            (shapes, variances)
        });
        let products = [0, 1].map(|d| dot(&shapes[d], stretch).powi(2));
        // e = ½ Σ_d (p_d·r)²/v_d.
        let energy = 0.5 * (products[0] / variances[0] + products[1] / variances[1]);
        if energy > largest.0 {
            largest = (energy, (products[0] + products[1]) / stretch.len() as f64);
        }
        energies.push(energy);
    }
    let (_, median, _) = energies.select_nth_unstable_by(stretches.len() / 2, f64::total_cmp);
    // P(e > ln 2) = ½.
    let scale = *median / std::f64::consts::LN_2;
    let (energy, mean_square) = largest;
    // n·exp(−x).
    let p_value = (stretches.len() as f64 * (-energy / scale).exp()).min(1.0);
    let times_noise = floor.map(|floor| mean_square.sqrt() / floor).filter(|t| t.is_finite());
    (scale > 0.0).then_some(LocalMisfit { p_value, times_noise })
}

/// A window in even parts that are short enough, and long enough.
fn stretches(window: &[f64]) -> impl Iterator<Item = &[f64]> {
    let parts = window.len().div_ceil(LONGEST).max(1);
    let parts = window.chunks(window.len().div_ceil(parts).max(1));
    parts.filter(|part| part.len() >= SHORTEST)
}

/// Line and parabola over `count` samples, orthogonal to a constant and to each other.
fn shapes(count: usize) -> Shapes {
    let times = || (0..count).map(|k| k as f64 - (count as f64 - 1.0) / 2.0);
    let mean_square = times().map(|x| x * x).sum::<f64>() / count as f64;
    let of_length_one = |mut shape: Vec<f64>| {
        let length = dot(&shape, &shape).sqrt();
        for value in &mut shape {
            *value /= length;
        }
        shape
    };
    let [line, parabola] =
        [times().collect(), times().map(|x| x * x - mean_square).collect()].map(of_length_one);
    [line, parabola]
}

/// Variance of the product of `shape` with noise of variance 1 and these correlations at
/// lags from 0.
fn variance(shape: &[f64], correlations: &[f64]) -> f64 {
    let lagged = |lag: usize| dot(shape, shape.get(lag..).unwrap_or_default());
    let beyond = correlations.iter().enumerate().skip(1);
    // v = Σ_h c_h Σ_k p(k)·p(k + h), h to either side.
    lagged(0) + 2.0 * beyond.map(|(lag, correlation)| correlation * lagged(lag)).sum::<f64>()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::numerics::testing::noise;

    /// Noise of first order in windows of several lengths, each without its mean.
    fn windows(rho: f64, seed: u64) -> Vec<Vec<f64>> {
        let values = noise(seed, rho, 12_000);
        let mut rest = values.as_slice();
        let mut cut = Vec::new();
        for length in [60, 130, 200, 90].into_iter().cycle() {
            let Some((window, after)) = rest.split_at_checked(length) else { return cut };
            let mean = window.iter().sum::<f64>() / length as f64;
            cut.push(window.iter().map(|value| value - mean).collect());
            rest = after;
        }
        cut
    }

    fn found(windows: &[Vec<f64>]) -> LocalMisfit {
        local_misfit(windows, Some(1.0)).unwrap()
    }

    #[test]
    fn line_and_parabola_are_orthogonal() {
        let [line, parabola] = shapes(37);
        assert!(dot(&line, &parabola).abs() < 1e-12);
        for shape in [line, parabola] {
            assert!((dot(&shape, &shape) - 1.0).abs() < 1e-12);
            assert!(shape.iter().sum::<f64>().abs() < 1e-12);
        }
    }

    #[test]
    fn the_variance_of_a_product_is_that_of_many_products() {
        let [line, _] = shapes(80);
        let correlations: Vec<f64> = (0..80).map(|lag| 0.9_f64.powi(lag)).collect();
        let values = noise(3, 0.9, 400_000);
        let power = dot(&values, &values) / values.len() as f64;
        let squares = values.chunks_exact(80).map(|window| dot(&line, window).powi(2));
        let sampled = squares.sum::<f64>() / 5000.0 / power;
        let expected = variance(&line, &correlations);
        assert!((sampled / expected - 1.0).abs() < 0.06, "{sampled} {expected}");
    }

    #[test]
    fn noise_is_as_large_everywhere() {
        for rho in [0.0, 0.5, 0.9, 0.95] {
            let values: Vec<f64> = (0..200).map(|s| found(&windows(rho, s)).p_value).collect();
            let below = |p| values.iter().filter(|value| **value < p).count();
            // Bonferroni's bound: at most 20 and 2 on average.
            assert!(below(0.1) <= 34 && below(0.01) <= 8, "{rho}");
        }
    }

    #[test]
    fn a_few_seconds_of_motion_are_seen() {
        for rho in [0.0, 0.9] {
            let mut windows = windows(rho, 7);
            let size = if rho > 0.0 { 8.0 } else { 6.0 };
            let window = &mut windows[20];
            let count = window.len() as f64;
            for (k, value) in window.iter_mut().enumerate() {
                *value += size * 2.0 * (k as f64 / count - 0.5);
            }
            assert!(found(&windows).is_shown(), "{:?}", found(&windows));
        }
    }

    #[test]
    fn what_is_near_the_noise_does_not_matter() {
        let shown = |times| LocalMisfit { p_value: 1e-30, times_noise: times }.is_shown();
        assert!(shown(Some(4.0)) && shown(None) && !shown(Some(2.0)));
        assert!(!LocalMisfit { p_value: 1e-3, times_noise: Some(9.0) }.is_shown());
    }

    #[test]
    fn a_short_record_says_nothing() {
        assert_eq!(local_misfit(&[vec![0.1; 300]], None), None);
    }
}
