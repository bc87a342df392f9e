//! Least squares of one column on others, columns being cut into windows.

use nalgebra::{DMatrix, DVector};

use super::dot;

/// A least-squares regression of one column on others.
pub(crate) struct Regression {
    pub(crate) coefficients: DVector<f64>,
    /// Sum of squared errors.
    pub(crate) error: f64,
    /// Columns that are not combinations of others.
    pub(crate) rank: usize,
}

impl Regression {
    /// By the normal equations of columns of length one; combinations are left out.
    pub(crate) fn of(target: &[Vec<f64>], columns: &[&Vec<Vec<f64>>]) -> Self {
        /// Eigenvalues below this part of the largest belong to combinations.
        const RANK: f64 = 1e-9;
        let product = |a: &[Vec<f64>], b: &[Vec<f64>]| -> f64 {
            a.iter().zip(b).map(|(a, b)| dot(a, b)).sum()
        };
        // A column of zeros stays one.
        let length = |c: &&Vec<Vec<f64>>| Some(product(c, c).sqrt()).filter(|n| *n > 0.0);
        let lengths: Vec<f64> = columns.iter().map(|c| length(c).unwrap_or(1.0)).collect();
        let count = columns.len();
        let entry = |i: usize, j: usize| match (columns.get(i), columns.get(j)) {
            (Some(a), Some(b)) if i <= j => {
                product(a, b) / (lengths.get(i).unwrap_or(&1.0) * lengths.get(j).unwrap_or(&1.0))
            }
            _ => 0.0,
        };
        let upper = DMatrix::from_fn(count, count, entry);
        let gram = &upper + upper.transpose() - DMatrix::from_diagonal(&upper.diagonal());
        let with = columns.iter().zip(&lengths).map(|(c, n)| product(c, target) / n);
        let with = DVector::from_vec(with.collect());
        let total = product(target, target);
        if count == 0 {
            return Self { coefficients: with, error: total, rank: 0 };
        }
        let decomposed = gram.symmetric_eigen();
        let limit = RANK * decomposed.eigenvalues.max();
        let inverses = decomposed.eigenvalues.map(|v| if v > limit { 1.0 / v } else { 0.0 });
        let rotated = decomposed.eigenvectors.tr_mul(&with);
        let explained = rotated.component_mul(&rotated).dot(&inverses);
        let scaled = &decomposed.eigenvectors * rotated.component_mul(&inverses);
        let lengths = DVector::from_vec(lengths);
        Self {
            coefficients: scaled.component_div(&lengths),
            error: (total - explained).max(0.0),
            rank: inverses.iter().filter(|inverse| **inverse > 0.0).count(),
        }
    }
}

/// What is left of `target` after its regression on `columns`.
pub(crate) fn residuals_of(
    target: &[Vec<f64>],
    columns: &[&Vec<Vec<f64>>],
) -> Option<Vec<Vec<f64>>> {
    let regression = Regression::of(target, columns);
    let mut left = target.to_vec();
    for (column, coefficient) in columns.iter().zip(regression.coefficients.iter()) {
        for (window, shape) in left.iter_mut().zip(column.iter()) {
            for (value, shape) in window.iter_mut().zip(shape) {
                *value -= coefficient * shape;
            }
        }
    }
    left.iter().flatten().all(|value| value.is_finite()).then_some(left)
}
