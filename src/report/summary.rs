//! A joint's decisions in a few numbers.

use serde::Serialize;

use super::EstimatedJoint;
use super::review::ReviewCount;
use crate::delay::{Condition, KindDelay, Verdict};
use crate::experiment::longest_gap_s;
use crate::numerics::to_nanoseconds;

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
    /// Why there are no steps, where there are none.
    pub(crate) without_steps: String,
    /// What stands for the delays in one line.
    pub(crate) headline: Headline,
    /// What persons said of the decisions, where any did.
    pub(crate) reviewed: Option<ReviewCount>,
}

/// What stands for the delays of a joint in one line.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Headline {
    /// All of them together.
    All,
    /// A typical delay for each kind of step: their medians differ by more than is uncertain.
    Kinds(Vec<KindDelay>),
    /// Nothing: of no kind of step enough were accepted.
    None(Vec<KindDelay>),
}

impl Headline {
    fn of(kinds: Vec<KindDelay>) -> Self {
        if KindDelay::differ(&kinds) {
            Self::Kinds(kinds)
        } else if kinds.iter().any(|kind| kind.typical.is_some()) {
            Self::All
        } else {
            Self::None(kinds)
        }
    }

    /// The kinds of steps that have to be distinguished, or of which nothing is typical.
    pub(crate) fn kinds(&self) -> &[KindDelay] {
        match self {
            Self::All => &[],
            Self::Kinds(kinds) | Self::None(kinds) => kinds,
        }
    }
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
        Self::with(joint, joint.delay_table().kinds)
    }

    /// Counts the decisions of `joint`, whose delays by kinds of steps are known.
    pub(crate) fn with(joint: EstimatedJoint<'_>, kinds: Vec<KindDelay>) -> Self {
        let with = |verdict: Verdict| {
            joint.decisions().filter(move |(_, _, decision)| decision.verdict() == verdict)
        };
        let samples = with(Verdict::Accepted).filter_map(|(_, _, decision)| decision.delay());
        let seconds = with(Verdict::Accepted).filter_map(|(trial, _, decision)| {
            Some(to_nanoseconds(decision.delay()? * trial.period().seconds()))
        });
        let count = |condition: Condition| (condition, with(Verdict::Rejected(condition)).count());
        let delay_s = DelayRange::of(seconds.collect());
        Self {
            headline: Headline::of(kinds),
            steps: joint.decisions().count(),
            accepted: with(Verdict::Accepted).count(),
            rejected: Condition::ALL
                .into_iter()
                .chain([Condition::Reviewer])
                .map(count)
                .filter(|(_, n)| *n > 0)
                .collect(),
            delay_samples: DelayRange::of(samples.collect()),
            delay_s,
            without_steps: without_steps(joint),
            reviewed: ReviewCount::on(joint),
        }
    }
}

/// Why a joint without steps has none.
fn without_steps(EstimatedJoint { joint, estimate }: EstimatedJoint<'_>) -> String {
    let mut levels = joint.trials.iter().filter_map(|trial| trial.input().first());
    let first = levels.next();
    if estimate.dead_time.is_some() {
        return "the input moves all the time".to_owned();
    }
    if levels.all(|level| Some(level) == first) {
        return "the input never changes".to_owned();
    }
    let Some(gap_s) = longest_gap_s(&joint.trials) else {
        return "the input changes only between trials".to_owned();
    };
    format!(
        "the input changes only between trials or in gaps of up to {gap_s} s; `tauscope estimate \
         --fill {gap_s}` fills these gaps"
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::delay::{Transition, TypicalDelay};

    #[test]
    fn the_median_of_an_even_number_is_between_the_middle_two() {
        let range = DelayRange::of(vec![4.0, 1.0, 2.0, 10.0]).unwrap();
        assert_eq!((range.min.to_string(), range.max.to_string()), ("1".into(), "10".into()));
        assert!((range.median - 3.0).abs() < 1e-15);
        assert_eq!(DelayRange::of(Vec::new()), None);
    }

    #[test]
    fn kinds_that_differ_and_kinds_without_delays_have_no_common_one() {
        let typical = |low: f64, high: f64| TypicalDelay {
            median_s: f64::midpoint(low, high),
            interval_s: Some((low, high)),
            min_s: low,
            max_s: high,
        };
        let kind = |transition, typical| KindDelay {
            transition,
            steps: 20,
            accepted: 10,
            typical,
            rejected: None,
        };
        let start = kind(Transition::Start, Some(typical(0.2, 0.3)));
        let stop = kind(Transition::Stop, Some(typical(0.4, 0.5)));
        let near = kind(Transition::Stop, Some(typical(0.25, 0.5)));
        let nothing = kind(Transition::Change, None);
        let headline = |kinds: &[KindDelay]| Headline::of(kinds.to_vec());
        assert_eq!(headline(&[start, stop]), Headline::Kinds(vec![start, stop]));
        assert_eq!(headline(&[start, near, nothing]), Headline::All);
        assert_eq!(headline(&[nothing]), Headline::None(vec![nothing]));
    }
}
