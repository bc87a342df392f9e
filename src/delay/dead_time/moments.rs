//! Products of lagged columns, from which the error of every delay follows.

use super::record::{Whitened, driven};
use super::response::{Lags, NUMERATORS, Numerators};
use crate::numerics::{NormalEquations, dot};

/// Products of the columns behind two lags with each other and with the changes of the output,
/// for delays of a range of whole samples; sums over the rows.
///
/// The products of two columns that are a samples late differ from those that are one sample
/// later by what enters and leaves at the ends of the rows, so that all delays cost little more
/// than one.
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
        let columns = trials.first().map_or(0, Whitened::lagged_columns);
        let delays = to.saturating_sub(from) + NUMERATORS;
        let square = columns * columns;
        let mut found = Self {
            columns,
            from,
            rows: 0.0,
            products: vec![0.0; delays * NUMERATORS * square],
            with_changes: vec![0.0; delays * columns],
            sums: vec![0.0; delays * columns],
            change: 0.0,
            squared_change: 0.0,
        };
        for trial in trials {
            let lagged = trial.lagged(lags);
            for rows in &trial.rows {
                found.add(&lagged, &trial.changes, rows.start, rows.end);
            }
        }
        found
    }

    fn add(&mut self, lagged: &[Vec<f64>], changes: &[f64], start: usize, end: usize) {
        let changes = &changes[start..end];
        self.rows += changes.len() as f64;
        self.change += changes.iter().sum::<f64>();
        self.squared_change += dot(changes, changes);
        let (columns, from) = (self.columns, self.from);
        let late = |column: &'_ [f64], by: usize| -> (usize, usize) {
            (start.saturating_sub(by), end.saturating_sub(by).min(column.len()))
        };
        let delays = self.sums.len() / columns.max(1);
        let at = |column: &[f64], k: usize, by: usize| {
            k.checked_sub(1 + by).and_then(|k| column.get(k)).copied().unwrap_or(0.0)
        };
        for (j, column) in lagged.iter().enumerate() {
            let (first, last) = late(column, from);
            let mut sum: f64 = column[first..last].iter().sum();
            for delay in 0..delays {
                let (first, last) = late(column, from + delay);
                let values = &column[first..last];
                self.with_changes[delay * columns + j] += dot(values, changes);
                self.sums[delay * columns + j] += sum;
                // A sample later the window gains one row in front and loses one behind.
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
        let first = |values: &'_ [f64], by: usize| -> (usize, usize) {
            (start.saturating_sub(by), end.saturating_sub(by).min(values.len()))
        };
        let ((a, b), (c, d)) = (first(one, from), first(other, from + further));
        let mut product = dot(&one[a..b], &other[c..d]);
        let at = |values: &[f64], k: usize, by: usize| {
            k.checked_sub(1 + by).and_then(|k| values.get(k)).copied().unwrap_or(0.0)
        };
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

    /// The squared error of the best curve behind `numerators`, and a constant.
    pub(super) fn error(&self, numerators: &Numerators) -> f64 {
        let columns = self.columns;
        let size = columns + 1;
        let mut products = vec![0.0; size * size];
        let Some(delay) = numerators.first.checked_sub(self.from) else { return f64::INFINITY };
        if (delay + NUMERATORS) * columns > self.sums.len() {
            return f64::INFINITY;
        }
        for (m, n) in numerators.values.iter().enumerate() {
            for (l, other) in numerators.values.iter().enumerate() {
                let weight = n * other;
                let base = ((delay + m.min(l)) * NUMERATORS + m.abs_diff(l)) * columns * columns;
                for i in 0..columns {
                    for j in i..columns {
                        // Products were kept with the earlier column first.
                        let place = if m <= l { i * columns + j } else { j * columns + i };
                        products[i * size + j] += weight * self.products[base + place];
                    }
                }
            }
        }
        let weighted = |values: &[f64], i: usize| -> f64 {
            let terms = numerators.values.iter().enumerate();
            terms.map(|(m, n)| n * values[(delay + m) * columns + i]).sum()
        };
        let sums: Vec<f64> = (0..columns).map(|i| weighted(&self.sums, i)).collect();
        for i in 0..columns {
            for j in i..columns {
                // The constant is projected out: Σ(x − x̄)(z − z̄) = Σxz − ΣxΣz/n.
                products[i * size + j] -= sums[i] * sums[j] / self.rows;
            }
            products[i * size + columns] =
                weighted(&self.with_changes, i) - sums[i] * self.change / self.rows;
        }
        products[size * size - 1] = self.without_input();
        let mut equations = NormalEquations::from_products(size, products);
        (0..columns).for_each(|column| equations.eliminate(column));
        equations.error().max(0.0)
    }
}

/// The squared error of the best curve behind one dead time and lags, and a constant.
pub(super) fn error_of(trials: &[Whitened], numerators: &Numerators, lags: Lags) -> f64 {
    let columns = trials.first().map_or(0, Whitened::lagged_columns);
    let lagged: Vec<_> = trials.iter().map(|trial| (trial, trial.lagged(lags))).collect();
    let rows = || {
        lagged
            .iter()
            .flat_map(|(trial, columns)| trial.rows.iter().map(move |r| (trial, columns, r)))
    };
    let samples: usize = rows().map(|(_, _, rows)| rows.len()).sum();
    let mut all = vec![1.0; samples];
    all.reserve(samples * (columns + 1));
    for index in 0..columns {
        for (_, columns, rows) in rows() {
            let column = columns.get(index).map_or(&[][..], Vec::as_slice);
            all.extend(rows.clone().map(|k| driven(column, numerators, k)));
        }
    }
    for (trial, _, rows) in rows() {
        all.extend(&trial.changes[rows.clone()]);
    }
    let mut equations = NormalEquations::of(&all, samples, &[]);
    (0..=columns).for_each(|column| equations.eliminate(column));
    equations.error()
}
