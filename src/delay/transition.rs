//! What kind of step the input made: from rest, to rest, on in one direction, or back.

use std::cmp::Ordering;
use std::fmt;

use super::neutral::Neutral;
use super::steps::InputStep;

/// The kind of a step of the input, by the sides of [neutral](Neutral) that it joins.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Transition {
    /// From neutral to elsewhere.
    Start,
    /// To neutral.
    Stop,
    /// From one level to another on the same side, or where neutral is not known.
    Change,
    /// From one side of neutral to the other.
    Reversal,
}

impl Transition {
    /// All of them, in the order in which tables list them.
    pub const ALL: [Self; 4] = [Self::Start, Self::Stop, Self::Change, Self::Reversal];

    /// The kind of `step`.
    ///
    /// # Examples
    /// ```
    /// use tauscope::delay::{InputStep, Neutral, Transition};
    ///
    /// let neutral = Neutral { level: 7.5, low: 7.4, high: 7.6 };
    /// let kind = |before, after| {
    ///     Transition::of(&InputStep { sample: 100, before, after }, Some(&neutral))
    /// };
    /// assert_eq!(kind(7.5, 10.0), Transition::Start);
    /// assert_eq!(kind(5.0, 7.45), Transition::Stop);
    /// assert_eq!(kind(8.0, 10.0), Transition::Change);
    /// assert_eq!(kind(5.0, 10.0), Transition::Reversal);
    /// ```
    pub fn of(step: &InputStep, neutral: Option<&Neutral>) -> Self {
        let Some(neutral) = neutral else { return Self::Change };
        match (neutral.side(step.before), neutral.side(step.after)) {
            (before, after) if before == after => Self::Change,
            (Ordering::Equal, _) => Self::Start,
            (_, Ordering::Equal) => Self::Stop,
            _ => Self::Reversal,
        }
    }

    /// Its name in files and tables.
    pub fn id(self) -> &'static str {
        match self {
            Self::Start => "start",
            Self::Stop => "stop",
            Self::Change => "change",
            Self::Reversal => "reversal",
        }
    }
}

impl fmt::Display for Transition {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.id())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn without_a_neutral_level_every_step_is_a_change() {
        let step = InputStep { sample: 9, before: 0.0, after: 1.0 };
        assert_eq!(Transition::of(&step, None), Transition::Change);
    }
}
