//! Noise with a memory, and the filter that takes its memory away.

use super::{Autoregression, dot};

/// Longest memory of the noise, in samples, that is told from motion.
const LONGEST_MEMORY: usize = 12;

/// Coefficients `a` of `e_k = Σ a_i e_(k−i) + white noise`.
///
/// The mean of each window is taken for zero, and was taken off: what that took from the
/// covariances, the variance of the mean of a window, is put back. It follows from the
/// noise itself, so that both are found by turns.
pub(crate) fn autoregression(windows: &[Vec<f64>]) -> Vec<f64> {
    /// Turns; each leaves a small part of what was wrong before.
    const TURNS: usize = 6;
    let sampled = covariances(windows);
    let samples: usize = windows.iter().map(Vec::len).sum();
    let mut noise = Autoregression::of(&sampled, samples).coefficients;
    for _ in 0..TURNS {
        if noise.is_empty() {
            break;
        }
        let lost = mean_variance(windows, &noise, sampled.first().copied().unwrap_or_default());
        let whole: Vec<f64> = sampled.iter().map(|covariance| covariance + lost).collect();
        noise = Autoregression::of(&whole, samples).coefficients;
    }
    noise
}

/// Mean products of values so many samples apart, from 0 on.
fn covariances(windows: &[Vec<f64>]) -> Vec<f64> {
    let samples: usize = windows.iter().map(Vec::len).sum();
    let covariance = |lag: usize| -> f64 {
        let products = windows.iter().map(|w| dot(w, w.get(lag..).unwrap_or_default()));
        let pairs: usize = windows.iter().map(|w| w.len().saturating_sub(lag)).sum();
        products.sum::<f64>() / pairs.max(1) as f64
    };
    (0..=LONGEST_MEMORY.min(samples / 10)).map(covariance).collect()
}

/// The variance of the mean of a window, averaged over the samples in them, for noise with
/// the memory `noise` whose variance was sampled as `power` after the means were taken off.
///
/// `var(mean of L) = (c₀ + 2 Σ (1 − h/L) c_h) / L`; with the correlations `r_h = c_h / c₀`
/// this is `c₀ m`, and the sampled power is `c₀ (1 − m)`.
fn mean_variance(windows: &[Vec<f64>], noise: &[f64], power: f64) -> f64 {
    /// Largest part of the variance that means are taken to hold: more is no noise.
    const MOST: f64 = 0.5;
    let longest = windows.iter().map(Vec::len).max().unwrap_or(0);
    let correlations = correlations(noise, longest);
    // Running sums over the lags, so that each length costs nothing more.
    let (mut plain, mut weighted) = (vec![0.0], vec![0.0]);
    let (mut sum, mut lagged) = (0.0, 0.0);
    for (lag, correlation) in correlations.iter().enumerate().skip(1) {
        sum += correlation;
        lagged += lag as f64 * correlation;
        plain.push(sum);
        weighted.push(lagged);
    }
    let part = |length: usize| {
        let last = length.saturating_sub(1).min(plain.len() - 1);
        let at = |sums: &[f64]| sums.get(last).copied().unwrap_or_default();
        (1.0 + 2.0 * (at(&plain) - at(&weighted) / length as f64)) / length as f64
    };
    let samples: usize = windows.iter().map(Vec::len).sum();
    let filled = windows.iter().map(Vec::len).filter(|length| *length > 0);
    let share = filled.map(|length| length as f64 * part(length)).sum::<f64>();
    let share = (share / samples.max(1) as f64).clamp(0.0, MOST);
    power * share / (1.0 - share)
}

/// Correlations of noise with the memory `noise` at lags from 0 to below `count`, as far as
/// they matter.
pub(crate) fn correlations(noise: &[f64], count: usize) -> Vec<f64> {
    // Impulse response, whose products with itself are the covariances.
    /// Below this part of its first value the response is over.
    const OVER: f64 = 1e-4;
    /// Longest response.
    const LONGEST: usize = 2000;
    let mut response: Vec<f64> = vec![1.0];
    let mut small = 0;
    while response.len() < LONGEST && small <= noise.len() {
        let past = response.iter().rev();
        let next: f64 = noise.iter().zip(past).map(|(a, x)| a * x).sum();
        small = if next.abs() < OVER { small + 1 } else { 0 };
        response.push(next);
    }
    let power = dot(&response, &response);
    let correlation = |lag: usize| dot(&response, response.get(lag..).unwrap_or_default()) / power;
    (0..count.min(response.len())).map(correlation).collect()
}

/// `x_k − Σ a_i x_(k−i)`, and the mean of each window off; its first samples are lost.
pub(crate) fn whitened(windows: &[Vec<f64>], noise: &[f64]) -> Vec<Vec<f64>> {
    let order = noise.len();
    let filter = |window: &Vec<f64>| {
        let mut filtered: Vec<f64> = window
            .windows(order + 1)
            .map(|values| {
                let past = values.iter().rev().skip(1);
                let now = values.last().copied().unwrap_or_default();
                now - noise.iter().zip(past).map(|(a, x)| a * x).sum::<f64>()
            })
            .collect();
        let mean = filtered.iter().sum::<f64>() / filtered.len().max(1) as f64;
        for value in &mut filtered {
            *value -= mean;
        }
        filtered
    };
    windows.iter().map(filter).collect()
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
            let noise = autoregression(&windows(rho, length, 400));
            let first = noise.first().copied().unwrap_or_default();
            assert!((first - rho).abs() < 0.01, "{rho}: {noise:?}");
        }
    }

    #[test]
    fn what_is_whitened_has_no_memory_left() {
        let noisy = windows(0.9, 500, 40);
        let white = whitened(&noisy, &autoregression(&noisy));
        let covariances = covariances(&white);
        assert!((covariances[1] / covariances[0]).abs() < 0.02, "{covariances:?}");
    }

    #[test]
    fn correlations_of_first_order_are_powers() {
        for (lag, found) in correlations(&[0.9], 50).into_iter().enumerate() {
            let expected = 0.9_f64.powi(i32::try_from(lag).unwrap());
            assert!((found - expected).abs() < 1e-3);
        }
    }
}
