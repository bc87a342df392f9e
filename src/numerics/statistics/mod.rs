//! Quantiles, rank tests and tails of distributions.

mod distributions;
mod quantile;
mod rank;

pub(crate) use distributions::{
    chi_square_tail, coin_quantile, fisher_tail, normal_below, student_quantile,
};
pub(crate) use quantile::{
    least_change, limits, noise_of_bends, noise_of_differences, robust_scale,
};
pub use quantile::{median, quantile};
pub(crate) use rank::holm;
pub use rank::{RankTest, ranks, spearman};
