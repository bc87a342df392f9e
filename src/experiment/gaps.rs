//! Gaps at which a trial was split.

use super::trial::Trial;
use crate::numerics::to_digits_by;

/// The longest gap between two parts of a trial that was split, with a period to spare, to three
/// digits, in seconds.
pub(crate) fn longest_gap_s(trials: &[Trial]) -> Option<f64> {
    let gap = |pair: &[Trial]| {
        let [before, behind] = pair else { return None };
        let whole = Trial::whole_label(before.label());
        let are_of_one = whole != before.label() && whole == Trial::whole_label(behind.label());
        let gap = behind.time_s(1) - before.time_s(before.len());
        (are_of_one && gap > 0.0).then(|| gap + before.period().seconds())
    };
    trials.windows(2).filter_map(gap).max_by(f64::total_cmp).map(no_shorter)
}

/// A length of time to three digits, rounding left aside no shorter: who fills gaps up to it fills this one.
pub(super) fn no_shorter(seconds: f64) -> f64 {
    to_digits_by(seconds, 3, |digits| (digits * (1.0 - 1e-9)).ceil())
}
