//! The onset of a motion that gathers speed from rest: a power of the time since.
//!
//! ```text
//! y_k = A + c·max(k − τ, 0)^m + e_k        1 ≤ m ≤ 4
//! ```
//!
//! Behind a dead time τ an output that rests starts in proportion to `(t − τ)^m`, whatever it does
//! later: `m = 1` where its speed steps, 2 behind a first-order lag or at a constant acceleration,
//! 3 behind two lags. So τ is found without a lag that other steps share, which strokes do not
//! show. For every τ and `m` the rest is linear; the interval holds every τ whose squared error,
//! at its best `m`, is within `t²·s²·g` of the least one, where `g = 1 + 2·Σ ρ_j` is how much
//! less residuals that remember each other say than as many independent ones.

use std::ops::Range;

use crate::delay::interval::FineDelay;
use crate::numerics::{autocovariances, student_quantile};

/// Powers that are tried.
const POWERS: [f64; 7] = [1.0, 1.5, 2.0, 2.5, 3.0, 3.5, 4.0];

/// Parts of a sample between two positions that are tried.
const FINENESS: usize = 4;

/// Level, size, power and onset.
const PARAMETERS: usize = 4;

/// Fewest samples.
const FEWEST: usize = 10;

/// The onset in a window; positions are indices of the window.
#[derive(Clone, Debug)]
pub(crate) struct GradualOnset {
    /// Where it is most likely, with its interval.
    pub(crate) position: f64,
    pub(crate) low: f64,
    pub(crate) high: f64,
    /// The level before it.
    pub(crate) level: f64,
    /// The first sample at which it was tried, and the least squared error there and at the
    /// samples behind it.
    pub(crate) first: usize,
    pub(crate) sse: Vec<f64>,
}

/// One onset with one power: what it leaves.
#[derive(Clone, Copy, Debug)]
struct Tried {
    position: f64,
    power: f64,
    level: f64,
    size: f64,
    sse: f64,
}

impl GradualOnset {
    /// The best onset of `values` within `positions`, with an interval that holds the true one
    /// as often as `confidence` says. `None` for fewer than ten values or no position.
    pub(crate) fn of(values: &[f64], positions: Range<usize>, confidence: f64) -> Option<Self> {
        if values.len() < FEWEST || positions.is_empty() {
            return None;
        }
        let first = positions.start;
        let count = (positions.end - first) * FINENESS;
        let at = |n: usize| first as f64 + n as f64 / FINENESS as f64;
        let profile: Vec<Tried> = (0..count).map(|n| best_at(values, at(n))).collect();
        let best = *profile.iter().min_by(|a, b| a.sse.total_cmp(&b.sse))?;
        let freedom = (values.len() - PARAMETERS) as f64;
        let t = student_quantile(f64::midpoint(1.0, confidence), freedom);
        let limit = best.sse * (1.0 + t * t * best.memory(values) / freedom);
        let good = |tried: &&Tried| tried.sse <= limit;
        let half = 0.5 / FINENESS as f64;
        let low = profile.iter().find(good)?.position - half;
        let high = profile.iter().rev().find(good)?.position + half;
        let sse = profile.iter().step_by(FINENESS).map(|tried| tried.sse).collect();
        let Tried { position, level, .. } = best;
        Some(Self { position, low, high, level, first, sse })
    }

    /// As a delay of a step at the index `origin` of the window.
    pub(crate) fn delay(&self, origin: f64, confidence: f64) -> FineDelay {
        let [delay, low, high] = [self.position, self.low, self.high].map(|at| at - origin);
        FineDelay::causal(delay, low, high, confidence)
    }
}

/// The best power for an onset at `position`.
fn best_at(values: &[f64], position: f64) -> Tried {
    let all = POWERS.map(|power| Tried::of(values, position, power));
    let least = all.into_iter().min_by(|a, b| a.sse.total_cmp(&b.sse));
    least.unwrap_or(Tried { position, power: 1.0, level: 0.0, size: 0.0, sse: f64::INFINITY })
}

