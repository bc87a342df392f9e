//! What would separate two effects: an experiment in numbers, and how far apart it brings them.

use serde::Serialize;

/// How the levels of an input follow one another.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Pattern {
    /// Rising and then falling, first in one direction and then in the other.
    Ladder,
    /// Each in both directions, with the input at zero after each.
    Pulses,
    /// Each in both directions, one directly after the other.
    Reversals,
}

/// Where and when a run of an experiment starts.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Start {
    /// The angle, output units.
    pub angle: f64,
    /// Activity of the other joints meanwhile, 0 to 1.
    pub others: f64,
    /// Seconds for which the machine has worked before.
    pub worked_s: f64,
}

/// An experiment: an input, and the runs that are made with it.
#[derive(Clone, Debug, PartialEq)]
pub struct Proposal {
    /// How the levels follow one another.
    pub pattern: Pattern,
    /// Their magnitudes, ascending, input units.
    pub levels: Vec<f64>,
    /// How long each is held, seconds.
    pub hold_s: f64,
    /// Where each run starts.
    pub starts: Vec<Start>,
}

/// What would separate two effects.
#[derive(Clone, Debug, PartialEq)]
pub struct Separation {
    /// Id of the other effect.
    pub other: &'static str,
    /// The best experiment of those that were tried.
    pub proposal: Proposal,
    /// The largest difference between the outputs of the two models in it, in times the
    /// noise of the measurement.
    pub times_noise: f64,
    /// Seconds from the start of a run to that.
    pub after_s: f64,
    /// Whether the difference is large enough beside what other gains and starts of the
    /// output could explain.
    pub is_clear: bool,
}

impl Pattern {
    /// `levels` in the order of the pattern, after a rest.
    pub(crate) fn sequence(self, levels: &[f64]) -> Vec<f64> {
        let mirrored = |level: &f64| [*level, -level];
        match self {
            Self::Ladder => {
                let falling = levels.iter().rev().skip(1);
                let up_and_down: Vec<f64> = levels.iter().chain(falling).copied().collect();
                let back = up_and_down.iter().map(|level| -level);
                std::iter::once(0.0).chain(up_and_down.iter().copied()).chain(back).collect()
            }
            Self::Pulses => {
                let pulses = levels.iter().flat_map(mirrored);
                std::iter::once(0.0).chain(pulses.flat_map(|level| [level, 0.0])).collect()
            }
            Self::Reversals => {
                std::iter::once(0.0).chain(levels.iter().flat_map(mirrored)).collect()
            }
        }
    }
}

impl Proposal {
    /// The levels of a run in their order, each held for [`hold_s`](Self::hold_s); the joint
    /// rests as long before the first.
    pub fn sequence(&self) -> Vec<f64> {
        self.pattern.sequence(&self.levels)
    }

    /// Seconds that all runs take together.
    pub fn duration_s(&self) -> f64 {
        (self.sequence().len() * self.starts.len()) as f64 * self.hold_s
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_pattern_goes_both_ways() {
        let levels = |pattern: Pattern| pattern.sequence(&[1.0, 2.0]);
        assert_eq!(levels(Pattern::Ladder), [0.0, 1.0, 2.0, 1.0, -1.0, -2.0, -1.0]);
        assert_eq!(levels(Pattern::Pulses), [0.0, 1.0, 0.0, -1.0, 0.0, 2.0, 0.0, -2.0, 0.0]);
        assert_eq!(levels(Pattern::Reversals), [0.0, 1.0, -1.0, 2.0, -2.0]);
    }
}
