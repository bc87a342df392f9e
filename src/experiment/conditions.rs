//! Conditions of trials, as their labels say them.
//!
//! `A-in-100-H-S` is a stroke with the high load, and `A-in-100-L-S` the same with the low one: a
//! word that some labels have and others not is a condition, where it says more than the input
//! does. A word that comes with a level or a direction alone says nothing more; nor does a number,
//! which counts trials or names a level.

use std::collections::BTreeMap;

use super::Trial;

/// Whether each of `trials` has one of the two words and not the other.
pub(crate) fn are_opposites(trials: &[Trial], [one, other]: [&str; 2]) -> bool {
    trials.iter().all(|trial| has_word(trial.label(), one) != has_word(trial.label(), other))
}

/// Whether `label` has `word`, between what is no letter and no digit.
pub(crate) fn has_word(label: &str, word: &str) -> bool {
    words(label).any(|other| other == word)
}

fn words(label: &str) -> impl Iterator<Item = &str> {
    // What is after `#` counts the parts into which a trial was cut.
    let whole = Trial::whole_label(label);
    whole.split(|c: char| !c.is_alphanumeric()).filter(|word| !word.is_empty())
}

/// The words of the labels that say what differs between trials of the same input, in the order
/// of the alphabet, so that the order of the trials says nothing; of several that say the same, the
/// first.
///
/// # Examples
/// ```
/// use tauscope::experiment::{Trial, conditions};
/// use tauscope::units::SamplePeriod;
///
/// let period = SamplePeriod::from_seconds(0.01).unwrap();
/// let trial = |label: &str, level| Trial::new(label, 0.0, period, vec![level; 4], vec![0.0; 4]);
/// let levels = [40.0, 60.0, 80.0];
/// let of = |load| levels.map(|level| trial(&format!("out-{level}-{load}"), level));
/// let trials = ["heavy", "light"].into_iter().flat_map(of).collect::<Result<Vec<_>, _>>()?;
/// assert_eq!(conditions(&trials), ["heavy", "light"]);
/// # Ok::<(), tauscope::experiment::TrialError>(())
/// ```
pub fn conditions(trials: &[Trial]) -> Vec<String> {
    /// Words that are tried, at most: each costs fits.
    const MOST: usize = 4;
    let mut labelled: BTreeMap<&str, Vec<usize>> = BTreeMap::new();
    for (index, trial) in trials.iter().enumerate() {
        for word in words(trial.label()).filter(|word| !is_number(word)) {
            let with = labelled.entry(word).or_default();
            if with.last() != Some(&index) {
                with.push(index);
            }
        }
    }
    let mut found: Vec<(&str, &Vec<usize>)> = Vec::new();
    for (word, with) in &labelled {
        let is_new = found.iter().all(|(_, other)| *other != with);
        if is_new && is_balanced(with.len(), trials.len()) && crosses_input(trials, with) {
            found.push((word, with));
        }
    }
    found.into_iter().map(|(word, _)| word.to_owned()).take(MOST).collect()
}

fn is_number(word: &str) -> bool {
    word.chars().all(|c| c.is_ascii_digit())
}

/// Whether there are trials of both kinds, enough to fit and to judge.
fn is_balanced(with: usize, all: usize) -> bool {
    /// Trials of either kind, and the part of all that they are.
    const FEWEST: usize = 3;
    const SHARE: f64 = 0.15;
    let fewer = with.min(all - with);
    fewer >= FEWEST && fewer as f64 >= SHARE * all as f64
}

/// Whether most trials have one of the other kind that is driven alike; those `with` a word are one
/// kind.
fn crosses_input(trials: &[Trial], with: &[usize]) -> bool {
    let drives: Vec<(Drive, bool)> = (0..)
        .zip(trials)
        .map(|(index, trial)| (Drive::of(trial), with.binary_search(&index).is_ok()))
        .collect();
    let has_twin = |(own, kind): &&(Drive, bool)| {
        drives.iter().any(|(other, other_kind)| kind != other_kind && own.is_like(other))
    };
    drives.iter().filter(has_twin).count() * 2 > trials.len()
}

/// What drives a trial.
#[derive(Clone, Copy, Debug)]
struct Drive {
    low: f64,
    high: f64,
    /// How often the level changes.
    changes: usize,
}

impl Drive {
    fn of(trial: &Trial) -> Self {
        let input = trial.input();
        let (low, high) = input.iter().fold((f64::MAX, f64::MIN), |(l, h), u| (u.min(l), u.max(h)));
        let changes = input.windows(2).filter(|pair| (pair[1] - pair[0]).abs() > 0.0).count();
        Self { low, high, changes }
    }

    /// Whether both have about the same levels: those of a stroke, or most of the range of many.
    fn is_like(&self, other: &Self) -> bool {
        /// Changes from which on a trial is no stroke.
        const MANY: usize = 6;
        /// Part of the range that two strokes of the same level may differ by, as of a measured
        /// input, and that many random levels have in common at least.
        const SAME: f64 = 0.05;
        const COMMON: f64 = 0.6;
        let whole = self.high.max(other.high) - self.low.min(other.low);
        if self.changes.min(other.changes) >= MANY {
            let common = self.high.min(other.high) - self.low.max(other.low);
            return common >= COMMON * whole;
        }
        (self.low - other.low).abs() <= SAME * whole
            && (self.high - other.high).abs() <= SAME * whole
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::units::SamplePeriod;

    fn trial(label: &str, level: f64) -> Trial {
        let period = SamplePeriod::from_seconds(0.01).unwrap();
        Trial::new(label, 0.0, period, vec![0.0, level], vec![0.0; 2]).unwrap()
    }

    fn strokes(conditions: &[&str]) -> Vec<Trial> {
        let levels = [-80.0, -40.0, 40.0, 80.0];
        let of = |condition: &&str| {
            let direction = |level: f64| if level < 0.0 { "in" } else { "out" };
            levels.map(|u| trial(&format!("A-{}-{u}-{condition}", direction(u)), u))
        };
        conditions.iter().flat_map(of).collect()
    }

    #[test]
    fn a_word_that_crosses_the_levels_is_a_condition() {
        assert_eq!(conditions(&strokes(&["H", "L"])), ["H", "L"]);
        assert_eq!(conditions(&strokes(&["cold", "warm", "hot"])), ["cold", "hot", "warm"]);
    }

    #[test]
    fn a_word_that_names_what_the_input_is_says_no_more() {
        assert!(conditions(&strokes(&["S"])).is_empty());
        assert!(conditions(&strokes(&["1", "2"])).is_empty());
        let named = |u: f64| trial(if u > 20.0 { "fast" } else { "slow" }, u);
        let levels: Vec<f64> = (1..12).map(|k| f64::from(k) * 4.0).collect();
        assert!(conditions(&levels.into_iter().map(named).collect::<Vec<_>>()).is_empty());
    }

    #[test]
    fn words_stand_between_what_is_no_letter() {
        assert!(has_word("day1/A-in-100-H-S#2", "H") && has_word("heavy load", "heavy"));
        assert!(!has_word("heavyload", "heavy") && !has_word("A#2", "2"));
    }
}
