//! Products of lagged columns, from which the error of every delay follows.

use std::ops::Range;

use super::record::Whitened;
use super::response::{Lags, NUMERATORS, Numerators};
use crate::numerics::{NormalEquations, dot};

/// Products of the columns after two lags with each other and with the changes of the output,
/// for delays of a range of whole samples; sums over the rows.
///
/// The products of two columns that are a samples late differ from those that are one sample
/// later by what enters and leaves at the ends of the rows, so that all delays cost little more
/// than one.
#[derive(Clone, Debug)]
pub(super) struct Moments {
    columns: usize,
    /// First delay.
    from: usize,
    rows: f64,
    /// Per delay, per further delay of the second column, a square of products.
    products: Vec<f64>,
    /// Per delay, the products of each column with the changes.
    with_changes: Vec<f64>,
    /// Per delay, the sum of each column.
    sums: Vec<f64>,
    change: f64,
    squared_change: f64,
}

impl Moments {
    /// For dead times from `from` up to `to` samples.
    pub(super) fn of(trials: &[Whitened], lags: Lags, from: usize, to: usize) -> Self {
        let mut found = Self::empty(trials.first().map_or(0, Whitened::lagged_columns), from, to);
        for trial in trials {
            let lagged = trial.lagged(lags);
            for rows in &trial.rows {
                found.add(&lagged, &trial.changes, rows.start, rows.end);
            }
        }
        found
    }

    /// Of one column, over the samples `rows` of it, for dead times up to `to` samples.
    pub(super) fn of_column(
        column: &[Vec<f64>; 1],
        changes: &[f64],
        rows: Range<usize>,
        to: usize,
    ) -> Self {
        let mut found = Self::empty(1, 0, to);
        found.add(column, changes, rows.start, rows.end);
        found
    }

    /// The sums over the rows of all `parts`, which are of the same columns and dead times.
    pub(super) fn total(parts: &[Self]) -> Option<Self> {
        let (first, rest) = parts.split_first()?;
        let mut total = first.clone();
        let add = |to: &mut [f64], from: &[f64]| {
            to.iter_mut().zip(from).for_each(|(sum, value)| *sum += value);
        };
        for part in rest {
            total.rows += part.rows;
            total.change += part.change;
            total.squared_change += part.squared_change;
            add(&mut total.products, &part.products);
            add(&mut total.with_changes, &part.with_changes);
            add(&mut total.sums, &part.sums);
        }
        Some(total)
    }

    /// No rows yet.
    fn empty(columns: usize, from: usize, to: usize) -> Self {
        let delays = to.saturating_sub(from) + NUMERATORS;
        let square = columns * columns;
        Self {
            columns,
            from,
            rows: 0.0,
            products: vec![0.0; delays * NUMERATORS * square],
            with_changes: vec![0.0; delays * columns],
            sums: vec![0.0; delays * columns],
            change: 0.0,
            squared_change: 0.0,
        }
    }

    pub(super) fn rows(&self) -> f64 {
        self.rows
    }

    fn add(&mut self, lagged: &[Vec<f64>], changes: &[f64], start: usize, end: usize) {
        let changes = &changes[start..end];
        self.rows += changes.len() as f64;
        self.change += changes.iter().sum::<f64>();
        self.squared_change += dot(changes, changes);
        let (columns, from) = (self.columns, self.from);
        let delays = self.sums.len() / columns.max(1);
        for (j, column) in lagged.iter().enumerate() {
            let mut sum: f64 = late(column, &(start..end), from).iter().sum();
            for delay in 0..delays {
                let values = late(column, &(start..end), from + delay);
                self.with_changes[delay * columns + j] += dot(values, changes);
                self.sums[delay * columns + j] += sum;
                // A sample later the window gains one row in front and loses one at the back.
                sum += at(column, start, from + delay) - at(column, end, from + delay);
            }
        }
        for (i, one) in lagged.iter().enumerate() {
            for (j, other) in lagged.iter().enumerate() {
                for further in 0..NUMERATORS {
                    self.add_products(one, other, (i, j, further), (start, end));
                }
            }
        }
    }

    /// The products of column `i` with column `j` that is `further` samples later, for all
    /// delays, each from the one before.
    fn add_products(
        &mut self,
        one: &[f64],
        other: &[f64],
        (i, j, further): (usize, usize, usize),
        (start, end): (usize, usize),
    ) {
        let (columns, from) = (self.columns, self.from);
        let square = columns * columns;
        let rows = start..end;
        let mut product = dot(late(one, &rows, from), late(other, &rows, from + further));
        let delays = self.sums.len() / columns.max(1);
        for delay in 0..delays {
            self.products[(delay * NUMERATORS + further) * square + i * columns + j] += product;
            let by = from + delay;
            product += at(one, start, by) * at(other, start, by + further)
                - at(one, end, by) * at(other, end, by + further);
        }
    }

