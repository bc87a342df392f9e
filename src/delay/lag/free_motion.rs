//! How well a joint that nothing moves anew explains a piece of its output: the squared
//! error of a line and of the modes that earlier steps left, for pieces of any length.
//!
//! The inner products of the columns depend on the length alone, so that they are worked out
//! once; a piece costs a product per column and sample.

use super::model::LagModel;
use super::motion::{COLUMNS, LINE};
use super::response::Response;
use crate::numerics::rank::PIVOT;

/// The columns of free motion, and their inverse squares at each length.
#[derive(Clone, Debug)]
pub(crate) struct FreeMotion {
    /// The columns side by side, sample by sample.
    rows: Vec<[f64; COLUMNS]>,
    /// For each number of samples.
    factors: Vec<Factors>,
}

/// The triangular factors of the products of all columns.
#[derive(Clone, Copy, Debug, Default)]
struct Factors {
    /// Multiples of earlier columns in a later one.
    lower: [[f64; COLUMNS]; COLUMNS],
    /// One over the square of each column's residual; 0 where there is none.
    per_square: [f64; COLUMNS],
}

impl FreeMotion {
    /// For pieces of `longest` samples at most.
    pub(crate) fn of(model: &LagModel, longest: usize) -> Self {
        let response = Response::of(model);
        let modes = response.modes();
        let mut columns = vec![0.0; modes * longest];
        response.fill_modes(&mut columns, longest);
        let row = |k: usize| {
            let mut row = [0.0; COLUMNS];
            row[0] = 1.0;
            row[1] = k as f64;
            for mode in 0..modes {
                row[LINE + mode] = columns[mode * longest + k];
            }
            row
        };
        Self::with_rows((0..longest).map(row).collect())
    }

    /// Of an output that settles at a level with a time constant in samples: the same without the
    /// slope of the line.
    pub(crate) fn to_a_level(time_constant: f64, longest: usize) -> Self {
        let row = |k: usize| {
            let mut row = [0.0; COLUMNS];
            row[0] = 1.0;
            row[LINE] = (-(k as f64) / time_constant).exp();
            row
        };
        Self::with_rows((0..longest).map(row).collect())
    }

    fn with_rows(rows: Vec<[f64; COLUMNS]>) -> Self {
        let mut products = [[0.0; COLUMNS]; COLUMNS];
        let mut factors = vec![Factors::default()];
        for row in &rows {
            for (sums, a) in products.iter_mut().zip(row) {
                sums.iter_mut().zip(row).for_each(|(sum, b)| *sum += a * b);
            }
            factors.push(Factors::of(&products));
        }
        Self { rows, factors }
    }

    /// The squared error of each piece of `values` from its first sample up to one of the
    /// `ends`, which ascend.
    pub(crate) fn errors(&self, values: &[f64], ends: impl Iterator<Item = usize>) -> Vec<f64> {
        // No values, no error whatever the offset.
        let offset = values.first().map_or(0.0, |first| *first);
        let (mut sums, mut square, mut done) = ([0.0; COLUMNS], 0.0, 0);
        let error = |end: usize| {
            let end = end.min(values.len()).min(self.rows.len());
            let start = done.min(end);
            for (y, row) in values[start..end].iter().zip(&self.rows[start..]) {
                let y = y - offset;
                square += y * y;
                sums.iter_mut().zip(row).for_each(|(sum, value)| *sum += y * value);
            }
            done = done.max(end);
            let factors = self.factors.get(end);
            factors.map_or(0.0, |factors| (square - factors.explained(&sums)).max(0.0))
        };
        ends.map(error).collect()
    }
}

impl Factors {
    /// `L·D·Lᵀ` of the products, by elimination from the first column on; a column that depends
    /// on those before it is skipped.
    fn of(products: &[[f64; COLUMNS]; COLUMNS]) -> Self {
        let mut residual = *products;
        let mut factors = Self::default();
        for column in 0..COLUMNS {
            let pivot_row = residual[column];
            let pivot = pivot_row[column];
            if pivot <= PIVOT * products[column][column] {
                continue;
            }
            factors.per_square[column] = pivot.recip();
            let later = column + 1..;
            let rows = residual[later.clone()].iter_mut().zip(&mut factors.lower[later]);
            for (row, lower) in rows {
                let multiple = row[column] / pivot;
                row.iter_mut().zip(&pivot_row).for_each(|(slot, value)| *slot -= multiple * value);
                lower[column] = multiple;
            }
        }
        factors
    }

    /// What the columns explain of a target, given its products with them: `Σ z_j²/d_j` with
    /// `L·z` the products.
    fn explained(&self, sums: &[f64; COLUMNS]) -> f64 {
        let mut residual = *sums;
        let mut explained = 0.0;
        for column in 0..COLUMNS {
            let value = residual[column];
            explained += value * value * self.per_square[column];
            let later = column + 1..;
            for (slot, lower) in residual[later.clone()].iter_mut().zip(&self.lower[later]) {
                *slot -= lower[column] * value;
            }
        }
        explained
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_motion_that_dies_away_leaves_no_residual() {
        let model = LagModel::pair_of(0.157, 0.25).behind(6.0);
        let (mut y, mut unused) = (vec![0.0; 90], vec![0.0; 90]);
        Response::of(&model).fill(-11.0, &mut y, &mut unused);
        let y: Vec<f64> = y.iter().zip(0_u32..).map(|(y, k)| y + 0.3 * f64::from(k)).collect();
        let free = FreeMotion::of(&model, 90);
        let errors = free.errors(&y, [3, 20, 90].into_iter());
        assert!(errors.iter().all(|error| *error < 1e-8), "{errors:?}");
        // Another motion is none of it.
        let squares: Vec<f64> = y.iter().map(|y| y * y).collect();
        let errors = free.errors(&squares, std::iter::once(90));
        assert!(errors[0] > 1.0, "{errors:?}");
    }

    #[test]
    fn the_error_is_that_of_a_regression() {
        let model = LagModel::real(6.0);
        let y: Vec<f64> = (0..40).map(|k| f64::from(k * k % 17)).collect();
        let left = FreeMotion::of(&model, 64).errors(&y, [12, 40].into_iter());
        for (left, end) in left.into_iter().zip([12_usize, 40]) {
            let row = |k: usize, i: usize| [1.0, k as f64, (-(k as f64) / 6.0).exp()][i];
            let columns = nalgebra::DMatrix::from_fn(end, 3, row);
            let target = nalgebra::DVector::from_column_slice(&y[..end]);
            let solved = columns.clone().svd(true, true).solve(&target, 1e-14).unwrap();
            let expected = (target - columns * solved).norm_squared();
            assert!((left - expected).abs() < 1e-8 * expected, "{left} {expected}");
        }
    }
}
