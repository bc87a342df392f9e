//! Numerics that are no model's own: statistics, filters and least squares.
//!
//! - [`LowPass`]: zero-phase smoothing
//! - [`median`], [`quantile`]: of samples
//! - [`spearman`]: a rank test
//! - [`Line`]: a regression line

mod autoregression;
mod filter;
mod line;
mod moments;
mod newton;
mod noise;
mod normal_equations;
mod projection;
pub(crate) mod rank;
mod regression;
mod root;
mod rounding;
mod statistics;
#[cfg(test)]
pub(crate) mod testing;

pub(crate) use autoregression::autoregression;
pub use filter::{FilterError, LowPass, MAX_ORDER};
pub use line::Line;
pub(crate) use line::{PairSums, RunningLine};
pub(crate) use moments::{autocovariances, column_products, dot};
pub(crate) use newton::{Axes, Differences};
pub(crate) use noise::NoiseModel;
pub(crate) use normal_equations::NormalEquations;
pub(crate) use projection::Basis;
pub(crate) use rank::{PseudoInverse, REGRESSORS};
pub(crate) use regression::{Regression, product, residuals_of};
pub(crate) use root::{halved, settle_at_root};
pub(crate) use rounding::{
    as_written, decimal_exponent, to_decimals, to_digits, to_digits_by, to_multiple, to_nanoseconds,
};
pub use statistics::{RankTest, median, quantile, ranks, spearman};
pub(crate) use statistics::{
    chi_square_tail, coin_quantile, fisher_tail, holm, normal_below, student_quantile,
};
pub(crate) use statistics::{
    least_change, limits, noise_of_bends, noise_of_differences, robust_scale,
};