impl Tried {
    /// Level and size by least squares.
    fn of(values: &[f64], position: f64, power: f64) -> Self {
        let length = values.len() as f64;
        let origin = values.first().copied().unwrap_or_default();
        let (mut h1, mut h2, mut y1, mut y2, mut hy) = (0.0, 0.0, 0.0, 0.0, 0.0);
        for (k, value) in values.iter().enumerate() {
            let (h, y) = (shape(k, position, power, length), value - origin);
            (h1, h2, y1, y2, hy) = (h1 + h, h2 + h * h, y1 + y, y2 + y * y, hy + h * y);
        }
        let (spread, product) = (h2 - h1 * h1 / length, hy - h1 * y1 / length);
        let size = if spread > 0.0 { product / spread } else { 0.0 };
        let sse = (y2 - y1 * y1 / length - size * product).max(0.0);
        let level = origin + (y1 - size * h1) / length;
        Self { position, power, level, size, sse }
    }

    /// `1 + 2·Σ ρ_j` of what it leaves, up to the first correlation that is not positive.
    fn memory(&self, values: &[f64]) -> f64 {
        let length = values.len() as f64;
        let fitted = |k| self.level + self.size * shape(k, self.position, self.power, length);
        let left: Vec<f64> = values.iter().enumerate().map(|(k, y)| y - fitted(k)).collect();
        let covariances = autocovariances(&[left], values.len() / 3);
        let power = covariances.first().copied().unwrap_or_default();
        let positive = covariances.iter().skip(1).take_while(|covariance| **covariance > 0.0);
        let sum: f64 = positive.sum();
        if power > 0.0 { 1.0 + 2.0 * sum / power } else { 1.0 }
    }
}

/// `max(k − τ, 0)^m`, as a part of the window to the same power.
fn shape(k: usize, position: f64, power: f64, length: f64) -> f64 {
    ((k as f64 - position).max(0.0) / length).powf(power)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn noise(seed: u64) -> impl FnMut() -> f64 {
        let mut state = seed;
        move || {
            let mut sum = 0.0;
            for _ in 0..12 {
                state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
                sum += (state >> 40) as f64 / (1_u64 << 24) as f64;
            }
            sum - 6.0
        }
    }

    fn motion(onset: f64, power: f64) -> impl Fn(usize) -> f64 {
        move |k| 40.0 + 0.002 * (k as f64 - onset).max(0.0).powf(power)
    }

    #[test]
    fn an_onset_of_any_power_is_found() {
        for power in [1.0, 2.0, 3.0] {
            let values: Vec<f64> = (0..80).map(motion(31.3, power)).collect();
            let found = GradualOnset::of(&values, 10..45, 0.95).unwrap();
            assert!((found.position - 31.3).abs() < 0.3, "{power}: {found:?}");
            assert!((found.level - 40.0).abs() < 0.05);
        }
    }

    #[test]
    fn intervals_hold_the_onset_as_often_as_they_say() {
        let mut noise = noise(5);
        for power in [1.0, 2.0, 3.0] {
            let clean: Vec<f64> = (0..90).map(motion(40.4, power)).collect();
            let size = 0.01 * (clean[89] - clean[0]);
            let mut held = 0;
            for _ in 0..200 {
                let values: Vec<f64> = clean.iter().map(|y| y + size * noise()).collect();
                let found = GradualOnset::of(&values, 10..60, 0.95).unwrap();
                held += usize::from(found.low <= 40.4 && 40.4 <= found.high);
            }
            assert!((180..=199).contains(&held), "{power}: {held} of 200");
        }
    }

    #[test]
    fn what_is_too_short_has_none() {
        assert!(GradualOnset::of(&[1.0; 9], 2..5, 0.95).is_none());
        assert!(GradualOnset::of(&[1.0; 50], 5..5, 0.95).is_none());
    }
}
