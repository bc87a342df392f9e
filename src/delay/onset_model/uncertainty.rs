//! What an onset's interval is made of.
//!
//! - *Its own error.* Positions whose squared error is within `σ² t²` of the least, with `σ²` from
//!   the window and from all windows of the joint, and `t` Student's quantile.
//! - *The memory of what is left.* Residuals that go together over `L` samples count as fewer; the
//!   variance grows by `1 + 2 Σ (1 − l/(L+1)) ρ_l`, the largest over some `L`, so that what the
//!   shape leaves over widens the interval as a slow noise does.
//! - *The shared parameters*, by the delta method.
//! - *The choice of the shape.* Other shapes count by `e^(−ΔS/θ)`, with `ΔS` the difference of
//!   their criteria and `θ` the memory, by which the samples are fewer than they look.
//!
//! The last two move all onsets of a joint together.
//!
//! # References
//! M. S. Bartlett's weights as in W. K. Newey and K. D. West, Econometrica 55 (1987).

use super::search::{Candidate, Search};
use super::windows::{Onset, Run, all};
use crate::numerics::{median, noise_of_bends, quantile};

/// What the residuals of all windows of a joint say.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Residual {
    /// Standard deviation of what the shape leaves over in a window, at the median.
    pub(super) deviation: f64,
    /// By how much its memory enlarges variances.
    pub(super) memory: f64,
    /// The largest mean residual at one distance from the onset over all steps, in deviations, and
    /// in its standard errors.
    pub(super) systematic: (f64, f64),
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
    /// Of the windows of `candidate`.
    pub(super) fn of<'a>(search: &'a Search, candidate: &'a Candidate) -> Self {
        let pass = search.pass(candidate.shape, candidate.typical);
        let per_window = pass.response.parameters() as f64;
        let left = |(run, index, onset): (&Run, usize, &'a Onset)| {
            let fitted = pass.fitted(run, index, onset);
            let measured = run.output.get(onset.start..onset.end)?;
            let left = measured.iter().zip(&fitted).map(|(y, fitted)| y - fitted);
            Some((onset, left.collect::<Vec<f64>>()))
        };
        let windows: Vec<(&Onset, Vec<f64>)> =
            all(&search.runs, &candidate.onsets).filter_map(left).collect();
        // A window that something else disturbed is no measure of the others.
        let variances = windows
            .iter()
            .map(|(onset, left)| onset.sse / (left.len() as f64 - per_window).max(1.0));
        let deviation = median(&variances.collect::<Vec<f64>>()).unwrap_or(0.0).sqrt();
        Self {
            deviation,
            memory: memory(windows.iter().map(|(_, left)| left.as_slice())),
            systematic: systematic(&windows, deviation),
        }
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

/// The largest mean over all steps of the residuals at one distance from their onsets, the sign that of
/// the onset: in deviations, and in standard errors. A noise with a memory has none.
fn systematic(windows: &[(&Onset, Vec<f64>)], deviation: f64) -> (f64, f64) {
    /// Distances between which residuals are averaged, samples.
    const EDGES: [f64; 15] =
        [-64.0, -32.0, -16.0, -8.0, -4.0, -2.0, 0.0, 2.0, 4.0, 8.0, 16.0, 32.0, 64.0, 128.0, 256.0];
    /// Steps of which a mean is taken.
    const FEWEST: usize = 6;
    let between = |from: f64, to: f64| -> Vec<f64> {
        let clear = windows.iter().filter(|(onset, _)| onset.is_clear);
        let mean = |(onset, left): &(&Onset, Vec<f64>)| {
            let origin = onset.position - onset.start as f64;
            let at = left.iter().enumerate().filter(|(k, _)| {
                let distance = *k as f64 - origin;
                (from..to).contains(&distance)
            });
            let (sum, count) = at.fold((0.0, 0.0), |(sum, n), (_, e)| (sum + e, n + 1.0));
            (count > 0.0).then(|| sum / count * onset.size.signum())
        };
        clear.filter_map(mean).collect()
    };
    let of_pair = |pair: &[f64]| {
        let means = between(pair[0], pair[1]);
        if means.len() < FEWEST || deviation <= 0.0 {
            return (0.0, 0.0);
        }
        let n = means.len() as f64;
        let mean = means.iter().sum::<f64>() / n;
        let square: f64 = means.iter().map(|x| (x - mean) * (x - mean)).sum();
        let error = (square / (n * (n - 1.0))).sqrt().max(f64::MIN_POSITIVE);
        (mean.abs() / deviation, mean.abs() / error)
    };
    let found = EDGES.windows(2).map(of_pair);
    // A mean counts as far as it is known.
    found.max_by(|a, b| a.1.min(10.0 * a.0).total_cmp(&b.1.min(10.0 * b.0))).unwrap_or((0.0, 0.0))
}

/// How far the choice of the shape moves all onsets, samples: the standard deviation of typical delays
/// about that of the chosen shape, each weighted as its criterion says.
pub(super) fn choice(candidates: &[Candidate], temperature: f64) -> f64 {
    let Some(chosen) = candidates.first() else { return 0.0 };
    let weighted = candidates.iter().map(|it| {
        let weight = (-(it.score - chosen.score) / temperature).exp();
        (weight, weight * (it.typical - chosen.typical).powi(2))
    });
    let known = weighted.filter(|(_, square)| square.is_finite());
    let (sum, squares) = known.fold((0.0, 0.0), |(a, b), (w, s)| (a + w, b + s));
    if sum > 0.0 { (squares / sum).sqrt() } else { 0.0 }
}
