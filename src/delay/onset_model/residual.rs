//! What a shape leaves over, and how far that may move onsets.
//!
//! - *Memory.* Residuals that go together over `L` samples count as fewer; the variance of an onset
//!   grows by `1 + 2 Σ (1 − l/(L+1)) ρ_l`, the largest over some `L`, so that what the shape leaves
//!   over widens the interval as a slow noise does.
//! - *Pattern.* What all steps have in common as a function of the time since the onset is not noise:
//!   its energy widens the interval, and says that the shape does not fit.
//!
//! # References
//! M. S. Bartlett's weights as in W. K. Newey and K. D. West, Econometrica 55 (1987).

use super::windows::{Onset, Onsets, Pass, Run, Step, all};
use crate::numerics::{median, noise_of_bends, quantile};
use crate::units::ceil_to_index;

/// Standard deviations from which a pattern in the residuals is none of noise: once in a million of the
/// fourteen squares that it is made of; and where one was found already.
pub(super) const PLAIN_AT_FIRST: f64 = 8.0;
pub(super) const PLAIN_AGAIN: f64 = 4.0;

/// What the residuals of all windows of a joint say.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Residual {
    /// Standard deviation of what the shape leaves over in a window, at the median.
    pub(super) deviation: f64,
    /// By how much its memory enlarges variances.
    pub(super) memory: f64,
    /// What all steps have in common of it.
    pub(super) pattern: Pattern,
}

/// The mean residual as a function of the distance from the onset, over all steps.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Pattern {
    /// Its energy in a window, in variances of a residual: it may move an onset by the root of that many
    /// of its standard errors.
    pub(super) energy: f64,
    /// Standard deviation of that energy where there is only noise.
    error: f64,
}

/// Standard deviation of a sensor's noise, from differences of second order of what it measured; of
/// a coarse one that of its quantum.
pub(super) fn sensor_noise<'a>(outputs: &(impl Iterator<Item = &'a [f64]> + Clone)) -> f64 {
    /// Part of samples that repeat the one before, from which a sensor is coarse (chosen).
    const REPEATED: f64 = 0.05;
    /// Part of the changes that may be smaller than a quantum, by the noise of numbers.
    const QUANTUM: f64 = 0.1;
    let noise = noise_of_bends(outputs.clone().flat_map(|y| y.windows(3)));
    let pairs = || outputs.clone().flat_map(|y| y.windows(2));
    #[expect(clippy::float_cmp, reason = "a repeated value")]
    let repeated = pairs().filter(|y| y[0] == y[1]).count() as f64;
    if repeated <= REPEATED * pairs().count() as f64 {
        return noise;
    }
    // A quantum, which few changes are below, has a uniform error.
    let changes: Vec<f64> = pairs().map(|y| (y[1] - y[0]).abs()).filter(|d| *d > 0.0).collect();
    noise.max(quantile(&changes, QUANTUM).unwrap_or(0.0) / 12.0_f64.sqrt())
}

impl Residual {
    /// Of the windows of the onsets of some steps.
    pub(super) fn of(
        runs: &[Run],
        onsets: &[Onsets],
        pass: &Pass,
        is_one: impl Fn(&Step) -> bool,
    ) -> Self {
        let left = |(run, index, onset): (&Run, usize, &Onset)| {
            let fitted = pass.fitted(run, index, onset);
            let measured = run.output.get(onset.start..onset.end)?;
            let left: Vec<f64> =
                measured.iter().zip(&fitted).map(|(y, fitted)| y - fitted).collect();
            let parameters = pass.response(run.steps[index].kind).parameters();
            let variance = onset.sse / (left.len() as f64 - parameters as f64).max(1.0);
            Some((*onset, variance, left))
        };
        let windows: Vec<(Onset, f64, Vec<f64>)> = all(runs, onsets)
            .filter(|(run, index, _)| is_one(&run.steps[*index]))
            .filter_map(left)
            .collect();
        // A window that something else disturbed is no measure of the others.
        let variances: Vec<f64> = windows.iter().map(|(_, variance, _)| *variance).collect();
        let deviation = median(&variances).unwrap_or(0.0).sqrt();
        let memory = memory(windows.iter().map(|(.., left)| left.as_slice()));
        Self { deviation, memory, pattern: Pattern::of(&windows, deviation, memory) }
    }
}

