//! Whether a joint was driven in strokes.

use super::settings::FirstLast;
use super::steps::input_steps;
use crate::experiment::{Property, Record, Trial};

/// Trials with a step from which a joint is known to be driven in strokes.
const FEWEST: usize = 3;

/// Whether the trials of a joint are strokes.
struct Strokes(bool);

impl Property for Strokes {
    fn find(record: &Record) -> Self {
        let changes = |trial: &Trial| input_steps(trial.input(), 0.0).len();
        let changes: Vec<usize> = record.iter().map(changes).collect();
        let driven = changes.iter().filter(|changes| **changes > 0).count();
        let are_few = changes.iter().all(|changes| FirstLast::Auto.are_judged(*changes));
        Self(driven >= FEWEST && are_few)
    }
}

/// Whether the trials of a joint are strokes: each has so few changes of the input that its first
/// and last step are judged, see [`FirstLast::Auto`], and several have any.
pub(crate) fn are_strokes(record: &Record) -> bool {
    record.property::<Strokes>().0
}
