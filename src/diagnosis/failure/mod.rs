//! Where a model fails: the record cut into regions, and the conditions that hold most of
//! the squared error in least of the time.
//!
//! - [`ResidualRecord`]: the residual of one joint and what happened at each sample
//! - [`regions`]: the share of the error in each part of each [`Feature`]
//! - [`fails_where`]: the shortest conditions, `|input| < 1.2 and output > 20`
//! - [`worst_segments`]: the segments with more than their share
//!
//! Only numbers go in. How the residual was made, and whether there is enough of it to
//! call the model wrong, is decided elsewhere.

mod axis;
mod conditions;
mod feature;
mod grid;
mod record;
mod regions;
mod search;
mod segments;
mod significance;
mod threshold;

pub use conditions::{Bound, Clause, FailsWhere, Relation, fails_where};
pub use feature::Feature;
pub use record::{RecordError, ResidualRecord, Samples, Units};
pub use regions::{Region, regions};
pub use segments::{WorstSegment, worst_segments};

/// Where a model fails: what is named of it. All parts are [`regions`].
#[derive(Clone, Debug, PartialEq)]
pub struct Diagnosis {
    /// The conditions that hold most of the squared error, the best first.
    pub fails_where: Vec<FailsWhere>,
    /// The segments with more than their share, the worst first.
    pub worst_segments: Vec<WorstSegment>,
}

/// Segments that are named.
const WORST: usize = 5;

/// Both [`fails_where`] and [`worst_segments`] (five of them), these of `residual`: what is shown
/// beside them, one value for each sample.
pub fn diagnose(record: &ResidualRecord, residual: impl IntoIterator<Item = f64>) -> Diagnosis {
    let worst_segments = worst_segments(record, residual, WORST);
    Diagnosis { fails_where: fails_where(record), worst_segments }
}
