//! The delay that most settings can agree on.
//!
//! Each run reports where the delay may be: its interval where it has one, else ± β/2, the
//! distance of its candidates; both are widened by a tolerance. The delays that most
//! ranges hold are those that most settings can agree on; who holds all of them, agrees.

use serde::Serialize;

use crate::delay::{Decision, Settings};

/// What a run reports of a step that it accepted; samples.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ReportedDelay {
    /// The delay.
    pub delay: f64,
    /// The shortest delay that it may be.
    pub low: f64,
    /// The longest delay that it may be.
    pub high: f64,
}

impl ReportedDelay {
    /// What `decision` reports, if the step was accepted.
    pub fn of(decision: &Decision, settings: &Settings) -> Option<Self> {
        let delay = decision.accepted_delay()?;
        let grid = 0.5 * settings.beta as f64;
        let (low, high) = match decision.fine {
            Some(fine) => (fine.low, fine.high),
            None => (delay - grid, delay + grid),
        };
        Some(Self { delay, low, high })
    }

    /// This delay, known less well by `tolerance` samples.
    pub(super) fn widened(self, tolerance: f64) -> Self {
        Self { low: self.low - tolerance, high: self.high + tolerance, ..self }
    }
}

/// What most combinations can agree on; samples.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Agreement {
    /// The median delay of those that agree.
    pub delay: f64,
    /// The shortest delay that all of them allow.
    pub low: f64,
    /// The longest of those delays.
    pub high: f64,
    /// How many agree.
    pub combinations: usize,
}

impl Agreement {
    /// The agreement among all that is `reported`; `None` when nothing is. Of several that are
    /// as large the shortest delay counts.
    pub(super) fn of(reported: &[ReportedDelay]) -> Option<Self> {
        let mut starts: Vec<f64> = reported.iter().map(|one| one.low).collect();
        let mut ends: Vec<f64> = reported.iter().map(|one| one.high).collect();
        starts.sort_by(f64::total_cmp);
        ends.sort_by(f64::total_cmp);
        let (mut most, mut low, mut ended) = (0, f64::NAN, 0);
        for (begun, start) in starts.iter().enumerate() {
            ended += ends.iter().skip(ended).take_while(|end| *end < start).count();
            if begun + 1 - ended > most {
                (most, low) = (begun + 1 - ended, *start);
            }
        }
        let high = ends.into_iter().find(|end| *end >= low)?;
        let mut agreed = Self { delay: low, low, high, combinations: most };
        let delays: Vec<f64> =
            reported.iter().filter(|one| agreed.holds(one)).map(|one| one.delay).collect();
        agreed.delay = crate::numerics::median(&delays)?;
        Some(agreed)
    }

    /// Whether `reported` allows all that is agreed on.
    pub fn holds(&self, reported: &ReportedDelay) -> bool {
        self.distance(reported) <= 0.0
    }

    /// By how many samples `reported` misses what is agreed on.
    pub(super) fn distance(&self, reported: &ReportedDelay) -> f64 {
        (reported.low - self.low).max(self.high - reported.high).max(0.0)
    }
}

/// By how many samples the ranges of `reported` miss a common delay; 0 where they share one.
pub(super) fn gap<'a>(reported: impl IntoIterator<Item = &'a ReportedDelay>) -> f64 {
    let ends =
        |(low, high): (f64, f64), one: &ReportedDelay| (low.max(one.low), high.min(one.high));
    let (low, high) = reported.into_iter().fold((f64::NEG_INFINITY, f64::INFINITY), ends);
    (low - high).max(0.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn reported(low: f64, high: f64) -> ReportedDelay {
        ReportedDelay { delay: f64::midpoint(low, high), low, high }
    }

    #[test]
    fn most_count_and_not_the_mean() {
        let all =
            [reported(9.0, 11.0), reported(30.0, 40.0), reported(10.0, 12.0), reported(31.0, 32.0)];
        let two = Agreement::of(&all).unwrap();
        assert_eq!((two.low, two.high, two.combinations), (10.0, 11.0, 2));
        let three = Agreement::of(&[all.as_slice(), &[reported(31.5, 33.0)]].concat()).unwrap();
        assert_eq!((three.low, three.high, three.combinations), (31.5, 32.0, 3));
        assert!((three.delay - 32.25).abs() < 1e-12);
        assert!(three.holds(&all[1]) && !three.holds(&all[0]));
        assert!((three.distance(&all[0]) - 21.0).abs() < 1e-12);
        assert_eq!(Agreement::of(&[]), None);
    }

    #[test]
    fn ranges_that_touch_agree() {
        let all = [reported(1.0, 2.0), reported(2.0, 3.0)];
        assert_eq!(Agreement::of(&all).unwrap().combinations, 2);
        assert!(gap(&all) == 0.0 && gap(&[]) == 0.0);
        assert!(
            (gap(&[reported(1.0, 2.0), reported(5.0, 6.0), reported(3.0, 4.0)]) - 3.0).abs()
                < 1e-12
        );
    }
}
