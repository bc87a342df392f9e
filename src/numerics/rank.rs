//! When columns count as dependent, and the inverse that leaves dependent directions out.
//!
//! A column depends on others when its distance from their span is below what it is known to:
//! all such tolerances are here.

use nalgebra::{DMatrix, DVector};

/// Distance below which a column of forward differences with steps of 1e-6 counts as dependent:
/// it is known no better.
pub(crate) const DIFFERENCED: f64 = 1e-6;

/// Distance below which a column of forward differences with steps of 1e-4 counts as dependent.
pub(crate) const COARSELY_DIFFERENCED: f64 = 1e-4;

/// Pivot of normal equations, in parts of the column's square, below which it counts as
/// dependent (chosen). It is a squared distance, from products that are rounded.
pub(crate) const PIVOT: f64 = 1e-11;

/// Eigenvalue of the products of columns, in parts of the largest, below which a combination
/// counts as dependent in a regression. At 0.9 of it, a share of misfit changes by 0.1 % in a
/// simulated log with an actuator's lag.
pub(crate) const REGRESSORS: f64 = 1e-9;

/// Eigenvalue of the products of sensitivities, in parts of the largest, below which the data
/// do not determine a combination of parameters.
pub(crate) const SENSITIVITIES: f64 = 1e-10;

/// The inverse of a matrix of products of columns of length one, in the directions in which
/// the columns are independent.
pub(crate) struct PseudoInverse {
    vectors: DMatrix<f64>,
    /// Of the eigenvalues; 0 for those of dependent directions.
    inverses: DVector<f64>,
}

impl PseudoInverse {
    /// From the eigenvalues of `products`, those below `tolerance` of the largest being taken
    /// for 0.
    pub(crate) fn of(products: DMatrix<f64>, tolerance: f64) -> Self {
        let decomposed = products.symmetric_eigen();
        let limit = tolerance * decomposed.eigenvalues.max();
        let inverses = decomposed.eigenvalues.map(|v| if v > limit { v.recip() } else { 0.0 });
        Self { vectors: decomposed.eigenvectors, inverses }
    }

    /// Number of independent directions.
    pub(crate) fn rank(&self) -> usize {
        self.inverses.iter().filter(|inverse| **inverse > 0.0).count()
    }

    /// The solution `x` of least length, and `bᵀ x`.
    pub(crate) fn solve(&self, b: &DVector<f64>) -> (DVector<f64>, f64) {
        let rotated = self.vectors.tr_mul(b);
        // With products VΛVᵀ: bᵀx = Σ (vᵢᵀb)² / λᵢ.
        let explained = rotated.component_mul(&rotated).dot(&self.inverses);
        (&self.vectors * rotated.component_mul(&self.inverses), explained)
    }

    /// The inverse itself.
    pub(crate) fn matrix(&self) -> DMatrix<f64> {
        &self.vectors * DMatrix::from_diagonal(&self.inverses) * self.vectors.transpose()
    }

    /// The squared part of the unit vector of column `index` that lies in dependent directions.
    pub(crate) fn undetermined(&self, index: usize) -> f64 {
        let row = self.vectors.row(index);
        let dependent = row.iter().zip(&self.inverses).filter(|(_, inverse)| **inverse <= 0.0);
        dependent.map(|(v, _)| v * v).sum()
    }
}
