//! Whether a joint was driven in strokes.

use super::settings::FirstLast;
use super::steps::input_steps;
use crate::experiment::Trial;

/// Trials with a step from which a joint is known to be driven in strokes.
const FEWEST: usize = 3;

/// Whether `trials` are strokes: each has so few changes of the input that its first and last
/// step are judged, see [`FirstLast::Auto`], and several have any.
pub(crate) fn are_strokes(trials: &[Trial]) -> bool {
    let changes = |trial: &Trial| input_steps(trial.input(), 0.0).len();
    let changes: Vec<usize> = trials.iter().map(changes).collect();
    let driven = changes.iter().filter(|changes| **changes > 0).count();
    driven >= FEWEST && changes.iter().all(|changes| FirstLast::Auto.are_judged(*changes))
}
