//! Whether the output bends towards a level while the input is held.

use std::ops::Range;

use crate::delay::prepared::Prepared;
use crate::delay::steps::hold_ranges;
use crate::numerics::dot;
use crate::numerics::rank::PIVOT;

/// Samples between two steps of the input, on average.
pub(super) fn mean_hold(trials: &[&Prepared<'_>]) -> f64 {
    let samples: usize = trials.iter().map(|trial| trial.raw.len()).sum();
    let holds: usize = trials.iter().map(|trial| trial.steps.len() + 1).sum();
    samples as f64 / holds.max(1) as f64
}

/// Whether exponentials follow the output better than lines, behind the first quarter of each
/// hold, in which the reaction begins, or its first half.
pub(super) fn is_curved(trials: &[&Prepared<'_>]) -> bool {
    /// Time constants in mean holds.
    const HOLDS: [f64; 4] = [0.15, 0.4, 1.0, 2.5];
    /// Part of the squared error of lines (chosen).
    const PART: f64 = 0.9;
    let hold = mean_hold(trials);
    [4, 2].into_iter().any(|part| {
        let pieces: Vec<Piece> =
            trials.iter().flat_map(|trial| late_parts(trial, part)).map(Piece::of).collect();
        let longest = pieces.iter().map(|piece| piece.values.len()).max().unwrap_or_default();
        // The level of each hold is its own, the time constant is shared.
        let left_by = |of: &dyn Fn(f64) -> f64| -> f64 {
            let column = Column::of(longest, of);
            pieces.iter().map(|piece| piece.left_by(&column)).sum()
        };
        let lines = left_by(&|k| k);
        HOLDS.into_iter().any(|holds| left_by(&|k| (-k / (holds * hold)).exp()) < PART * lines)
    })
}

/// The output in each hold without the first of so many parts.
fn late_parts<'a>(trial: &'a Prepared<'_>, part: usize) -> Vec<&'a [f64]> {
    /// Samples of a part that says something.
    const FEWEST: usize = 8;
    let late = |hold: Range<usize>| trial.raw.get(hold.start + hold.len() / part..hold.end);
    let holds = hold_ranges(&trial.steps, trial.raw.len());
    holds.filter_map(late).filter(|late| late.len() >= FEWEST).collect()
}

/// Values of a part of the output from its first on, with their sum and that of their squares.
struct Piece {
    values: Vec<f64>,
    sum: f64,
    squares: f64,
}

impl Piece {
    fn of(output: &[f64]) -> Self {
        let origin = output.first().copied().unwrap_or_default();
        let values: Vec<f64> = output.iter().map(|y| y - origin).collect();
        let (sum, squares) = (values.iter().sum(), dot(&values, &values));
        Self { values, sum, squares }
    }

    /// The squared error that a level and a multiple of `column` leave: `S_yy − S_xy²/S_xx` with
    /// the sums about the means.
    fn left_by(&self, column: &Column) -> f64 {
        let length = self.values.len();
        let (samples, sum) = (length as f64, column.sums[length - 1]);
        let own = column.squares[length - 1] - sum * sum / samples;
        let both = dot(&column.values[..length], &self.values) - sum * self.sum / samples;
        let total = self.squares - self.sum * self.sum / samples;
        let explained =
            if own > PIVOT * column.squares[length - 1] { both * both / own } else { 0.0 };
        (total - explained).max(0.0)
    }
}

/// A regressor for pieces of every length, with its sums, and those of its squares, up to each sample.
struct Column {
    values: Vec<f64>,
    sums: Vec<f64>,
    squares: Vec<f64>,
}

impl Column {
    fn of(length: usize, at: &dyn Fn(f64) -> f64) -> Self {
        let values: Vec<f64> = (0..length).map(|k| at(k as f64)).collect();
        let running = |part: fn(f64) -> f64| {
            let mut sum = 0.0;
            let up_to = |value: &f64| {
                sum += part(*value);
                sum
            };
            values.iter().map(up_to).collect()
        };
        let (sums, squares) = (running(|value| value), running(|value| value * value));
        Self { values, sums, squares }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::numerics::NormalEquations;

    #[test]
    fn what_a_column_leaves_is_what_a_regression_leaves() {
        let column = Column::of(300, &|k| (-k / 70.0).exp());
        for length in [8, 41, 300] {
            let wild = |k: usize| 20.0 + (0.3 * k as f64).cos() + 0.01 * (k * k % 17) as f64;
            let output: Vec<f64> = (0..length).map(wild).collect();
            let mut columns = vec![1.0; length];
            columns.extend_from_slice(&column.values[..length]);
            columns.extend_from_slice(&output);
            let mut equations = NormalEquations::of(&columns, length, &[]);
            (0..2).for_each(|column| equations.eliminate(column));
            let (left, expected) = (Piece::of(&output).left_by(&column), equations.error());
            assert!((left - expected).abs() < 1e-9 * expected, "{length}: {left} {expected}");
        }
    }
}
