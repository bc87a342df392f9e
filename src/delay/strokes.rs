//! Whether a joint was driven in strokes.

use super::settings::FirstLast;
use crate::experiment::Trial;

/// Trials with a step from which a joint is known to be driven in strokes.
const FEWEST: usize = 3;

/// Whether `trials` are strokes: each has so few changes of the input that its first and last
/// step are judged, see [`FirstLast::Auto`], and several have any.
pub(crate) fn are_strokes(trials: &[Trial]) -> bool {
    let changes: Vec<usize> = trials.iter().map(|trial| changes(trial.input())).collect();
    let driven = changes.iter().filter(|changes| **changes > 0).count();
    driven >= FEWEST && changes.iter().all(|changes| FirstLast::Auto.are_judged(*changes))
}

fn changes(input: &[f64]) -> usize {
    #[expect(clippy::float_cmp, reason = "a step is any change")]
    let changes = |pair: &&[f64]| matches!(pair, [before, after] if before != after);
    input.windows(2).filter(changes).count()
}
