//! Small least squares by normal equations, solved column by column.

use super::moments::with_each;
use super::rank::PIVOT;

/// The products of all columns with each other, the last of them the target; eliminated
/// from the front as far as is asked for.
#[derive(Clone, Debug)]
pub(crate) struct NormalEquations {
    size: usize,
    /// Rows of the upper triangle, in a square.
    products: Vec<f64>,
    squares: Vec<f64>,
}

impl NormalEquations {
    /// Of `columns` of `length` samples each, one after the other.
    pub(crate) fn of(columns: &[f64], length: usize) -> Self {
        let columns: Vec<&[f64]> = columns.chunks_exact(length.max(1)).collect();
        let size = columns.len();
        let mut products = vec![0.0; size * size];
        for (i, row) in products.chunks_exact_mut(size.max(1)).enumerate() {
            // Four products in one pass read the column once.
            for (others, slots) in columns[i..].chunks(4).zip(row[i..].chunks_mut(4)) {
                slots.copy_from_slice(&with_each(columns[i], others)[..others.len()]);
            }
        }
        Self::from_products(size, |i, j| products[i * size + j])
    }

    /// Of so many columns, from the `product` of two of them.
    pub(crate) fn from_products(size: usize, product: impl Fn(usize, usize) -> f64) -> Self {
        let mut products = vec![0.0; size * size];
        for (i, j) in (0..size).flat_map(|i| (i..size).map(move |j| (i, j))) {
            products[i * size + j] = product(i, j);
        }
        let squares = products.iter().step_by(size + 1).copied().collect();
        Self { size, products, squares }
    }

    /// The entry at a row and a column of the upper triangle.
    pub(crate) fn at(&self, row: usize, column: usize) -> f64 {
        self.products[row * self.size + column]
    }

    /// The squared error of the target after the columns eliminated so far.
    pub(crate) fn error(&self) -> f64 {
        self.products.last().map_or(0.0, |square| square.max(0.0))
    }

    /// Whether a column is there, and no combination of those before it.
    pub(crate) fn stands_alone(&self, column: usize) -> bool {
        let stands = |square: &f64| self.at(column, column) > PIVOT * square && *square > 0.0;
        self.squares.get(column).is_some_and(stands)
    }

    /// Eliminates `column` from all after it: `A_rs −= A_cr A_cs / A_cc`.
    pub(crate) fn eliminate(&mut self, column: usize) {
        if !self.stands_alone(column) {
            return;
        }
        let pivot = self.at(column, column);
        let size = self.size;
        let split = ((column + 1) * size).min(self.products.len());
        let (done, behind) = self.products.split_at_mut(split);
        let row = &done[column * size..];
        for (offset, target) in behind.chunks_exact_mut(size).enumerate() {
            let r = column + 1 + offset;
            let factor = row[r] / pivot;
            let parts = row.iter().zip(target).skip(r);
            parts.for_each(|(value, slot)| *slot -= factor * value);
        }
    }

    /// Coefficients of the first `count` columns, all of which are eliminated.
    pub(crate) fn coefficients(&self, count: usize) -> Vec<f64> {
        let target = self.size.saturating_sub(1);
        let mut found = vec![0.0; count];
        // Back substitution: x_r = (A_ry − Σ_c>r A_rc x_c) / A_rr.
        for row in (0..count).rev() {
            if !self.stands_alone(row) {
                continue;
            }
            let later = found.iter().enumerate().skip(row + 1);
            let known: f64 = later.map(|(column, value)| self.at(row, column) * value).sum();
            found[row] = (self.at(row, target) - known) / self.at(row, row);
        }
        found
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_regression_by_hand() {
        // y = 1 + 2 x on x = 0, 1, 2 with an error of (1, −2, 1), which neither explains.
        let columns = [1.0, 1.0, 1.0, 0.0, 1.0, 2.0, 2.0, 1.0, 6.0];
        let mut equations = NormalEquations::of(&columns, 3);
        equations.eliminate(0);
        equations.eliminate(1);
        assert!((equations.error() - 6.0).abs() < 1e-12);
        let found = equations.coefficients(2);
        assert!((found[0] - 1.0).abs() < 1e-12 && (found[1] - 2.0).abs() < 1e-12);
    }

    #[test]
    fn a_column_that_others_make_up_is_left_out() {
        let columns = [1.0, 1.0, 1.0, 2.0, 2.0, 2.0, 1.0, 2.0, 3.0];
        let mut equations = NormalEquations::of(&columns, 3);
        equations.eliminate(0);
        assert!(!equations.stands_alone(1));
        equations.eliminate(1);
        assert!((equations.error() - 2.0).abs() < 1e-12);
    }
}
