//! The dead time in windows of the record, lags and curve being those of the whole.

use super::moments::Moments;
use super::record::{Samples, Whitened};
use super::response::Numerators;
use super::result::{Bounds, ErrorPoint, Window};
use super::search::Fitted;
use crate::numerics::chi_square_tail;

/// What windows are estimated with: what the whole record says.
pub(super) struct Known<'a> {
    pub(super) best: Fitted,
    /// Of the curve's columns.
    pub(super) coefficients: &'a [f64],
    /// Longest dead time, samples.
    pub(super) longest: usize,
    /// Rows of a window.
    pub(super) rows: usize,
    /// Threshold of the likelihood, widened as over the record.
    pub(super) threshold: f64,
    /// Half the interval that the lags alone give the dead time, samples.
    pub(super) by_lags: f64,
    /// Half of the widest interval that is worth a word, samples.
    pub(super) widest: f64,
}

/// Parts of a window; the next window begins this many parts later.
const PARTS: usize = 4;
const HOP: usize = 2;

/// The least evidence that the input moves the output in a window, in thresholds of the
/// likelihood: the dead time of an input with less is that of its noise. At ten, the gain of a
/// window is known to a third.
const EVIDENCE: f64 = 10.0;

/// Dead times tried, per sample.
const PER_SAMPLE: usize = 2;

/// A window, and its interval with the lags taken for known.
pub(super) struct Estimated {
    pub(super) window: Window,
    pub(super) alone: Option<Bounds>,
}

impl Known<'_> {
    /// The windows of one trial.
    pub(super) fn windows(
        &self,
        number: usize,
        samples: &Samples,
        trial: &Whitened,
    ) -> Vec<Estimated> {
        let rows = trial.rows.iter().cloned().reduce(|all, next| all.start..next.end);
        let Some(rows) = rows.filter(|rows| rows.len() >= self.rows) else { return Vec::new() };
        let parts = rows.len() * PARTS / self.rows;
        let border = |part: usize| rows.start + rows.len() * part / parts;
        let prediction = [self.prediction(trial)];
        let part = |part: usize| {
            let rows = border(part)..border(part + 1);
            Moments::of_column(&prediction, &trial.changes, rows, self.longest)
        };
        let sums: Vec<Moments> = (0..parts).map(part).collect();
        let numerators: Vec<Numerators> = (0..=self.longest * PER_SAMPLE)
            .map(|k| k as f64 / PER_SAMPLE as f64)
            .map(|delay| Numerators::of(self.best.structure, delay, self.best.lags))
            .collect();
        let starts = (0..=parts - PARTS).step_by(HOP);
        let window = |start: usize| {
            let sum = Moments::total(&sums[start..start + PARTS]);
            let estimate = sum.map(|sum| self.estimate(&sum, &numerators, samples.period_s));
            let (curve, alone) = estimate.unwrap_or_default();
            let averaged = samples.averaged;
            let (first, last) = (border(start) * averaged + 1, border(start + PARTS) * averaged);
            let estimate = alone.map(|bounds| self.with_lags(bounds, samples.period_s));
            Estimated { window: Window { trial: number, first, last, estimate, curve }, alone }
        };
        starts.map(window).collect()
    }

    /// What the input stands for, after the lags.
    fn prediction(&self, trial: &Whitened) -> Vec<f64> {
        let lagged = trial.lagged(self.best.lags);
        let mut sum = vec![0.0; trial.changes.len()];
        for (column, c) in lagged.iter().zip(self.coefficients) {
            sum.iter_mut().zip(column).for_each(|(slot, value)| *slot += c * value);
        }
        sum
    }

    /// The error of each dead time, and the dead time with its interval where one stands out.
    fn estimate(
        &self,
        sums: &Moments,
        numerators: &[Numerators],
        period_s: f64,
    ) -> (Vec<ErrorPoint>, Option<Bounds>) {
        let fits: Vec<(f64, f64)> = numerators.iter().map(|of| sums.gain(of)).collect();
        let errors: Vec<f64> = fits.iter().map(|(error, _)| *error).collect();
        let best = (0..errors.len()).min_by(|a, b| errors[*a].total_cmp(&errors[*b]));
        let Some(best) = best.filter(|best| errors[*best] > 0.0) else { return Default::default() };
        let least = errors[best];
        let likelihood = |index: usize| sums.rows() * (errors[index] / least).ln();
        let curve = errors.iter().enumerate().map(|(index, error)| ErrorPoint {
            delay_s: index as f64 / PER_SAMPLE as f64 * period_s,
            error: (error / least).sqrt(),
        });
        let end = |direction: bool| {
            let mut inside = best;
            loop {
                let next = if direction { inside + 1 } else { inside.checked_sub(1)? };
                errors.get(next)?;
                if likelihood(next) > self.threshold {
                    let (from, to) = (likelihood(inside).sqrt(), likelihood(next).sqrt());
                    // About its least value n ln(SSE/SSE₀) is a parabola: its root is straight.
                    let part = (self.threshold.sqrt() - from) / (to - from);
                    let sign = if direction { part } else { -part };
                    return Some((inside as f64 + sign) / PER_SAMPLE as f64);
                }
                inside = next;
            }
        };
        let (low, high) = (end(false), end(true));
        let value = vertex(&errors, best) / PER_SAMPLE as f64;
        let without = sums.without_input();
        // Twice the logarithm of the likelihood ratio against a gain of 0.
        let evidence = sums.rows() * (without / least).ln();
        let excites = evidence > EVIDENCE * self.threshold && fits[best].1 > 0.0;
        let bounds = high.map(|high| (value, low.unwrap_or(0.0), high));
        let bounds = bounds.filter(|(_, low, high)| excites && 0.5 * (high - low) <= self.widest);
        let seconds = |(value, low, high): (f64, f64, f64)| Bounds {
            value_s: value * period_s,
            low_s: low.min(value) * period_s,
            high_s: high.max(value) * period_s,
        };
        (curve.collect(), bounds.map(seconds))
    }

    /// The interval with what the lags add to it.
    fn with_lags(&self, alone: Bounds, period_s: f64) -> Bounds {
        let wider = |side: f64| side.hypot(self.by_lags * period_s);
        let value_s = alone.value_s;
        Bounds {
            value_s,
            low_s: (value_s - wider(value_s - alone.low_s)).max(0.0),
            high_s: value_s + wider(alone.high_s - value_s),
        }
    }
}