    /// The squared error without an input: the changes have a mean.
    pub(super) fn without_input(&self) -> f64 {
        (self.squared_change - self.change * self.change / self.rows.max(1.0)).max(0.0)
    }

    /// The squared error of the best curve with `numerators`, and a constant.
    pub(super) fn error(&self, numerators: &Numerators) -> f64 {
        self.equations(numerators).map_or(f64::INFINITY, |mut equations| {
            (0..self.columns).for_each(|column| equations.eliminate(column));
            equations.error().max(0.0)
        })
    }

    /// The squared error of the first column with `numerators` times a gain, and a constant; and
    /// the gain, zero where the column says nothing.
    pub(super) fn gain(&self, numerators: &Numerators) -> (f64, f64) {
        let Some(driven) = self.driven(numerators) else { return (f64::INFINITY, 0.0) };
        let (square, sum) = (driven.products[0], driven.sums[0]);
        let total = self.without_input();
        let spread = square - sum * sum / self.rows.max(1.0);
        if spread <= SAYS_NOTHING * square {
            return (total, 0.0);
        }
        let together = driven.with_changes[0] - sum * self.change / self.rows.max(1.0);
        ((total - together * together / spread).max(0.0), together / spread)
    }

    /// The equations of all columns with `numerators`; the constant is projected out.
    fn equations(&self, numerators: &Numerators) -> Option<NormalEquations> {
        let Driven { products, sums, with_changes } = self.driven(numerators)?;
        let target = self.columns;
        // Σ(x − x̄)(z − z̄) = Σxz − ΣxΣz/n.
        Some(NormalEquations::from_products(target + 1, |i, j| match (i == target, j == target) {
            (true, _) => self.without_input(),
            (_, true) => with_changes[i] - sums[i] * self.change / self.rows,
            _ => products[i * target + j] - sums[i] * sums[j] / self.rows,
        }))
    }

    /// The sums of the columns with `numerators`; none of a dead time that was not asked for.
    fn driven(&self, numerators: &Numerators) -> Option<Driven> {
        let columns = self.columns;
        let delay = numerators.first.checked_sub(self.from)?;
        if columns == 0 || (delay + NUMERATORS) * columns > self.sums.len() {
            return None;
        }
        let mut products = vec![0.0; columns * columns];
        for (m, n) in numerators.values.iter().enumerate() {
            for (l, other) in numerators.values.iter().enumerate() {
                let weight = n * other;
                let base = ((delay + m.min(l)) * NUMERATORS + m.abs_diff(l)) * columns * columns;
                for i in 0..columns {
                    for j in i..columns {
                        // Products were kept with the earlier column first.
                        let place = if m <= l { i * columns + j } else { j * columns + i };
                        products[i * columns + j] += weight * self.products[base + place];
                    }
                }
            }
        }
        let weighted = |values: &[f64], i: usize| -> f64 {
            let terms = numerators.values.iter().enumerate();
            terms.map(|(m, n)| n * values[(delay + m) * columns + i]).sum()
        };
        let all = |values: &[f64]| (0..columns).map(|i| weighted(values, i)).collect();
        Some(Driven { products, sums: all(&self.sums), with_changes: all(&self.with_changes) })
    }
}

/// The values of a column so many samples before `rows`.
fn late<'a>(column: &'a [f64], rows: &Range<usize>, by: usize) -> &'a [f64] {
    let first = rows.start.saturating_sub(by);
    &column[first..rows.end.saturating_sub(by).min(column.len())]
}

/// The value of a column `by` samples before that ahead of row `k`; 0 before the first.
fn at(column: &[f64], k: usize, by: usize) -> f64 {
    k.checked_sub(1 + by).and_then(|k| column.get(k)).copied().unwrap_or(0.0)
}

/// Sums over the rows of the columns with a dead time.
struct Driven {
    /// Of the products of two columns, for `i ≤ j` at `i · columns + j`.
    products: Vec<f64>,
    /// Of each column.
    sums: Vec<f64>,
    /// Of the products of each column with the changes.
    with_changes: Vec<f64>,
}

/// Part of a column's square that its spread about its mean is at least, to be more than rounding.
const SAYS_NOTHING: f64 = 1e-12;
