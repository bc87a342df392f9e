//! The rows of the regression: changes of the output, and what the input stands for.

use std::ops::Range;

use super::curve::Curve;
use super::response::{AHEAD, Lags, NUMERATORS, Numerators};
use crate::experiment::Trial;
use crate::numerics::{NormalEquations, autoregression, residuals_of};

/// Shortest period that is worked at: faster logs are averaged over as many samples. A dead
/// time is found between samples, so that this is no limit to it.
const SHORTEST_PERIOD_S: f64 = 0.005;

/// Samples of a trial, averaged where they come fast.
#[derive(Clone, Debug)]
pub(super) struct Samples {
    /// Samples of the log in one of these.
    pub(super) averaged: usize,
    pub(super) period_s: f64,
    pub(super) input: Vec<f64>,
    pub(super) output: Vec<f64>,
    /// The coefficients of a spline per part of the curve, each a little [ahead](AHEAD).
    pub(super) columns: Vec<Vec<f64>>,
}

impl Samples {
    pub(super) fn of(trial: &Trial, curve: &Curve) -> Self {
        let period_s = trial.period().seconds();
        let averaged = averaged(period_s);
        let means = |signal: &[f64], of: &dyn Fn(f64) -> f64| -> Vec<f64> {
            let mean = |chunk: &[f64]| chunk.iter().map(|u| of(*u)).sum::<f64>() / averaged as f64;
            signal.chunks_exact(averaged).map(mean).collect()
        };
        let (input, output) = (means(trial.input(), &|u| u), means(trial.output(), &|y| y));
        let column = |index: usize| {
            let mut values = means(trial.input(), &|u| curve.at(index, u));
            spline(&mut values);
            // The last one is held.
            let last = values.last().copied().unwrap_or(0.0);
            values.extend(std::iter::repeat_n(last, AHEAD));
            values.split_off(AHEAD)
        };
        let columns = (0..curve.columns()).map(column).collect();
        Self { averaged, period_s: period_s * averaged as f64, input, output, columns }
    }
}

/// Turns samples into the coefficients of the cubic spline through them, `(c_(k−1) + 4 c_k + c_(k+1))/6`
/// being the samples, which are held before the first and after the last.
fn spline(values: &mut [f64]) {
    // The root of 1 + 4 z + z² within the unit circle.
    let z = 3.0_f64.sqrt() - 2.0;
    let mut before = values.first().map_or(0.0, |first| first / (1.0 - z));
    for value in &mut *values {
        before = *value + z * before;
        *value = before;
    }
    let mut behind = values.last().map_or(0.0, |last| -z / (1.0 - z) * last);
    for value in values.iter_mut().rev() {
        behind = z * (behind - *value);
        *value = 6.0 * behind;
    }
}

/// Samples of the log that are averaged.
pub(super) fn averaged(period_s: f64) -> usize {
    /// What a quotient may be below a whole number by rounding.
    const ROUNDING: f64 = 1e-9;
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "not negative")]
    let samples = (SHORTEST_PERIOD_S / period_s + ROUNDING).min(1e6) as usize;
    samples.max(1)
}

/// A trial whose noise was whitened by `w_k = Σ a_i x_(k−i)`, `a_0 = 1`, and the rows of it
/// that are regressed.
#[derive(Clone, Debug)]
pub(super) struct Whitened {
    /// Changes of the output.
    pub(super) changes: Vec<f64>,
    /// What the input stands for.
    columns: Vec<Vec<f64>>,
    /// Rows; no delay that is tried reaches back beyond the first sample.
    pub(super) rows: Vec<Range<usize>>,
}

impl Whitened {
    /// With the coefficients `1, a_1, …`; the input is taken to have been held before.
    pub(super) fn of(samples: &Samples, filter: &[f64], rows: &[Range<usize>]) -> Self {
        Self {
            changes: whiten(&changes(&samples.output), filter),
            columns: samples.columns.iter().map(|column| whiten(column, filter)).collect(),
            rows: rows.to_vec(),
        }
    }

    /// Number of columns.
    pub(super) fn lagged_columns(&self) -> usize {
        self.columns.len()
    }

