//! Conditions of trials, as their labels say them.
//!
//! `A-in-100-H-S` is a stroke with the high load, and `A-in-100-L-S` the same with the low one: a
//! word that some labels have and others not is a condition, where it says more than the input
//! does. A word that comes with a level or a direction alone says nothing more; nor does a number,
//! which counts trials or names a level.

use super::Trial;

/// Whether `label` has `word`, between what is no letter and no digit.
pub fn has_word(label: &str, word: &str) -> bool {
    words(label).any(|other| other == word)
}

fn words(label: &str) -> impl Iterator<Item = &str> {
    // What is behind `#` counts the parts into which a trial was cut.
    let whole = label.split_once('#').map_or(label, |(whole, _)| whole);
    whole.split(|c: char| !c.is_alphanumeric()).filter(|word| !word.is_empty())
}

/// The words of the labels that say what differs between trials of the same input, in the order
/// in which they appear; of several that say the same, the first.
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
/// assert_eq!(conditions(&trials), ["heavy"]);
/// # Ok::<(), tauscope::experiment::TrialError>(())
/// ```
pub fn conditions(trials: &[Trial]) -> Vec<String> {
    /// Words that are tried, at most: each costs fits.
    const MOST: usize = 3;
    let mut found: Vec<(&str, Vec<bool>)> = Vec::new();
    for word in trials.iter().flat_map(|trial| words(trial.label())) {
        let is_number = word.chars().all(|c| c.is_ascii_digit());
        if is_number || found.iter().any(|(known, _)| *known == word) {
            continue;
        }
        let with: Vec<bool> = trials.iter().map(|trial| has_word(trial.label(), word)).collect();
        let says_the_same = |(_, other): &(&str, Vec<bool>)| {
            *other == with || other.iter().zip(&with).all(|(a, b)| a != b)
        };
        if is_balanced(&with) && !found.iter().any(says_the_same) && crosses_input(trials, &with) {
            found.push((word, with));
        }
    }
    found.into_iter().map(|(word, _)| word.to_owned()).take(MOST).collect()
}

/// Whether there are trials of both kinds, enough to fit and to judge.
fn is_balanced(with: &[bool]) -> bool {
    /// Trials of either kind, and the part of all that they are.
    const FEWEST: usize = 3;
    const SHARE: f64 = 0.15;
    let count = with.iter().filter(|has| **has).count();
    let fewer = count.min(with.len() - count);
    fewer >= FEWEST && fewer as f64 >= SHARE * with.len() as f64
}

/// Whether most trials of the rarer kind have one of the other kind that is driven alike.
fn crosses_input(trials: &[Trial], with: &[bool]) -> bool {
    let drives: Vec<[f64; 2]> = trials.iter().map(drive).collect();
    let largest = drives.iter().flatten().fold(0.0, |most: f64, value| most.max(value.abs()));
    // Levels as they were commanded, and measured ones of the same command.
    let is_near =
        |a: &[f64; 2], b: &[f64; 2]| a.iter().zip(b).all(|(a, b)| (a - b).abs() <= 0.05 * largest);
    let both = || drives.iter().zip(with);
    let rarer = with.iter().filter(|has| **has).count() * 2 <= with.len();
    let of_rarer: Vec<_> = both().filter(|(_, has)| **has == rarer).collect();
    let has_twin = |(own, _): &&(&[f64; 2], &bool)| {
        both().any(|(other, has)| *has != rarer && is_near(own, other))
    };
    of_rarer.iter().filter(|one| has_twin(one)).count() * 2 > of_rarer.len()
}

/// The lowest and the highest level that drive a trial.
fn drive(trial: &Trial) -> [f64; 2] {
    let input = trial.input().iter().copied();
    let (low, high) = input.fold((f64::MAX, f64::MIN), |(l, h), u| (l.min(u), h.max(u)));
    [low, high]
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
        assert_eq!(conditions(&strokes(&["H", "L"])), ["H"]);
        assert_eq!(conditions(&strokes(&["cold", "warm", "hot"])), ["cold", "warm", "hot"]);
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
