//! By how much a simulation moves at the wrong speed.

use std::ops::Range;

/// Longest stretch whose slope is taken, in samples to either side of its middle.
const LARGEST_HALF: usize = 20;

/// Shortest.
const SMALLEST_HALF: usize = 3;

/// Part of the usual window that a stretch may span, to either side.
const PART: usize = 6;

/// The slope of `residual` about each sample, output units per second: the least-squares
/// line through the samples near it in the same window.
///
/// Over `n` samples of white noise σ the slope has the standard deviation
/// `σ / (h √(n (n² − 1) / 12))` with the period `h`. In a window that is shorter than a
/// stretch it is taken down by as much as its noise is larger, so that noise counts alike
/// everywhere.
pub(super) fn speed_error(residual: &[f64], windows: &[Range<usize>], period_s: f64) -> Vec<f64> {
    let longest = 2 * half(windows) + 1;
    let mut slopes = vec![0.0; residual.len()];
    for window in windows {
        let Some(values) = residual.get(window.clone()) else { continue };
        let Some(slots) = slopes.get_mut(window.clone()) else { continue };
        let length = longest.min(values.len());
        let usual = spread(longest).max(f64::MIN_POSITIVE);
        // σ(slope) ∝ 1/√spread.
        let noise = (spread(length) / usual).sqrt() / period_s;
        for (index, slot) in slots.iter_mut().enumerate() {
            // At the ends of a window its first or last stretch: none reaches over a restart.
            let start = index.saturating_sub(length / 2).min(values.len() - length);
            let near = &values[start..start + length];
            *slot = noise * slope(near);
        }
    }
    slopes
}

/// Samples to either side, after the median length of the windows.
fn half(windows: &[Range<usize>]) -> usize {
    let mut lengths: Vec<usize> = windows.iter().map(Range::len).collect();
    lengths.sort_unstable();
    let median = lengths.get(lengths.len() / 2).copied().unwrap_or_default();
    (median / PART).clamp(SMALLEST_HALF, LARGEST_HALF)
}

/// `Σ (k − mean k)²` over `count` numbers.
fn spread(count: usize) -> f64 {
    let n = count as f64;
    n * (n * n - 1.0) / 12.0
}

/// Slope of the line through `values`, per sample; 0 where there are less than two.
pub(super) fn slope(values: &[f64]) -> f64 {
    let middle = (values.len() as f64 - 1.0) / 2.0;
    let with: f64 = values.iter().enumerate().map(|(k, value)| (k as f64 - middle) * value).sum();
    let spread = spread(values.len());
    if spread > 0.0 { with / spread } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::numerics::testing::noise;

    #[test]
    fn a_ramp_has_its_slope_and_a_jump_between_windows_has_none() {
        let ramp: Vec<f64> = (0..100).map(|k| 0.02 * f64::from(k)).collect();
        let level = vec![7.0; 100];
        let residual = [ramp, level].concat();
        let found = speed_error(&residual, &[0..100, 100..200], 0.01);
        assert!(found[..100].iter().all(|slope| (slope - 2.0).abs() < 1e-9));
        assert!(found[100..].iter().all(|slope| slope.abs() < 1e-9));
    }

    #[test]
    fn noise_counts_alike_in_windows_of_any_length() {
        let residual = noise(5, 0.0, 40_000);
        let mut windows: Vec<Range<usize>> = (0..100).map(|i| 200 * i..200 * (i + 1)).collect();
        windows.extend((1000..2000).map(|i| 20 * i..20 * (i + 1)));
        windows.extend(std::iter::repeat_n(0..200, 2000));
        let found = speed_error(&residual, &windows, 0.01);
        let power = |slopes: &[f64]| slopes.iter().map(|s| s * s).sum::<f64>() / 20_000.0;
        let ratio = power(&found[20_000..]) / power(&found[..20_000]);
        assert!((ratio - 1.0).abs() < 0.2, "{ratio}");
        let expected = 1.0 / (0.01 * (41.0_f64 * (41.0 * 41.0 - 1.0) / 12.0).sqrt());
        assert!((power(&found[..20_000]).sqrt() / expected - 1.0).abs() < 0.2);
    }

    #[test]
    fn windows_of_one_sample_have_no_slope() {
        assert_eq!(speed_error(&[1.0, 2.0], &[0..1, 1..2], 0.01), vec![0.0, 0.0]);
    }
}
