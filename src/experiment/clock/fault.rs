//! Why a clock cannot be read.

/// Why a clock cannot be read; `row` counts the rows from 0.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(in crate::experiment) enum ClockFault {
    /// One stamp is far from its neighbours.
    Garbage { row: usize },
    /// All stamps are equal.
    StandsStill,
    /// There is one row only.
    SingleRow,
    /// The stamps are so few, `grain_s` apart, that no period follows from them.
    FewStamps { stamps: usize, grain_s: f64 },
    /// The stamps are coarser than the sampling, and not even.
    TooCoarse { row: usize, grain_s: f64, period: f64 },
}
