//! Least squares of one column on others, columns being cut into windows.

use nalgebra::{DMatrix, DVector};

use super::moments::dot;
use super::rank::{PseudoInverse, REGRESSORS};

/// A least-squares regression of one column on others.
pub(crate) struct Regression {
    pub(crate) coefficients: DVector<f64>,
    /// Sum of squared errors.
    pub(crate) error: f64,
    /// Columns that are not combinations of others.
    pub(crate) rank: usize,
}

impl Regression {
    /// By the normal equations `XᵀX β = Xᵀy` of columns of length one.
    pub(crate) fn of(target: &[Vec<f64>], columns: &[&Vec<Vec<f64>>]) -> Self {
        // A column of zeros stays one.
        let length = |c: &&Vec<Vec<f64>>| Some(product(c, c).sqrt()).filter(|n| *n > 0.0);
        let lengths: Vec<f64> = columns.iter().map(|c| length(c).unwrap_or(1.0)).collect();
        let count = columns.len();
        let with = columns.iter().zip(&lengths).map(|(c, n)| product(c, target) / n);
        let with = DVector::from_vec(with.collect());
        let total = product(target, target);
        if count == 0 {
            return Self { coefficients: with, error: total, rank: 0 };
        }
        let mut products = DMatrix::zeros(count, count);
        for (i, j) in (0..count).flat_map(|i| (i..count).map(move |j| (i, j))) {
            products[(i, j)] = product(columns[i], columns[j]) / (lengths[i] * lengths[j]);
        }
        products.fill_lower_triangle_with_upper_triangle();
        let inverse = PseudoInverse::of(products, REGRESSORS);
        let (scaled, explained) = inverse.solve(&with);
        Self {
            // Of the columns as they are, no longer of length one.
            coefficients: scaled.component_div(&DVector::from_vec(lengths)),
            // yᵀy − bᵀβ, which rounding may leave below zero.
            error: (total - explained).max(0.0),
            rank: inverse.rank(),
        }
    }
}

/// The product of two columns that are cut into the same windows.
pub(crate) fn product(a: &[Vec<f64>], b: &[Vec<f64>]) -> f64 {
    a.iter().zip(b).map(|(a, b)| dot(a, b)).sum()
}

/// The residual of the regression of `target` on `columns`.
pub(crate) fn residuals_of(
    target: &[Vec<f64>],
    columns: &[&Vec<Vec<f64>>],
) -> Option<Vec<Vec<f64>>> {
    let regression = Regression::of(target, columns);
    let mut residuals = target.to_vec();
    for (column, coefficient) in columns.iter().zip(regression.coefficients.iter()) {
        for (window, shape) in residuals.iter_mut().zip(column.iter()) {
            for (value, shape) in window.iter_mut().zip(shape) {
                *value -= coefficient * shape;
            }
        }
    }
    residuals.iter().flatten().all(|value| value.is_finite()).then_some(residuals)
}
