//! Gaps at which a trial was split, and what is lost in them.

use std::ops::Range;

use super::joint::Joint;
use super::trial::Trial;
use crate::numerics::to_digits_by;
use crate::units::floor_to_index;

/// The longest gap between two parts of a trial that was split, with a period to spare, to three
/// digits, in seconds.
pub(crate) fn longest_gap_s(trials: &[Trial]) -> Option<f64> {
    let gap = |pair: &[Trial]| {
        let [before, behind] = pair else { return None };
        let gap = behind.time_s(1) - before.time_s(before.len());
        (are_of_one(before, behind) && gap > 0.0).then(|| gap + before.period().seconds())
    };
    let longest = trials.windows(2).filter_map(gap).max_by(f64::total_cmp)?;
    Some(to_digits_by(longest, 3, f64::ceil))
}

/// The longest gap that is filled so that its steps get delays, seconds. Chosen: a gap that is longer
/// parts two experiments.
const LONGEST_JOINED_S: f64 = 2.0;

/// The longest gap of a joint whose input changes in gaps and nowhere else: a logger that pauses
/// while the valve is switched leaves no step in any trial. `None` where a gap is longer than the
/// pause of one stroke.
pub(super) fn gap_with_all_steps_s(joint: &Joint) -> Option<f64> {
    #[expect(clippy::float_cmp, reason = "a step is any change")]
    let differs = |pair: &[Trial]| match pair {
        [before, behind] => are_of_one(before, behind) && before.input()[0] != behind.input()[0],
        _ => false,
    };
    #[expect(clippy::float_cmp, reason = "a step is any change")]
    let is_constant = |trial: &Trial| trial.input().windows(2).all(|pair| pair[0] == pair[1]);
    let in_gaps = joint.trials.windows(2).any(differs) && joint.trials.iter().all(is_constant);
    longest_gap_s(&joint.trials).filter(|gap| in_gaps && *gap <= LONGEST_JOINED_S)
}

/// The samples of `whole`, in which gaps are filled, of the gaps between those of its `parts` behind
/// which the input is another one.
pub(super) fn unlogged(whole: &Trial, parts: &[Trial]) -> Vec<Range<usize>> {
    let period_s = whole.period().seconds();
    let sample = |time_s: f64| floor_to_index(((time_s - whole.time_s(1)) / period_s).round());
    let gap = |pair: &[Trial]| {
        let [before, behind] = pair else { return None };
        let ends = [before, behind].map(|part| stem(part.label()));
        if ends != [Some(whole.label()); 2] {
            return None;
        }
        let (last, next) = (sample(before.time_s(before.len())), sample(behind.time_s(1)));
        let gap = last + 1..next.min(whole.len());
        (!gap.is_empty()).then_some(gap)
    };
    parts.windows(2).filter_map(gap).collect()
}

/// Whether both are parts of the same trial.
fn are_of_one(before: &Trial, behind: &Trial) -> bool {
    stem(before.label()).is_some() && stem(before.label()) == stem(behind.label())
}

/// The name of the trial that this is a part of.
fn stem(label: &str) -> Option<&str> {
    label.rsplit_once('#').map(|(stem, _)| stem)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::units::SamplePeriod;

    fn trial(label: &str, start_s: f64, input: [f64; 3]) -> Trial {
        let period = SamplePeriod::from_seconds(0.5).unwrap();
        Trial::new(label, start_s, period, input.to_vec(), vec![0.0; 3]).unwrap()
    }

    fn gap(trials: Vec<Trial>) -> Option<f64> {
        gap_with_all_steps_s(&Joint::new("boom", trials))
    }

    #[test]
    fn steps_are_in_gaps_where_they_are_nowhere_else() {
        let first = || trial("a#1", 0.0, [0.0; 3]);
        assert_eq!(gap(vec![first(), trial("a#2", 2.0, [1.0; 3])]), Some(1.5));
        assert_eq!(gap(vec![first(), trial("a#2", 4.0, [1.0; 3])]), None, "too long");
        assert_eq!(gap(vec![first(), trial("a#2", 2.0, [0.0; 3])]), None, "no step");
        assert_eq!(gap(vec![first(), trial("a#2", 2.0, [1.0, 2.0, 2.0])]), None, "another step");
        assert_eq!(gap(vec![trial("a", 0.0, [0.0; 3]), trial("b", 2.0, [1.0; 3])]), None);
    }
}
