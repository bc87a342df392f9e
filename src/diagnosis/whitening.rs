//! Noise with a memory, and the filter that takes its memory away.

use super::regression::dot;

/// Longest memory of the noise, in samples, that is told from motion.
const LONGEST_MEMORY: usize = 12;

/// Coefficients `a` of `e_k = Σ a_i e_(k−i) + white noise`, the order by Schwarz's
/// criterion, by the recursion of Levinson and Durbin.
pub(crate) fn autoregression(windows: &[Vec<f64>]) -> Vec<f64> {
    let samples: usize = windows.iter().map(Vec::len).sum();
    let covariance = |lag: usize| -> f64 {
        windows.iter().map(|w| dot(w, w.get(lag..).unwrap_or_default())).sum::<f64>()
            / samples.max(1) as f64
    };
    let most = LONGEST_MEMORY.min(samples / 10);
    let covariances: Vec<f64> = (0..=most).map(covariance).collect();
    let Some(&power) = covariances.first().filter(|power| **power > 0.0) else { return Vec::new() };
    let (mut current, mut variance): (Vec<f64>, f64) = (Vec::new(), power);
    let score = |variance: f64, order: usize| {
        samples as f64 * variance.ln() + order as f64 * (samples as f64).ln()
    };
    let mut best = (score(power, 0), Vec::new());
    for order in 1..=most {
        let predicted: f64 = current
            .iter()
            .zip(covariances.iter().take(order).skip(1).rev())
            .map(|(a, c)| a * c)
            .sum();
        let Some(reflection) = covariances.get(order).map(|c| (c - predicted) / variance) else {
            break;
        };
        let turned: Vec<f64> = current.iter().rev().copied().collect();
        for (a, b) in current.iter_mut().zip(turned) {
            *a -= reflection * b;
        }
        current.push(reflection);
        variance *= 1.0 - reflection * reflection;
        if variance <= 0.0 {
            break;
        }
        if score(variance, order) < best.0 {
            best = (score(variance, order), current.clone());
        }
    }
    best.1
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
