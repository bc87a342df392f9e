//! Why rows cannot be put on a grid.

/// Why rows cannot be put on a grid; `row` counts the rows of the trial from 0.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(in crate::experiment) enum Fault {
    /// One time is no later than the one before, or far from all its neighbours.
    NotIncreasing { row: usize },
    /// Rows are not equally far apart.
    NotUniform { row: usize, step: f64, period: f64 },
    /// There is one row only.
    SingleRow,
    /// The stamps are so few, `grain_s` apart, that no period follows from them.
    FewStamps { stamps: usize, grain_s: f64 },
    /// The stamps are coarser than the sampling, and not even.
    Coarse { row: usize, grain_s: f64, period: f64 },
    /// The grid would have more samples than can be handled.
    TooMany { samples: f64, period: f64 },
}

impl Fault {
    /// Whether a clock with this fault is put on a grid unasked.
    pub(in crate::experiment) fn is_mended(self) -> bool {
        matches!(self, Self::NotIncreasing { .. } | Self::NotUniform { .. })
    }
}
