//! The lags at which signals are correlated, and sums of products at them.

use std::ops::Range;

use crate::numerics::dot;

/// Part of the correlations of independent signals that lies within the bands.
pub const CONFIDENCE: f64 = 0.99;

/// Distance from zero, in standard deviations, within which a normal variable is with
/// probability [`CONFIDENCE`].
pub(super) const BAND: f64 = 2.575_829_303_548_901;

/// Longest lag in seconds: transients of a joint have ended by then (chosen).
const LONGEST_S: f64 = 2.0;

/// Most lags on one side: as many as can be seen in a figure (chosen).
const MAX_LAGS: usize = 200;

/// Fewest lags on one side, however slow the sampling (chosen).
const MIN_LAGS: usize = 20;

/// One trial: the residual of a model, and what drove it.
#[derive(Clone, Debug)]
pub struct TrialSignals<'a> {
    /// Measured minus simulated, a value per sample.
    pub residual: &'a [f64],
    /// Spans of samples that count, in order, each simulated without a restart.
    pub windows: Vec<Range<usize>>,
    /// The input as it acts in the model, a value per sample.
    pub acting: &'a [f64],
    /// The input as it was measured, a value per sample.
    pub raw: &'a [f64],
}

/// The lags that are looked at.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Lags {
    /// Samples from one lag to the next, which are also the samples of a mean.
    pub(super) block: usize,
    pub(super) step_s: f64,
    /// Lags on one side.
    pub(super) count: usize,
}

impl Lags {
    /// At most a quarter of the `longest` stretch of samples; `None` where that is none.
    pub(super) fn new(period_s: f64, longest: usize) -> Option<Self> {
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "positive")]
        let rounded = |value: f64| value.round() as usize;
        let block = rounded(LONGEST_S / (MAX_LAGS as f64 * period_s)).max(1);
        let step_s = block as f64 * period_s;
        let wanted = rounded(LONGEST_S / step_s).clamp(MIN_LAGS, MAX_LAGS);
        let count = wanted.min(longest / block / 4);
        (count > 0).then_some(Self { block, step_s, count })
    }

    /// The lag at an index of a list that starts at the lowest one.
    pub(super) fn seconds(self, index: usize) -> f64 {
        (index as f64 - self.count as f64) * self.step_s
    }
}

/// Means of whole blocks of `size` values.
pub(super) fn means(values: &[f64], size: usize) -> Vec<f64> {
    values.chunks_exact(size).map(|block| block.iter().sum::<f64>() / size as f64).collect()
}

/// Takes the mean from `values`.
pub(super) fn centre(values: &mut [f64]) {
    let mean = values.iter().sum::<f64>() / values.len().max(1) as f64;
    for value in values {
        *value -= mean;
    }
}

/// Sums of products from lag 0 to `lags`, over all `series`.
pub(super) fn autocovariance(series: &[Vec<f64>], lags: usize) -> Vec<f64> {
    (0..=lags).map(|lag| products(series, series, lag)).collect()
}

/// The sum of `late_(k + lag) · early_k` over all pairs of series.
pub(super) fn products(late: &[Vec<f64>], early: &[Vec<f64>], lag: usize) -> f64 {
    let pair =
        |(late, early): (&Vec<f64>, &Vec<f64>)| dot(late.get(lag..).unwrap_or_default(), early);
    late.iter().zip(early).map(pair).sum()
}

#[cfg(test)]
pub(super) mod testing {
    use super::TrialSignals;

    /// Slow sampling, so that the longest lag is few samples.
    pub(in super::super) const PERIOD_S: f64 = 0.05;

    pub(in super::super) fn trial<'a>(residual: &'a [f64], input: &'a [f64]) -> TrialSignals<'a> {
        let windows = std::iter::once(0..residual.len()).collect();
        TrialSignals { residual, windows, acting: input, raw: input }
    }

    /// Part of `0..200` that `is_found`.
    pub(in super::super) fn rate(is_found: impl Fn(u64) -> bool) -> f64 {
        (0..200).filter(|seed| is_found(*seed)).count() as f64 / 200.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fast_sampling_has_as_many_lags() {
        let lags = |period_s| Lags::new(period_s, 1_000_000).unwrap();
        assert_eq!((lags(0.01).count, lags(0.01).block), (200, 1));
        assert_eq!((lags(0.001).count, lags(0.001).block), (200, 10));
        assert_eq!((lags(1.0).count, lags(1.0).block), (20, 1));
        assert_eq!(Lags::new(0.01, 100).unwrap().count, 25);
    }
}
