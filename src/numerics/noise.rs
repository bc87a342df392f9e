//! Noise with a memory, and the filter that removes it.
//!
//! An autoregression, found in windows of which the mean was subtracted.

use super::autoregression::autoregression;
use super::moments::dot;

/// Longest memory of the noise in the residual of a model, samples: chosen; beyond it, noise
/// cannot be separated from motion.
const LONGEST_OF_RESIDUAL: usize = 12;

/// Values whose memory is taken away at a time: a processor adds a few at once.
const LANES: usize = 8;

/// Noise as an autoregression, `e_k = Σ a_i e_(k−i) + w_k` with white `w`.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct NoiseModel {
    coefficients: Vec<f64>,
}

impl NoiseModel {
    pub(crate) fn white() -> Self {
        Self { coefficients: Vec::new() }
    }

    /// The noise in the residual of a model, of which the mean of each window was subtracted.
    ///
    /// What that takes from the covariances, the variance of the mean of a window, is put
    /// back. It follows from the noise itself, so that both are found by turns.
    pub(crate) fn of_centred(windows: &[Vec<f64>]) -> Self {
        /// Turns; each leaves a small part of what was wrong before.
        const TURNS: usize = 6;
        let measured = covariances_of_pairs(windows);
        let samples: usize = windows.iter().map(Vec::len).sum();
        let found =
            |covariances: &[f64]| Self { coefficients: autoregression(covariances, samples) };
        let mut noise = found(&measured);
        for _ in 0..TURNS {
            if noise.order() == 0 {
                break;
            }
            let removed = noise.mean_variance(windows, measured[0]);
            let whole: Vec<f64> = measured.iter().map(|value| value + removed).collect();
            noise = found(&whole);
        }
        noise
    }

    /// Samples of its memory.
    pub(crate) fn order(&self) -> usize {
        self.coefficients.len()
    }

    /// The variance of the mean of a window, averaged over the samples in them, where the
    /// variance of the noise was measured as `power` after the means were subtracted.
    ///
    /// `var(mean of L) = (c₀ + 2 Σ (1 − h/L) c_h) / L`; with the correlations `r_h = c_h / c₀`
    /// this is `c₀ m`, and the measured power is `c₀ (1 − m)`.
    fn mean_variance(&self, windows: &[Vec<f64>], power: f64) -> f64 {
        /// Largest part of the variance that means are taken to hold: more is no noise.
        const LARGEST: f64 = 0.5;
        let longest = windows.iter().map(Vec::len).max().unwrap_or(0);
        // Running sums over the lags, so that each length costs nothing more.
        let (mut plain, mut weighted) = (vec![0.0], vec![0.0]);
        let (mut sum, mut lagged) = (0.0, 0.0);
        // `plain[h] = Σ r_h` and `weighted[h] = Σ h r_h`, so that Σ (1 − h/L) r_h is their
        // difference.
        for (lag, correlation) in self.correlations(longest).iter().enumerate().skip(1) {
            sum += correlation;
            lagged += lag as f64 * correlation;
            plain.push(sum);
            weighted.push(lagged);
        }
        let part = |length: usize| {
            let last = (length - 1).min(plain.len() - 1);
            (1.0 + 2.0 * (plain[last] - weighted[last] / length as f64)) / length as f64
        };
        let samples: usize = windows.iter().map(Vec::len).sum();
        let filled = windows.iter().map(Vec::len).filter(|length| *length > 0);
        let share = filled.map(|length| length as f64 * part(length)).sum::<f64>();
        let share = (share / samples.max(1) as f64).clamp(0.0, LARGEST);
        // `c₀ m`, with `c₀ = power / (1 − m)`.
        power * share / (1.0 - share)
    }

    /// Correlations of the noise at lags from 0 to below `count`, as far as they matter: the
    /// products of the impulse response with itself.
    pub(crate) fn correlations(&self, count: usize) -> Vec<f64> {
        /// Below this part of its first value the response is over.
        const OVER: f64 = 1e-4;
        /// Longest response.
        const LONGEST: usize = 2000;
        let mut response: Vec<f64> = vec![1.0];
        let mut small = 0;
        while response.len() < LONGEST && small <= self.order() {
            let past = response.iter().rev();
            let next: f64 = self.coefficients.iter().zip(past).map(|(a, x)| a * x).sum();
            // As many small values as the noise has memory: all that follow are small, too.
            small = if next.abs() < OVER { small + 1 } else { 0 };
            response.push(next);
        }
        let power = dot(&response, &response);
        let correlation = |lag: usize| dot(&response, &response[lag..]) / power;
        (0..count.min(response.len())).map(correlation).collect()
    }

