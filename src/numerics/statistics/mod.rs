//! Quantiles, rank tests and tails of distributions.

mod chi_square;
mod fisher;
mod normal;
mod quantile;
mod rank;
mod student;

pub use chi_square::chi_square_tail;
pub use fisher::fisher_tail;
pub use normal::normal_below;
pub use quantile::{median, quantile};
pub(crate) use quantile::{noise_of_differences, quantile_of, robust_scale};
pub use rank::{RankTest, holm, mann_whitney, ranks, spearman};
pub use student::student_quantile;
