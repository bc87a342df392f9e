//! The onset of a motion that gathers speed from rest: a ramp after a lag of its own.
//!
//! ```text
//! y_k = A + B·k + c·r((k − τ)/T; n) + e_k        n = 0, 1, … 5
//! r(z; n) = z·P(n, z) − n·P(n + 1, z)            for z > 0, else 0
//! ```
//!
//! After a dead time τ an output that rests, or creeps at an even speed `B`, starts in a way of
//! its own: `r` is the answer of `n` equal lags in a row, of time constant `T`, to a ramp, with
//! the incomplete gamma function `P(n, z) = 1 − e^(−z)·Σ_(j<n) z^j/j!`. It begins as `z^(n+1)`
//! and goes over into a line: `n = 0` where the speed steps, 1 after a first-order lag, and as
//! `T` grows a power of the time. So τ is found without a lag that other steps share, which
//! strokes do not show.
//!
//! Only the start is of that shape. The window ends as far after the departure, the first sample
//! that is plainly off the rest, as the departure is after the onset; sooner, while the residual
//! after the step has more than [`LACKING`] times the variance of the rest before it. For every
//! τ, `n` and `T` the rest is linear; the interval holds every τ whose squared error, at its best
//! `n` and `T`, is within `t²·s²·g` of the least one, where `g = 1 + 2·Σ ρ_j` is how much less
//! residuals that remember each other say than as many independent ones.

use std::ops::Range;

use crate::delay::interval::FineDelay;
use crate::numerics::{autocovariances, student_quantile};
use crate::units::ceil_to_index;

/// The order of the lag, at most. Chosen on simulated cylinders: with 4 intervals hold too little where
/// the sensor is good, with 6 too much.
const ORDERS: i32 = 5;

/// The shortest time constant, in samples, and each over the one before it.
const SHORTEST: f64 = 0.7;
const RATIO: f64 = 1.5;

/// Parts of a sample between two positions that are tried.
const FINENESS: usize = 4;

/// Level, speed, size, shape and onset.
const PARAMETERS: usize = 5;

/// Fewest samples of rest.
const FEWEST: usize = 8;

/// Samples after the departure, at least: as many as make one.
const BEHIND: usize = 3;

/// Each shorter window, in parts of what the one before reaches beyond the departure.
const SHORTER: f64 = 0.7;

/// Times the variance of the rest from which a window is too long. Chosen on simulated cylinders:
/// with 1.5 intervals hold too little, 1.1 changes nothing.
const LACKING: f64 = 1.3;

/// What is known of a window before an onset is looked for; positions are its indices.
#[derive(Clone, Debug)]
pub(in crate::delay) struct FromRest {
    /// Samples before the step, at which the joint rested.
    pub(in crate::delay) rest: usize,
    /// Where the onset may be.
    pub(in crate::delay) positions: Range<usize>,
    /// The first sample that is plainly off the rest.
    pub(in crate::delay) departed: usize,
}

/// The delay of a step after `start.rest` of `values`, with an interval that holds the true one as
/// often as `confidence` says. `None` for less than eight samples of rest, three after the departure,
/// or no position.
pub(in crate::delay) fn gradual_onset(
    values: &[f64],
    start: &FromRest,
    confidence: f64,
) -> Option<FineDelay> {
    let FromRest { rest, departed, .. } = *start;
    let shortest = departed + BEHIND;
    if rest < FEWEST || start.positions.is_empty() || values.len() < shortest {
        return None;
    }
    let at_rest = Window::of(values.get(..rest)?);
    let variance = at_rest.sse / (rest as f64 - 2.0);
    // No window reaches farther after the departure than that is after the first position.
    let farthest = departed + BEHIND.max(departed.saturating_sub(start.positions.start) + 1);
    let longest = farthest.min(values.len());
    let shapes = shapes(longest, values.len());
    let tried = |end: usize| Some(Profile::of(Window::of(values.get(..end)?), start, &shapes));
    let first = tried(shortest)?;
    let mut behind = departed as f64 - first.best()?.position;
    loop {
        let end = (departed + ceil_to_index(behind)).clamp(shortest, longest);
        let profile = if end == shortest { first.clone() } else { tried(end)? };
        let sse = profile.best()?.sse;
        let freedom = ((end - rest) as f64 - (PARAMETERS - 2) as f64).max(1.0);
        let lack = (sse - at_rest.sse).max(0.0) / freedom;
        if lack <= LACKING * variance || end == shortest {
            return profile.onset(variance.max(lack), (rest as f64, confidence));
        }
        behind *= SHORTER;
    }
}

/// What is left of values beside the line through them.
#[derive(Clone, Debug)]
struct Window {
    residuals: Vec<f64>,
    sse: f64,
}

impl Window {
    fn of(values: &[f64]) -> Self {
        let middle = (values.len() as f64 - 1.0) / 2.0;
        let mean = values.iter().sum::<f64>() / values.len() as f64;
        let times = || (0..values.len()).map(|k| k as f64 - middle);
        let with: f64 = times().zip(values).map(|(x, y)| x * (y - mean)).sum();
        let slope = with / times().map(|x| x * x).sum::<f64>();
        let residuals: Vec<f64> = times().zip(values).map(|(x, y)| y - mean - slope * x).collect();
        let sse = residuals.iter().map(|r| r * r).sum();
        Self { residuals, sse }
    }

