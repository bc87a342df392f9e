//! Whether the output bends towards a level while the input is held.

use std::ops::Range;

use crate::delay::prepared::Prepared;
use crate::delay::steps::hold_ranges;
use crate::numerics::NormalEquations;

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
        let pieces: Vec<&[f64]> = trials.iter().flat_map(|trial| late_parts(trial, part)).collect();
        // The level of each hold is its own, the time constant is shared.
        let total = |column: &dyn Fn(f64) -> f64| -> f64 {
            pieces.iter().map(|values| squared_error(values, column)).sum()
        };
        let lines = total(&|k| k);
        HOLDS.into_iter().any(|holds| total(&|k| (-k / (holds * hold)).exp()) < PART * lines)
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

/// What a level and a multiple of `column` leave of `values`.
fn squared_error(values: &[f64], column: &dyn Fn(f64) -> f64) -> f64 {
    let origin = values.first().copied().unwrap_or_default();
    let mut columns = vec![1.0; values.len()];
    columns.extend((0..values.len()).map(|k| column(k as f64)));
    columns.extend(values.iter().map(|y| y - origin));
    let mut equations = NormalEquations::of(&columns, values.len(), &[]);
    (0..2).for_each(|column| equations.eliminate(column));
    equations.error()
}
