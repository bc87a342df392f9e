//! Quantiles, rank tests and tails of distributions.

mod chi_square;
mod fisher;
mod normal;
mod quantile;
mod rank;
mod student;

pub(crate) use chi_square::chi_square_tail;
pub(crate) use fisher::fisher_tail;
pub(crate) use normal::normal_below;
pub(crate) use quantile::{
    least_change, noise_of_bends, noise_of_differences, quantile_of, robust_scale,
};
pub use quantile::{median, quantile};
pub(crate) use rank::holm;
pub use rank::{RankTest, mann_whitney, ranks, spearman};
pub(crate) use student::student_quantile;
