//! Projections onto the span of columns.
//!
//! The basis is that of Gram and Schmidt, each column projected twice.
//!
//! # References
//! B. N. Parlett, "The Symmetric Eigenvalue Problem" (1980), section 6.9 ("twice is enough").

use super::moments::{dot, with_each};

/// An orthonormal basis of what columns span.
#[derive(Clone, Debug)]
pub(crate) struct Basis {
    /// Samples of a column.
    length: usize,
    /// One column after the other.
    columns: Vec<f64>,
}

impl Basis {
    /// Of `columns` of `length` samples each, one after the other. A column whose distance
    /// from the span of those before it is not above `tolerance` of its own length is left out.
    pub(crate) fn of(columns: &[f64], length: usize, tolerance: f64) -> Self {
        let mut basis = Self { length, columns: Vec::with_capacity(columns.len()) };
        for column in columns.chunks_exact(length.max(1)) {
            let size = dot(column, column).sqrt();
            let distant = basis.residual(column);
            // q = (1 − QQᵀ) a / |(1 − QQᵀ) a|.
            let distance = dot(&distant, &distant).sqrt();
            if distance > tolerance * size {
                basis.columns.extend(distant.iter().map(|value| value / distance));
            }
        }
        basis
    }

    /// `(1 − QQᵀ)·values`: the residual of their regression on the columns.
    pub(crate) fn residual(&self, values: &[f64]) -> Vec<f64> {
        let mut residual = values.to_vec();
        // Twice is enough for what rounding leaves of the first time.
        (0..2).for_each(|_| self.subtract(&mut residual));
        residual
    }

    fn columns(&self) -> Vec<&[f64]> {
        self.columns.chunks_exact(self.length.max(1)).collect()
    }

    /// Subtracts `QQᵀ·values`, four columns at a time.
    fn subtract(&self, values: &mut [f64]) {
        for columns in self.columns().chunks(4) {
            let parts = with_each(values, columns);
            if let ([a, b, c, d], [p, q, r, s]) = (columns, parts) {
                let pairs = a.iter().zip(*b).zip(c.iter().zip(*d));
                for (value, ((a, b), (c, d))) in values.iter_mut().zip(pairs) {
                    *value -= p * a + q * b + r * c + s * d;
                }
                continue;
            }
            for (column, part) in columns.iter().zip(parts) {
                values.iter_mut().zip(*column).for_each(|(value, by)| *value -= part * by);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_residual_is_orthogonal_to_every_column_and_dependent_ones_are_left_out() {
        let power = |p: i32| (0..40).map(move |k| (f64::from(k) / 40.0).powi(p));
        // The third is a sum of the first two.
        let sum = power(0).zip(power(1)).map(|(one, k)| one + k);
        let columns: Vec<f64> =
            power(0).chain(power(1)).chain(sum).chain((2..5).flat_map(power)).collect();
        let basis = Basis::of(&columns, 40, 1e-7);
        assert_eq!(basis.columns.len(), 5 * 40);
        let values: Vec<f64> = (0..40).map(|k| (f64::from(k) * 1.3).sin()).collect();
        let residual = basis.residual(&values);
        for column in columns.chunks_exact(40) {
            assert!(dot(column, &residual).abs() < 1e-12);
        }
    }
}
