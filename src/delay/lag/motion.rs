//! A motion behind a lag, as the coefficients of level, ramp and modes.

use super::model::MAX_PARAMETERS;

/// Columns of the line.
pub(crate) const LINE: usize = 2;

/// Level, ramp, and the modes of three poles.
pub(crate) const COLUMNS: usize = LINE + MAX_PARAMETERS;

/// Coefficients of level, ramp and modes at the beginning of a piece.
pub(crate) type Motion = [f64; COLUMNS];

/// The sum of products.
pub(crate) fn inner_product(a: &Motion, b: &Motion) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}