    /// The columns after the poles of `lags`: `v_k = x_k + (a + b) v_(k−1) − a b v_(k−2)`.
    pub(super) fn lagged(&self, lags: Lags) -> Vec<Vec<f64>> {
        let [a, b] = lags.poles();
        // The fixed point of the recursion for an input that was held before.
        let steady = ((1.0 - a) * (1.0 - b)).recip();
        let lag = |column: &Vec<f64>| {
            let start = steady * column.first().copied().unwrap_or(0.0);
            let (mut before, mut before_that) = (start, start);
            let next = |value: &f64| {
                let next = value + (a + b) * before - a * b * before_that;
                (before_that, before) = (before, next);
                next
            };
            column.iter().map(next).collect()
        };
        self.columns.iter().map(lag).collect()
    }
}

/// The changes from each value to the next, none to the first.
pub(super) fn changes(values: &[f64]) -> Vec<f64> {
    let changes = values.windows(2).map(|pair| pair[1] - pair[0]);
    std::iter::once(0.0).take(values.len()).chain(changes).collect()
}

/// What is new in a signal of such autocovariances: `w_k = e_k − Σ a_i e_(k−i)`, as a filter.
pub(super) fn whitening(covariances: &[f64], samples: usize) -> Vec<f64> {
    let memory = autoregression(covariances, samples);
    std::iter::once(1.0).chain(memory.iter().map(|a| -a)).collect()
}

/// `values` after a filter; the first was held before.
pub(super) fn whiten(values: &[f64], filter: &[f64]) -> Vec<f64> {
    let first = values.first().copied().unwrap_or(0.0);
    let at = |k: usize, back: usize| {
        k.checked_sub(back).and_then(|k| values.get(k)).copied().unwrap_or(first)
    };
    let value = |k: usize| filter.iter().enumerate().map(|(back, a)| a * at(k, back)).sum();
    (0..values.len()).map(value).collect()
}

/// A column, in the rows of each part of the record.
pub(super) type Rows = Vec<Vec<f64>>;

/// The regression after one dead time and lags, over all rows.
pub(super) struct Design {
    /// A constant, and what the input stands for.
    pub(super) columns: Vec<Rows>,
    /// The changes of the output.
    pub(super) changes: Rows,
}

impl Design {
    pub(super) fn of(trials: &[Whitened], numerators: &Numerators, lags: Lags) -> Self {
        let parts = || {
            trials.iter().enumerate().flat_map(|(n, trial)| trial.rows.iter().map(move |r| (n, r)))
        };
        let changes: Rows =
            parts().map(|(n, rows)| trials[n].changes[rows.clone()].to_vec()).collect();
        let mut columns: Vec<Rows> =
            vec![changes.iter().map(|rows| vec![1.0; rows.len()]).collect()];
        let lagged: Vec<_> = trials.iter().map(|trial| trial.lagged(lags)).collect();
        let count = lagged.first().map_or(0, Vec::len);
        columns.extend((0..count).map(|index| -> Rows {
            let column = |(n, rows): (usize, &Range<usize>)| {
                rows.clone().map(|k| driven(&lagged[n][index], numerators, k)).collect()
            };
            parts().map(column).collect()
        }));
        Self { columns, changes }
    }

    /// The squared error.
    pub(super) fn error(&self) -> f64 {
        let samples: usize = self.changes.iter().map(Vec::len).sum();
        let all = self.columns.iter().chain([&self.changes]).flatten().flatten();
        let mut equations = NormalEquations::of(&all.copied().collect::<Vec<f64>>(), samples);
        (0..self.columns.len()).for_each(|column| equations.eliminate(column));
        equations.error()
    }

    /// What `values` are beside the columns; `None` of what is no number.
    pub(super) fn residuals_of(&self, values: &Rows) -> Option<Rows> {
        residuals_of(values, &self.columns.iter().collect::<Vec<_>>())
    }

    /// The residuals of the changes.
    pub(super) fn residuals(&self) -> Rows {
        self.residuals_of(&self.changes).unwrap_or_else(|| self.changes.clone())
    }
}

/// What `numerators` make of a lagged column, at sample `k`.
fn driven(column: &[f64], numerators: &Numerators, k: usize) -> f64 {
    let past = (k + 1).checked_sub(numerators.first + NUMERATORS);
    let past = past.and_then(|from| column.get(from..from + NUMERATORS)).unwrap_or_default();
    past.iter().rev().zip(numerators.values).map(|(value, n)| value * n).sum()
}