    /// Whitens `values` in place; the first ones become 0.
    pub(crate) fn whiten(&self, values: &mut [f64]) {
        let order = self.order();
        if order == 0 {
            return;
        }
        // Backwards: no value is used after it was changed.
        let mut end = values.len();
        while let Some(from) = end.checked_sub(LANES + order) {
            let block = &mut values[from..end];
            let mut sums = [0.0; LANES];
            let past = block.windows(LANES).rev().skip(1);
            for (a, past) in self.coefficients.iter().zip(past) {
                sums.iter_mut().zip(past).for_each(|(sum, y)| *sum += a * y);
            }
            block[order..].iter_mut().zip(sums).for_each(|(y, sum)| *y -= sum);
            end -= LANES;
        }
        for k in (order..end).rev() {
            let recent = values[..k].iter().rev();
            let expected: f64 = self.coefficients.iter().zip(recent).map(|(a, y)| a * y).sum();
            values[k] -= expected;
        }
        // They have no full past.
        let without_past = order.min(values.len());
        values[..without_past].fill(0.0);
    }

    /// Each of the `windows` whitened, without its first samples, which have no past, and
    /// without its mean.
    pub(crate) fn whitened(&self, windows: &[Vec<f64>]) -> Vec<Vec<f64>> {
        let whiten = |window: &Vec<f64>| {
            let mut values = window.clone();
            self.whiten(&mut values);
            values.drain(..self.order().min(window.len()));
            let mean = values.iter().sum::<f64>() / values.len().max(1) as f64;
            for value in &mut values {
                *value -= mean;
            }
            values
        };
        windows.iter().map(whiten).collect()
    }
}

/// Mean products of values so many samples apart, from 0 on, each over its own pairs.
fn covariances_of_pairs(windows: &[Vec<f64>]) -> Vec<f64> {
    let samples: usize = windows.iter().map(Vec::len).sum();
    let covariance = |lag: usize| -> f64 {
        let products = windows.iter().map(|w| w.get(lag..).map_or(0.0, |later| dot(w, later)));
        let pairs: usize = windows.iter().map(|w| w.len().saturating_sub(lag)).sum();
        products.sum::<f64>() / pairs.max(1) as f64
    };
    (0..=LONGEST_OF_RESIDUAL.min(samples / 10)).map(covariance).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::numerics::testing::noise;

    /// Noise of first order in windows, each without its mean.
    fn windows(rho: f64, length: usize, count: usize) -> Vec<Vec<f64>> {
        let centred = |window: &[f64]| {
            let mean = window.iter().sum::<f64>() / length as f64;
            window.iter().map(|value| value - mean).collect()
        };
        noise(5, rho, length * count).chunks_exact(length).map(centred).collect()
    }

    #[test]
    fn the_means_of_short_windows_do_not_shorten_the_memory() {
        for (rho, length) in [(0.0, 100), (0.8, 100), (0.95, 150)] {
            let noise = NoiseModel::of_centred(&windows(rho, length, 400));
            let first = noise.coefficients.first().copied().unwrap_or(0.0);
            assert!((first - rho).abs() < 0.01, "{rho}: {noise:?}");
        }
    }

    #[test]
    fn what_is_whitened_has_no_memory() {
        let noisy = windows(0.9, 500, 40);
        let white = NoiseModel::of_centred(&noisy).whitened(&noisy);
        let covariances = covariances_of_pairs(&white);
        assert!((covariances[1] / covariances[0]).abs() < 0.02, "{covariances:?}");
    }

    #[test]
    fn correlations_of_first_order_are_powers() {
        let noise = NoiseModel { coefficients: vec![0.9] };
        for (lag, found) in noise.correlations(50).into_iter().enumerate() {
            let expected = 0.9_f64.powi(i32::try_from(lag).unwrap());
            assert!((found - expected).abs() < 1e-3);
        }
    }
}
