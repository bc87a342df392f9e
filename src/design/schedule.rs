//! An input that can be played: levels, each held for a number of samples.

use crate::units::SamplePeriod;

/// A level of the input, held.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hold {
    /// The level, input units.
    pub level: f64,
    /// Samples for which it is held.
    pub samples: usize,
}

/// An input, level by level, in one trial or in several, before each of which the joint is brought
/// back to where it starts.
#[derive(Clone, Debug, PartialEq)]
pub struct Schedule {
    period: SamplePeriod,
    holds: Vec<Hold>,
    /// The first hold of each trial after the first.
    borders: Vec<usize>,
}

impl Schedule {
    /// `holds` one after the other, in one trial.
    pub fn new(period: SamplePeriod, holds: Vec<Hold>) -> Self {
        Self { period, holds, borders: Vec::new() }
    }

    /// This schedule with another trial after it.
    #[must_use]
    pub(super) fn followed_by(mut self, trial: &Self) -> Self {
        let behind = trial.borders.iter().map(|border| self.holds.len() + border);
        let borders: Vec<usize> = std::iter::once(self.holds.len()).chain(behind).collect();
        self.borders.extend(borders);
        self.holds.extend_from_slice(&trial.holds);
        self
    }

    /// Its trials.
    pub fn trials(&self) -> Vec<Self> {
        let from = std::iter::once(0).chain(self.borders.iter().copied());
        let to = self.borders.iter().copied().chain(std::iter::once(self.holds.len()));
        let holds = from.zip(to).map(|(from, to)| &self.holds[from..to]);
        holds.map(|holds| Self::new(self.period, holds.to_vec())).collect()
    }

    /// How many trials it has.
    pub fn trial_count(&self) -> usize {
        self.borders.len() + 1
    }

    /// Seconds between samples.
    pub fn period(&self) -> SamplePeriod {
        self.period
    }

    /// The levels in their order.
    pub fn holds(&self) -> &[Hold] {
        &self.holds
    }

    /// Samples of all holds.
    pub fn samples(&self) -> usize {
        self.holds.iter().map(|hold| hold.samples).sum()
    }

    /// Seconds that it takes.
    pub fn duration_s(&self) -> f64 {
        self.samples() as f64 * self.period.seconds()
    }

    /// The input at each sample, input units.
    pub fn input(&self) -> Vec<f64> {
        let hold = |hold: &Hold| std::iter::repeat_n(hold.level, hold.samples);
        self.holds.iter().flat_map(hold).collect()
    }

    /// Where each level begins, as the number of its first sample from 1, and the level.
    pub fn starts(&self) -> Vec<(usize, f64)> {
        let step = |next: &mut usize, hold: &Hold| {
            let first = *next;
            *next += hold.samples;
            Some((first, hold.level))
        };
        self.holds.iter().scan(1, step).collect()
    }

    /// The distinct levels, ascending.
    pub fn levels(&self) -> Vec<f64> {
        let mut levels: Vec<f64> = self.holds.iter().map(|hold| hold.level).collect();
        levels.sort_by(f64::total_cmp);
        levels.dedup();
        levels
    }

    /// Changes of the level.
    pub fn steps(&self) -> usize {
        self.holds.len().saturating_sub(self.trial_count())
    }

    /// Shortest and longest hold in seconds, but for the first and the last of each trial.
    pub fn hold_range_s(&self) -> (f64, f64) {
        let trials = self.trials();
        let inner = trials.iter().flat_map(|trial| match trial.holds.as_slice() {
            [_, inner @ .., _] if !inner.is_empty() => inner,
            all => all,
        });
        let all = inner.map(|hold| hold.samples as f64 * self.period.seconds());
        all.fold((f64::INFINITY, 0.0), |(low, high), hold| (low.min(hold), high.max(hold)))
    }

    /// How many of its holds are over after so many samples.
    pub(super) fn over_after(&self, samples: usize) -> usize {
        let ends = self.holds.iter().scan(0, |end, hold| {
            *end += hold.samples;
            Some(*end)
        });
        ends.take_while(|end| *end <= samples).count()
    }

    /// Borders of the windows of a fit to the first `count` holds.
    pub(super) fn windows(&self, count: usize) -> Vec<(usize, usize)> {
        /// Samples of a window between steps of the input, at most: as of a fit.
        const LONGEST: usize = 200;
        let mut windows = Vec::new();
        let mut start = 0;
        for hold in self.holds.iter().take(count) {
            let parts = hold.samples.div_ceil(LONGEST).max(1);
            let border = |part: usize| start + hold.samples * part / parts;
            windows.extend((0..parts).map(|part| (border(part), border(part + 1))));
            start += hold.samples;
        }
        windows
    }

    /// This schedule with `rest` added to each level.
    #[must_use]
    pub fn about(&self, rest: f64) -> Self {
        let about = |hold: &Hold| Hold { level: hold.level + rest, ..*hold };
        Self { holds: self.holds.iter().map(about).collect(), ..self.clone() }
    }

    /// The first `count` holds.
    #[must_use]
    pub(super) fn first(&self, count: usize) -> Self {
        Self::new(self.period, self.holds.iter().take(count).copied().collect())
    }
}

/// Whole samples in so many seconds, at least one.
pub(super) fn samples_in(seconds: f64, period: SamplePeriod) -> usize {
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "at least 1")]
    let samples = (seconds / period.seconds()).round().max(1.0) as usize;
    samples
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_schedule_is_what_is_played() {
        let period = SamplePeriod::from_seconds(0.5).unwrap();
        let hold = |level, samples| Hold { level, samples };
        let made = Schedule::new(period, vec![hold(0.0, 1), hold(2.0, 3), hold(-1.0, 2)]);
        assert_eq!(made.input(), [0.0, 2.0, 2.0, 2.0, -1.0, -1.0]);
        assert_eq!((made.samples(), made.steps(), made.levels()), (6, 2, vec![-1.0, 0.0, 2.0]));
        assert_eq!((made.duration_s(), made.hold_range_s()), (3.0, (1.5, 1.5)));
        assert_eq!(made.first(2).input(), [0.0, 2.0, 2.0, 2.0]);
        let over_after = |seconds: f64| made.over_after(samples_in(seconds, period));
        assert_eq!((over_after(2.0), over_after(1.9)), (2, 2));
        assert_eq!((over_after(1.7), samples_in(0.1, period)), (1, 1));
    }

    #[test]
    fn trials_are_played_one_after_the_other_and_no_step_lies_between() {
        let period = SamplePeriod::from_seconds(0.5).unwrap();
        let trial = |level| {
            let holds = [(0.0, 2), (level, 3), (0.0, 4)];
            let holds = holds.map(|(level, samples)| Hold { level, samples });
            Schedule::new(period, holds.to_vec())
        };
        let made = trial(1.0).followed_by(&trial(-1.0)).followed_by(&trial(2.0));
        assert_eq!((made.trial_count(), made.steps(), made.samples()), (3, 6, 27));
        assert_eq!(made.trials(), [trial(1.0), trial(-1.0), trial(2.0)]);
        assert_eq!((made.hold_range_s(), made.about(1.0).trial_count()), ((1.5, 1.5), 3));
    }
}