/// By how much the memory of residuals enlarges variances.
pub(in crate::delay) fn memory<'a>(windows: impl Iterator<Item = &'a [f64]> + Clone) -> f64 {
    /// Samples over which residuals may go together, and the part of a window that these may be.
    const REACHES: [usize; 6] = [2, 5, 10, 20, 40, 100];
    const PART: usize = 3;
    const FEWEST: usize = 20;
    let windows = windows.filter(|window| window.len() > FEWEST);
    let shortest = windows.clone().map(<[f64]>::len).min().unwrap_or(0);
    let product = |lag: usize| -> f64 {
        let pairs = windows.clone().flat_map(|window| window.iter().zip(&window[lag..]));
        pairs.map(|(a, b)| a * b).sum()
    };
    let power = product(0);
    if power <= 0.0 {
        return 1.0;
    }
    let longest = REACHES.iter().rev().find(|reach| **reach <= shortest / PART);
    let correlations: Vec<f64> =
        (1..=longest.copied().unwrap_or(0)).map(|lag| product(lag) / power).collect();
    let of_reach = |reach: &usize| {
        let weighted = correlations.iter().take(*reach).zip(1..);
        let weight = |lag: i32| 1.0 - f64::from(lag) / (*reach as f64 + 1.0);
        1.0 + 2.0 * weighted.map(|(rho, lag)| weight(lag) * rho).sum::<f64>()
    };
    let reaches = REACHES.iter().take_while(|reach| **reach <= correlations.len());
    reaches.map(of_reach).fold(1.0, f64::max)
}

impl Pattern {
    const NONE: Self = Self { energy: 0.0, error: 0.0 };

    /// Whether it is more than noise by so many standard deviations, and large enough to move onsets by
    /// more than their standard errors.
    pub(super) fn is_plain(&self, deviations: f64) -> bool {
        const LARGE: f64 = 1.0;
        self.energy > LARGE && self.energy > deviations * self.error
    }

    /// Of windows whose residuals have a `memory`; the sign of each is that of its onset.
    fn of(windows: &[(Onset, f64, Vec<f64>)], deviation: f64, memory: f64) -> Self {
        /// Distances between which residuals are averaged, samples.
        const EDGES: [f64; 15] = [
            -64.0, -32.0, -16.0, -8.0, -4.0, -2.0, 0.0, 2.0, 4.0, 8.0, 16.0, 32.0, 64.0, 128.0,
            256.0,
        ];
        /// Steps of which a mean is taken.
        const FEWEST: usize = 6;
        let clear: Vec<_> = windows.iter().filter(|(onset, ..)| onset.is_clear).collect();
        if deviation <= 0.0 || clear.len() < FEWEST {
            return Self::NONE;
        }
        let (steps, mut energy, mut means) = (clear.len() as f64, 0.0, 0.0);
        for edges in EDGES.windows(2) {
            // Each mean times the root of its samples, in standard deviations.
            let of_window = |(onset, _, left): &&(Onset, f64, Vec<f64>)| {
                let origin = onset.position - onset.start as f64;
                let index = |edge: f64| ceil_to_index((origin + edge).max(0.0)).min(left.len());
                let part = &left[index(edges[0])..index(edges[1])];
                let sum = part.iter().sum::<f64>() * onset.size.signum();
                (!part.is_empty()).then(|| sum / (part.len() as f64).sqrt() / deviation)
            };
            let found: Vec<f64> = clear.iter().filter_map(of_window).collect();
            let n = found.len() as f64;
            if found.len() < FEWEST {
                continue;
            }
            let mean = found.iter().sum::<f64>() / n;
            let square: f64 = found.iter().map(|x| (x - mean) * (x - mean)).sum();
            // The square of a mean is larger by its variance.
            energy += n / steps * (mean * mean - square / (n * (n - 1.0)));
            means += 1.0;
        }
        Self { energy: energy.max(0.0), error: memory * f64::sqrt(2.0 * means) / steps }
    }
}
