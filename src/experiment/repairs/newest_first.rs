//! Tables whose newest row is the first, as some data bases write them.

use super::repair::Repair;
use crate::experiment::log::Log;

pub(super) struct NewestFirst;

impl Repair for NewestFirst {
    fn detect(log: &Log<'_>) -> impl IntoIterator<Item = Self> {
        let times = log.layout.time_column().and_then(|column| log.column(column));
        times.filter(|times| falls(&times.values)).map(|_| Self)
    }

    fn apply(self, log: &mut Log<'_>) -> Option<String> {
        log.table.turn();
        let note = "the newest row is first: the rows are read from the last to the first";
        Some(log.named(note))
    }
}

/// Whether each of `times` but a few is smaller than the one before it.
fn falls(times: &[f64]) -> bool {
    /// Part of the rows that may be out of order, and how many show an order (chosen).
    const OUT_OF_ORDER: f64 = 0.1;
    const FEWEST: usize = 3;
    let falling = times.windows(2).filter(|pair| pair[1] < pair[0]).count();
    let rising = times.windows(2).filter(|pair| pair[1] > pair[0]).count();
    falling >= FEWEST && rising as f64 <= OUT_OF_ORDER * falling as f64
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_that_fall_are_told_from_a_clock_that_restarts_or_stands_still() {
        assert!(falls(&[3.0, 2.0, 1.0, 0.0]));
        for times in [[0.0, 1.0, 0.0, 1.0], [0.0; 4], [0.0, 1.0, 2.0, 1.5]] {
            assert!(!falls(&times), "{times:?}");
        }
    }
}
