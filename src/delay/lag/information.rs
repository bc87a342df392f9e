//! What a joint's windows together say about its lag: the normal equations of the lag's
//! parameters, all else eliminated.

use nalgebra::{Matrix3, Vector3};

use super::model::MAX_PARAMETERS;

/// The normal equations of the lag's parameters.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Information {
    /// Products of the parameters' columns with each other.
    pub(super) products: [[f64; MAX_PARAMETERS]; MAX_PARAMETERS],
    /// Their products with the output.
    pub(super) with: [f64; MAX_PARAMETERS],
}

impl Information {
    /// The matrix with 1 where there is no parameter.
    fn matrix(&self, order: usize) -> Matrix3<f64> {
        /// Marquardt's damping, just enough that parameters which do the same can be solved for.
        const DAMPING: f64 = 1e-9;
        Matrix3::from_fn(|i, j| match (i < order && j < order, i == j) {
            // Marquardt: JᵀJ + λ·diag(JᵀJ).
            (true, _) => self.products[i][j] * if i == j { 1.0 + DAMPING } else { 1.0 },
            (false, diagonal) => f64::from(u8::from(diagonal)),
        })
    }

    /// Gauss and Newton's step; none where the matrix is singular.
    pub(super) fn solve(&self, order: usize) -> [f64; MAX_PARAMETERS] {
        let solved = self.matrix(order).lu().solve(&Vector3::from(self.with));
        let finite = solved.filter(|solved| solved.iter().all(|value| value.is_finite()));
        finite.map_or([0.0; MAX_PARAMETERS], Into::into)
    }

    /// Inverse of the products, 0 where there is no parameter.
    pub(super) fn inverse(&self, order: usize) -> [[f64; MAX_PARAMETERS]; MAX_PARAMETERS] {
        let inverse = self.matrix(order).try_inverse().unwrap_or_else(Matrix3::zeros);
        let entry = |i: usize, j: usize| if i < order && j < order { inverse[(i, j)] } else { 0.0 };
        std::array::from_fn(|i| std::array::from_fn(|j| entry(i, j)))
    }
}
