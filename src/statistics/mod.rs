//! Statistics that are no model's own: quantiles, rank tests, tails of distributions,
//! autoregressions.

mod autoregression;
mod chi_square;
mod fisher;
mod normal;
mod quantile;
mod rank;
mod student;

pub(crate) use autoregression::{
    Autoregression, autocovariances, dot, dots, moments, take_off_line,
};
pub use chi_square::chi_square_tail;
pub use fisher::fisher_tail;
pub use normal::normal_below;
pub(crate) use quantile::robust_scale;
pub use quantile::{median, quantile};
pub use rank::{RankTest, holm, mann_whitney, ranks, spearman};
pub use student::student_quantile;