    /// The size of `shape`, which is zero before `first`, beside the line, and the squared error.
    fn with(&self, first: usize, shape: impl Iterator<Item = f64>) -> (f64, f64) {
        let length = self.residuals.len() as f64;
        let middle = (length - 1.0) / 2.0;
        let (mut sum, mut with_time, mut square, mut product) = (0.0, 0.0, 0.0, 0.0);
        for ((k, residual), h) in self.residuals.iter().enumerate().skip(first).zip(shape) {
            sum += h;
            with_time += h * (k as f64 - middle);
            square += h * h;
            product += h * residual;
        }
        // Σ (k − middle)².
        let times = length * (length * length - 1.0) / 12.0;
        // |h|² beside the line, whose columns 1 and k − middle are orthogonal.
        let own = square - sum * sum / length - with_time * with_time / times;
        if own <= f64::EPSILON * square {
            return (0.0, self.sse);
        }
        let size = product / own;
        (size, (self.sse - size * product).max(0.0))
    }
}

/// A shape, at every part of a sample after its onset.
type Table = Vec<f64>;

/// The shapes that are tried over `samples`, with time constants up to half of `all`.
fn shapes(samples: usize, all: usize) -> Vec<Table> {
    let table = |shape: &dyn Fn(f64) -> f64| -> Table {
        let parts = 0..samples * FINENESS;
        parts.map(|part| shape(part as f64 / FINENESS as f64)).collect()
    };
    // Longer ones are powers of the time, which have a table of their own.
    let longest = all as f64 / 2.0;
    let constants = std::iter::successors(Some(SHORTEST), |constant| Some(constant * RATIO));
    let constants: Vec<f64> = constants.take_while(|constant| *constant < longest).collect();
    let mut tables = vec![table(&|time| time)];
    for order in 1..=ORDERS {
        let lagged = |constant: &f64| table(&|time| lagged_ramp(time / constant, order));
        tables.extend(constants.iter().map(lagged));
        // The limit of r for T much longer than the window: z^(n+1) up to a factor.
        tables.push(table(&|time| (time / longest).powi(order + 1)));
    }
    tables
}

/// A shape for an onset at `position`, and the first sample after it.
fn behind(table: &[f64], position: f64) -> (usize, impl Iterator<Item = f64>) {
    let first = ceil_to_index(position);
    let part = ((first as f64 - position) * FINENESS as f64).round();
    (first, table.iter().skip(ceil_to_index(part)).step_by(FINENESS).copied())
}

/// `r(z; n)`, the answer of `n` equal lags in a row to a ramp, over the time constant.
fn lagged_ramp(z: f64, order: i32) -> f64 {
    let n = f64::from(order);
    // r(z; n) = z·P(n, z) − n·P(n + 1, z).
    z * gamma_below(order, z) - n * gamma_below(order + 1, z)
}

/// `P(n, z)`, the regularised incomplete gamma function of a whole number.
fn gamma_below(n: i32, z: f64) -> f64 {
    let terms = (1..n).scan(1.0, |term, j| {
        *term *= z / f64::from(j);
        Some(*term)
    });
    1.0 - (-z).exp() * (1.0 + terms.sum::<f64>())
}

/// One onset with its best shape, and the squared error.
#[derive(Clone, Copy, Debug)]
struct Tried {
    position: f64,
    shape: usize,
    size: f64,
    sse: f64,
}

/// The best shape for every onset that is tried in a window.
#[derive(Clone)]
struct Profile<'a> {
    window: Window,
    tried: Vec<Tried>,
    shapes: &'a [Table],
}

impl<'a> Profile<'a> {
    fn of(window: Window, start: &FromRest, shapes: &'a [Table]) -> Self {
        let first = start.positions.start;
        let best = |number: usize| {
            let position = first as f64 + number as f64 / FINENESS as f64;
            let tried = shapes.iter().enumerate().map(|(shape, table)| {
                let (first, values) = behind(table, position);
                let (size, sse) = window.with(first, values);
                Tried { position, shape, size, sse }
            });
            tried.min_by(|a, b| a.sse.total_cmp(&b.sse))
        };
        let tried = (0..start.positions.len() * FINENESS).filter_map(best).collect();
        Self { window, tried, shapes }
    }

    fn best(&self) -> Option<Tried> {
        self.tried.iter().copied().min_by(|a, b| a.sse.total_cmp(&b.sse))
    }

