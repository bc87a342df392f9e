//! Rows that follow one another, what parts them, and why they cannot be put on a grid.

use crate::experiment::error::{ReadError, ReadErrorKind};

/// The time at the index `row` is no later than the one before, or far from all its neighbours.
pub(super) fn not_increasing(times: &[f64], row: usize) -> ReadError {
    let at = |row: usize| times.get(row).copied().unwrap_or(f64::NAN);
    let (before, time) = (row.checked_sub(1).map_or(f64::NAN, at), at(row));
    let text = format!(
        "time goes from {before} s to {time} s, but must increase; remove the row if it is a copy, or mark a \
         new trial in a `trial` column"
    );
    ReadError::content(text).at_index(row)
}

/// From so few rows no period follows; the name of the trial comes before it.
pub(in crate::experiment) fn single_row() -> ReadError {
    let text = "has one row only, but needs two for a sample period";
    ReadError::new(ReadErrorKind::Empty, text).at_index(0)
}

/// A step of more periods than this may be a jump.
pub(super) const JUMP: f64 = 1.5;

/// Largest part of the places without a row; above it rows are not lost, but not even.
pub(super) const LOST_SHARE: f64 = 0.1;

/// What may be odd about a row.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::experiment) enum Oddity {
    /// It has the time of the row before.
    Twice,
    /// It is earlier than the row before.
    Disordered,
    /// It lies between two gaps, and is left out.
    Alone,
    /// The clock starts anew there.
    Restart,
}

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
    pub(super) fn points<'a>(&'a self, times: &'a [f64]) -> impl Iterator<Item = (f64, f64)> + 'a {
        let stamps = self.rows.iter().filter_map(|&row| times.get(row).copied());
        self.places.iter().map(|&place| place as f64).zip(stamps)
    }
}
