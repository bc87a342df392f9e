//! A joint's decisions in a few numbers.

use serde::Serialize;

use super::{EstimatedJoint, decision_rows};
use crate::delay::Condition;

/// How many steps were accepted, why the others were not, and what the delays are.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct JointSummary {
    /// Input steps in all trials.
    pub(crate) steps: usize,
    /// Steps whose delay counts.
    pub(crate) accepted: usize,
    /// Rejected steps by the first condition that failed, in the paper's order.
    pub(crate) rejected: Vec<(Condition, usize)>,
    /// The accepted delays in samples.
    pub(crate) delay_samples: Option<DelayRange>,
    /// The accepted delays in seconds.
    pub(crate) delay_s: Option<DelayRange>,
    /// Whether the input moves all the time, so that there are no steps.
    pub(crate) is_continuous: bool,
}

/// The least, the middle and the greatest of the accepted delays.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub(crate) struct DelayRange {
    /// The least.
    pub(crate) min: f64,
    /// The middle one; the mean of two where their number is even.
    pub(crate) median: f64,
    /// The greatest.
    pub(crate) max: f64,
}

impl DelayRange {
    /// The range of `delays`, or `None` when there are none.
    pub(crate) fn of(mut delays: Vec<f64>) -> Option<Self> {
        delays.sort_by(f64::total_cmp);
        let (&min, &max) = (delays.first()?, delays.last()?);
        let upper = *delays.get(delays.len() / 2)?;
        let lower = *delays.get((delays.len() - 1) / 2)?;
        Some(Self { min, median: f64::midpoint(lower, upper), max })
    }
}

impl JointSummary {
    /// Counts the decisions of `joint`.
    pub(crate) fn of(joint: EstimatedJoint<'_>) -> Self {
        let rows: Vec<_> = decision_rows(joint).map(|(_, row)| row).collect();
        let accepted: Vec<_> = rows.iter().filter(|row| row.verdict == "accepted").collect();
        let samples = accepted.iter().filter_map(|row| row.delta);
        let seconds = accepted.iter().filter_map(|row| row.delta_s);
        let count = |condition: Condition| {
            let verdict = condition.id();
            (condition, rows.iter().filter(|row| row.verdict == verdict).count())
        };
        Self {
            steps: rows.len(),
            accepted: accepted.len(),
            rejected: Condition::ALL.map(count).into_iter().filter(|(_, n)| *n > 0).collect(),
            delay_samples: DelayRange::of(samples.collect()),
            delay_s: DelayRange::of(seconds.collect()),
            is_continuous: joint.estimate.dead_time.is_some(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_median_of_an_even_number_is_between_the_middle_two() {
        let range = DelayRange::of(vec![4.0, 1.0, 2.0, 10.0]).unwrap();
        assert_eq!((range.min.to_string(), range.max.to_string()), ("1".into(), "10".into()));
        assert!((range.median - 3.0).abs() < 1e-15);
        assert_eq!(DelayRange::of(Vec::new()), None);
    }
}
