//! Rows that follow one another, what parts them, and why they cannot be put on a grid.

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

/// A step of more periods than this may be a jump.
pub(super) const JUMP: f64 = 1.5;

/// Largest part of the places without a row; above it rows are not lost, but not even.
pub(super) const LOST_SHARE: f64 = 0.1;

/// Rows that follow one another without a long gap.
#[derive(Clone, Debug, PartialEq)]
pub(in crate::experiment) struct Run {
    /// Rows in the order of their time.
    pub(in crate::experiment) rows: Vec<usize>,
    /// Their places on an even grid; the first is 0.
    pub(in crate::experiment) places: Vec<usize>,
}

impl Run {
    /// When its places begin, on a grid of `period`: the least-squares offset.
    pub(in crate::experiment) fn start_s(&self, times: &[f64], period: f64) -> f64 {
        let offsets = self.points(times).map(|(place, time)| time - place * period);
        offsets.sum::<f64>() / self.rows.len().max(1) as f64
    }

    /// Place and stamp of each row.
    pub(in crate::experiment) fn points<'a>(
        &'a self,
        times: &'a [f64],
    ) -> impl Iterator<Item = (f64, f64)> + 'a {
        let stamps = self.rows.iter().filter_map(|&row| times.get(row).copied());
        self.places.iter().map(|&place| place as f64).zip(stamps)
    }
}
