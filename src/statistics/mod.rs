//! Statistics that are no model's own: rank tests and the tails of distributions.

mod chi_square;
mod fisher;
mod rank;

pub use chi_square::chi_square_tail;
pub use fisher::fisher_tail;
pub use rank::{RankTest, holm, mann_whitney, ranks, spearman};
