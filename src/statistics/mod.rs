//! Statistics that are no model's own: quantiles, rank tests, tails of distributions.

mod chi_square;
mod fisher;
mod quantile;
mod rank;
mod student;

pub use chi_square::chi_square_tail;
pub use fisher::fisher_tail;
pub use quantile::{median, quantile};
pub use rank::{RankTest, holm, mann_whitney, ranks, spearman};
pub use student::student_quantile;