    /// The delay after the sample `origin` with its interval, where noise has at least this `variance`.
    fn onset(&self, variance: f64, (origin, confidence): (f64, f64)) -> Option<FineDelay> {
        let best = self.best()?;
        let samples = self.window.residuals.len();
        let freedom = (samples as f64 - PARAMETERS as f64).max(1.0);
        let t = student_quantile(f64::midpoint(1.0, confidence), freedom);
        let variance = variance.max(best.sse / freedom);
        let pairs = self.window.residuals.iter().zip(self.shape(&best));
        let residuals: Vec<f64> = pairs.map(|(y, h)| y - best.size * h).collect();
        // SSE(τ) ≤ SSE + t²·s²·g.
        let limit = best.sse + t * t * variance * memory(residuals);
        let good = |tried: &&Tried| tried.sse <= limit;
        // The ends lie between positions that were tried.
        let between = 1.0 / FINENESS as f64;
        let low = self.tried.iter().find(good)?.position - between;
        let high = self.tried.iter().rev().find(good)?.position + between;
        Some(FineDelay::causal(best.position - origin, low - origin, high - origin, confidence))
    }

    /// The shape of `tried` over the window, beside a line.
    fn shape(&self, tried: &Tried) -> Vec<f64> {
        let (first, behind) = behind(&self.shapes[tried.shape], tried.position);
        let values = std::iter::repeat_n(0.0, first).chain(behind);
        Window::of(&values.take(self.window.residuals.len()).collect::<Vec<_>>()).residuals
    }
}

/// `1 + 2·Σ ρ_j` of residuals, up to the first correlation that is not positive.
fn memory(residuals: Vec<f64>) -> f64 {
    let lags = residuals.len() / 3;
    let covariances = autocovariances(&[residuals], lags);
    let power = covariances[0];
    let positive = covariances[1..].iter().take_while(|covariance| **covariance > 0.0);
    let sum: f64 = positive.sum();
    if power > 0.0 { 1.0 + 2.0 * sum / power } else { 1.0 }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::numerics::testing::noise;

    /// A rest of 40 samples before the step, creeping, and a motion that starts at `onset`.
    fn motion(onset: f64, start: impl Fn(f64) -> f64) -> Vec<f64> {
        let value = |k: usize| {
            let time = (k as f64 - onset).max(0.0);
            40.0 - 0.001 * k as f64 + start(time)
        };
        (0..110).map(value).collect()
    }

    fn found(values: &[f64], departed: usize) -> FineDelay {
        let start = FromRest { rest: 40, positions: 35..departed + 1, departed };
        gradual_onset(values, &start, 0.95).unwrap()
    }

    fn departure(values: &[f64], plain: f64) -> usize {
        values.iter().enumerate().position(|(k, y)| y - 40.0 + 0.001 * k as f64 > plain).unwrap()
    }

    #[test]
    fn a_lagged_ramp_answers_as_the_lags_do() {
        // Order 1: z − 1 + e^(−z); in small steps for all.
        assert!((lagged_ramp(1.3, 1) - (0.3 + (-1.3_f64).exp())).abs() < 1e-12);
        for order in 1..=4 {
            let (mut states, step) = (vec![0.0; usize::try_from(order).unwrap()], 1e-4);
            for k in 0..30_000 {
                let mut input = f64::from(k) * step;
                for state in &mut states {
                    *state += step * (input - *state);
                    input = *state;
                }
            }
            let last = *states.last().unwrap();
            assert!((lagged_ramp(3.0, order) - last).abs() < 1e-3, "{order}");
        }
    }

    #[test]
    fn an_onset_of_any_shape_is_found() {
        let starts: [&dyn Fn(f64) -> f64; 4] =
            [&|t| 0.3 * t, &|t| 0.02 * t * t, &|t| 0.004 * t.powi(3), &|t| {
                0.5 * (t - 4.0 * (1.0 - (-t / 4.0).exp()))
            }];
        for (number, start) in starts.into_iter().enumerate() {
            let values = motion(61.3, start);
            let found = found(&values, departure(&values, 0.05));
            assert!((found.delay - 21.3).abs() < 0.6, "{number}: {found:?}");
        }
    }

    #[test]
    fn intervals_hold_the_onset_as_often_as_they_say() {
        let starts: [&dyn Fn(f64) -> f64; 4] =
            [&|t| 0.3 * t, &|t| 0.02 * t * t, &|t| 0.002 * t.powi(3), &|t| {
                0.5 * (t - 4.0 * (1.0 - (-t / 4.0).exp()))
            }];
        let white = noise(5, 0.0, 200 * 110);
        for (number, start) in starts.into_iter().enumerate() {
            let clean = motion(62.4, start);
            let held = (0..200).filter(|run| {
                let noise = white.iter().skip(run * clean.len());
                let values: Vec<f64> = clean.iter().zip(noise).map(|(y, e)| y + 0.02 * e).collect();
                let found = found(&values, departure(&clean, 0.12));
                found.low <= 22.4 && 22.4 <= found.high
            });
            let held = held.count();
            assert!((180..=200).contains(&held), "{number}: {held} of 200");
        }
    }

    #[test]
    fn what_is_too_short_has_none() {
        let of = |rest, positions: Range<usize>, departed| {
            let start = FromRest { rest, positions, departed };
            gradual_onset(&[1.0; 50], &start, 0.95)
        };
        assert!(of(7, 8..12, 12).is_none());
        assert!(of(20, 22..22, 30).is_none());
        assert!(of(20, 15..49, 48).is_none());
    }
}
