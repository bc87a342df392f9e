//! The time constants that all steps of a joint share.

use super::response::Constants;

/// The shortest time constant of a further lag, samples, and the longest, as a part of the other.
const SHORTEST: f64 = 0.2;
const LONGEST: f64 = 0.5;

/// Which way the input steps.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum InputChange {
    Rise,
    Fall,
}

/// Time constants in samples; their logarithms are the parameters of a search.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct TimeConstants {
    /// Of the steps of a rising input.
    pub(super) rising: f64,
    /// Of those of a falling one, where it has another; else as `rising`.
    pub(super) falling: Option<f64>,
    /// Of a further lag, where there is one.
    pub(super) further: Option<f64>,
    /// The shortest further lag.
    least: f64,
}

impl TimeConstants {
    /// One for all steps.
    pub(super) fn one(rising: f64) -> Self {
        Self { rising, falling: None, further: None, least: SHORTEST }
    }

    /// With another one for steps of a falling input.
    pub(super) fn with_falling(self) -> Self {
        Self { falling: Some(self.rising), ..self }
    }

    /// With a further lag of a part of the time constant, and of `least` samples.
    pub(super) fn with_further(self, part: f64, least: f64) -> Self {
        let least = least.max(SHORTEST);
        Self { further: Some(part * self.shortest()), least, ..self }.bounded()
    }

    pub(super) fn further_or_zero(&self) -> f64 {
        self.further.unwrap_or(0.0)
    }

    /// The shorter of rising and falling.
    pub(super) fn shortest(&self) -> f64 {
        self.falling.map_or(self.rising, |falling| falling.min(self.rising))
    }

    fn of(&self, change: InputChange) -> f64 {
        match change {
            InputChange::Rise => self.rising,
            InputChange::Fall => self.falling.unwrap_or(self.rising),
        }
    }

    /// Those about a step, behind the one `before`.
    pub(super) fn about(&self, step: InputChange, before: InputChange) -> Constants {
        let further = self.further_or_zero();
        Constants { before: self.of(before), behind: self.of(step), further }
    }

    /// Number of parameters.
    pub(super) fn parameters(&self) -> usize {
        1 + usize::from(self.falling.is_some()) + usize::from(self.further.is_some())
    }

    /// These with each logarithm changed, in the order of the fields.
    pub(super) fn moved(&self, by: &[f64]) -> Self {
        let mut by = by.iter().copied();
        // ln T + by: a time constant stays positive.
        let mut next = |value: f64| value * by.next().unwrap_or(0.0).exp();
        let rising = next(self.rising);
        let falling = self.falling.map(&mut next);
        let further = self.further.map(next);
        Self { rising, falling, further, ..*self }.bounded()
    }

    /// These with one logarithm changed.
    pub(super) fn moved_one(&self, index: usize, by: f64) -> Self {
        let all: Vec<f64> = (0..=index).map(|i| if i == index { by } else { 0.0 }).collect();
        self.moved(&all)
    }

    /// A further lag that is not shorter than can be seen, nor as long as the other.
    fn bounded(self) -> Self {
        let longest = LONGEST * self.shortest();
        Self { further: self.further.map(|it| it.max(self.least).min(longest)), ..self }
    }

    /// These for samples of another period, as many times as long.
    pub(super) fn scaled(&self, by: f64) -> Self {
        let scale = |value: f64| value * by;
        Self {
            rising: scale(self.rising),
            falling: self.falling.map(scale),
            further: self.further.map(scale),
            least: scale(self.least),
        }
    }
}