/// Where the parabola through the least value and its neighbours is least.
fn vertex(errors: &[f64], best: usize) -> f64 {
    let sides = best.checked_sub(1).and_then(|b| errors.get(b)).zip(errors.get(best + 1));
    let shift = sides.zip(errors.get(best)).map_or(0.0, |((before, after), least)| {
        let bend = before - 2.0 * least + after;
        if bend > 0.0 { 0.5 * (before - after) / bend } else { 0.0 }
    });
    best as f64 + shift
}

/// The p-value of dead times so far apart in windows that share no row, were it the same in all;
/// `quantile` is by how many standard deviations an interval reaches to either side.
pub(super) fn same_in_all(windows: &[Estimated], quantile: f64) -> Option<f64> {
    let apart = windows.iter().enumerate().filter(|(number, _)| number % HOP == 0);
    let known = apart.filter_map(|(_, estimated)| {
        let Bounds { value_s, low_s, high_s } = estimated.alone?;
        let deviation = 0.5 * (high_s - low_s) / quantile;
        (deviation > 0.0 && low_s > 0.0).then_some((value_s, deviation.powi(-2)))
    });
    let known: Vec<(f64, f64)> = known.collect();
    let weight: f64 = known.iter().map(|(_, weight)| weight).sum();
    let mean = known.iter().map(|(value, weight)| value * weight).sum::<f64>() / weight;
    // Cochran's Q: χ² with one degree of freedom less than windows.
    let spread = known.iter().map(|(value, weight)| weight * (value - mean).powi(2)).sum();
    chi_square_tail(spread, known.len().checked_sub(1).filter(|freedom| *freedom > 0)?)
}
