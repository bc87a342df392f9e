//! A designed input: how its levels follow one another, what it separates, and how surely.

use serde::Serialize;

use super::limits::Limits;
use super::power::Expected;
use super::schedule::Schedule;
use crate::explain::Pattern;

/// How the levels of an input follow one another.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Order {
    /// As in an experiment that `explain` proposes, again and again, with the other direction
    /// first every other time.
    Pattern(Pattern),
    /// Random levels with random holds.
    Random,
    /// All levels at which an effect may switch: see [`Design::explores`](super::Design).
    Exploring,
}

/// A level of the input at which an effect switches, and where a record allows it to be.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct OpenThreshold {
    /// Id of the effect.
    pub effect: &'static str,
    /// Id of its parameter.
    pub parameter: &'static str,
    /// The lowest magnitude that is likely, input units.
    pub low: f64,
    /// The highest.
    pub high: f64,
}

/// How often a rehearsed experiment separated two suspects.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Rehearsal {
    /// Rehearsals that ranked the suspect first that was there, and excluded the other.
    pub successes: usize,
    /// All rehearsals.
    pub runs: usize,
}

/// What an input shows of one suspect.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Side {
    /// What a ranking is expected to show where the suspect is there.
    pub expected: Expected,
    /// Whether the input is to separate it from the other; not where the other can do the same.
    pub is_target: bool,
    /// Whether what is known speaks against it already, so that the input is not made for it.
    pub is_excluded: bool,
    /// How often the rehearsed experiment found it.
    pub rehearsal: Option<Rehearsal>,
}

/// An input that separates two suspects, and how surely.
#[derive(Clone, Debug, PartialEq)]
pub struct Design {
    /// How its levels follow one another.
    pub order: Order,
    /// The input.
    pub schedule: Schedule,
    /// What it shows where the first suspect is there, and where the second.
    pub sides: [Side; 2],
    /// The levels that it is to find, where it explores: no input passed, and what is known
    /// leaves these open. The input that separates the two is designed from what it shows. Empty
    /// where it is itself to separate them.
    pub explores: Vec<OpenThreshold>,
}

/// Why there is no such input.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum DesignError {
    /// No input stays in the range.
    #[error(
        "no input with levels up to {largest} keeps the joint in its range: give a wider range, \
         a smaller largest level or shorter holds"
    )]
    OutOfRange {
        /// Largest magnitude of the input.
        largest: f64,
    },
    /// One suspect can do what the other does, whatever the input.
    #[error(
        "no input of {longest_s} s or less distinguishes them: with the parameters known so far, \
         one of them gives the same output as the other"
    )]
    Imitated {
        /// Longest input that was tried, seconds.
        longest_s: f64,
    },
    /// None of the inputs that were tried is good enough.
    #[error(
        "no input of {longest_s} s or less distinguishes them with power {wanted}; the best one \
         found has {best:.2}: give more time, larger levels or a wider range"
    )]
    NotApart {
        /// The power that was wanted.
        wanted: f64,
        /// The largest power that was found.
        best: f64,
        /// Longest input that was tried, seconds.
        longest_s: f64,
    },
}

impl Design {
    /// The least power for the suspects that it is to separate.
    pub fn power(&self) -> f64 {
        self.targets().map(|side| side.expected.power()).fold(1.0, f64::min)
    }

    /// The share of its rehearsals that succeeded, of the suspect with the least.
    pub(crate) fn share_of_successes(&self) -> f64 {
        let rehearsals = self.sides.iter().filter_map(|side| side.rehearsal);
        let share = |found: Rehearsal| found.successes as f64 / found.runs.max(1) as f64;
        rehearsals.map(share).fold(1.0, f64::min)
    }

    /// Whether all rehearsals were made, and no more failed than may.
    pub fn passes(&self, limits: &Limits) -> bool {
        let passed = |found: Rehearsal| {
            found.runs == limits.rehearsals && found.runs - found.successes <= limits.failures()
        };
        self.targets().map(|side| side.rehearsal).all(|found| found.is_some_and(passed))
    }

    /// By how many standard deviations it is on the safe side with all that it is to separate.
    pub(super) fn margin(&self) -> f64 {
        self.targets().map(|side| side.expected.margin()).fold(f64::INFINITY, f64::min)
    }

    fn targets(&self) -> impl Iterator<Item = &Side> {
        self.sides.iter().filter(|side| side.is_target)
    }
}
