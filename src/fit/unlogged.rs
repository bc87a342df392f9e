//! What the input was where nobody logged it: before the first sample, and in gaps.
//!
//! Loggers are often started by the step that they are to record, and paused while the valve is
//! switched. The input then has its new level from the first sample on, and the joint still rests for
//! as long as its delay. A model that takes the level for one that has long been held is ahead by
//! a delay, which a fit makes up for by a delay of zero and a backlash. So where a joint leaves its
//! rest within a hold of the input, the input is taken to have been at its neutral until then.

use crate::delay::followed;
use crate::experiment::{Record, Trial};
use crate::model::Commands;
use crate::numerics::noise_of_bends;

/// The changes of the input of each of `trials`, with those from and to `neutral` that are in no log.
/// Where the output follows the input itself, no level is one of rest.
pub(super) fn commands(trials: &Record, neutral: f64) -> Vec<Commands> {
    let rests: Vec<Vec<usize>> = trials.iter().map(|trial| rests(trial, neutral)).collect();
    // What the output follows takes a look at the whole record.
    if rests.iter().all(Vec::is_empty) || followed(trials).is_some() {
        return trials.iter().map(logged).collect();
    }
    let pairs = trials.iter().zip(&rests);
    pairs.map(|(trial, rests)| with_rests(trial, rests, neutral)).collect()
}

fn logged(trial: &Trial) -> Commands {
    Commands::new(trial.input(), trial.period().seconds())
}

fn with_rests(trial: &Trial, rests: &[usize], neutral: f64) -> Commands {
    let mut commands = logged(trial);
    for gap in trial.unlogged().iter().filter(|gap| rests.contains(&gap.end)) {
        let from_s = gap.start as f64 * trial.period().seconds();
        commands = commands.with_rest_at(neutral, from_s);
    }
    if rests.contains(&0) { commands.begun_at(neutral) } else { commands }
}

/// The first sample of the trial, and those after gaps, at which the joint rests though the input is
/// not `neutral` there.
fn rests(trial: &Trial, neutral: f64) -> Vec<usize> {
    let gaps = trial.unlogged().iter().map(|gap| gap.end);
    let mut away = gaps.chain([0]).filter(|from| is_away(trial, *from, neutral)).peekable();
    if away.peek().is_none() {
        return Vec::new();
    }
    let noise = noise_of_bends(trial.output().windows(3));
    away.filter(|from| rests_first(trial, *from, noise)).collect()
}

/// Whether the input is not `neutral` at a sample.
#[expect(clippy::float_cmp, reason = "a level is any value")]
fn is_away(trial: &Trial, sample: usize, neutral: f64) -> bool {
    trial.input().get(sample).is_some_and(|level| *level != neutral)
}

/// Whether the output rests at sample `from` and leaves within the hold that begins there.
///
/// It has left when it has made a small part of the way of the hold, beyond the noise. Its mean speed
/// until then is to be much below that over the next half of the way: a joint that moved from the
/// first sample on has about the same.
#[expect(clippy::float_cmp, reason = "a hold ends with any change")]
fn rests_first(trial: &Trial, from: usize, noise: f64) -> bool {
    /// The part of the way with which it has left, and the one at which its speed is compared.
    /// Chosen: less than most first reactions, and before most stops.
    const LEFT: f64 = 0.03;
    const AWAY: f64 = 0.6;
    /// Standard deviations of the noise that none of some hundred samples exceeds.
    const BEYOND: f64 = 4.0;
    /// The first speed in parts of the second, at most. Chosen: a rest of three samples in a hold of
    /// seventy has 0.4.
    const SLOWER: f64 = 0.5;
    /// Samples of rest: fewer are no delay that could be seen.
    const FEWEST: usize = 3;
    let level = trial.input()[from];
    let hold = trial.input()[from..].iter().take_while(|u| **u == level).count();
    let output = &trial.output()[from..from + hold];
    let (Some(first), Some(last)) = (output.first(), output.last()) else { return false };
    let left_at = f64::max(LEFT, BEYOND * noise / (last - first).abs());
    // So much noise leaves too little of the way to compare speeds in.
    if left_at >= AWAY / 2.0 {
        return false;
    }
    let way = |y: &f64| (y - first) / (last - first);
    let reaches = |part: f64| output.iter().position(|y| way(y) >= part);
    let is_the_way = output.iter().all(|y| (-left_at..=1.0 + left_at).contains(&way(y)));
    let (Some(left), Some(away)) = (reaches(left_at), reaches(AWAY)) else { return false };
    let speed = |part: f64, samples: usize| part / samples.max(1) as f64;
    let is_slower = speed(left_at, left) < SLOWER * speed(AWAY - left_at, away - left);
    is_the_way && left > FEWEST && is_slower
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::numerics::testing::normals;
    use crate::units::SamplePeriod;

    /// A joint that rests for `rest` samples and then moves by 0.1 a sample.
    fn trial(rest: usize, input: Vec<f64>) -> Trial {
        let output = (0..input.len()).map(|k| 0.1 * k.saturating_sub(rest) as f64).collect();
        Trial::new("1", 0.0, SamplePeriod::from_seconds(0.02).unwrap(), input, output).unwrap()
    }

    /// The commands of a trial at rest at 7.5.
    fn found(trial: &Trial) -> Commands {
        with_rests(trial, &rests(trial, 7.5), 7.5)
    }

    #[test]
    fn a_joint_that_leaves_its_rest_within_a_hold_was_at_its_neutral() {
        let begun = |rest, input| found(&trial(rest, vec![input; 70]));
        let held = Commands::new(&[10.0; 70], 0.02);
        assert_eq!(begun(6, 10.0), held.clone().begun_at(7.5));
        assert_eq!(begun(0, 10.0), held, "it moved from the first sample on");
        assert_eq!(begun(70, 10.0), held, "it never moved");
        assert_eq!(begun(6, 7.5), Commands::new(&[7.5; 70], 0.02), "it is at its neutral");
    }

    #[test]
    fn noise_hides_no_rest_and_is_none() {
        let (period, mut normal) = (SamplePeriod::from_seconds(0.02).unwrap(), normals(7));
        let mut begun_of = |rest: usize| {
            let output =
                (0..70_usize).map(|k| 0.1 * k.saturating_sub(rest) as f64 + 0.1 * normal());
            let trial = Trial::new("1", 0.0, period, vec![10.0; 70], output.collect()).unwrap();
            found(&trial) != Commands::new(&[10.0; 70], 0.02)
        };
        let rested = (0..40).filter(|_| begun_of(12)).count();
        let moved = (0..40).filter(|_| begun_of(0)).count();
        // In noise of one sample's way each fails in a few of a hundred.
        assert!(rested >= 34 && moved <= 2, "{rested} of 40 that rested, {moved} that moved");
    }

    #[test]
    fn a_joint_that_rests_behind_a_gap_was_at_its_neutral_within_it() {
        let levels = [[10.0; 40], [5.0; 40]].concat();
        let (mut output, period) = (Vec::new(), SamplePeriod::from_seconds(0.02).unwrap());
        for k in 0..80_usize {
            let back = k.saturating_sub(46) as f64;
            output.push(0.1 * k.min(40) as f64 - 0.1 * back);
        }
        let whole = Trial::new("1", 0.0, period, levels.clone(), output).unwrap();
        assert_eq!(found(&whole), Commands::new(&levels, 0.02));
        let gap = whole.with_unlogged(std::iter::once(20..40).collect());
        let expected = Commands::new(&levels, 0.02).with_rest_at(7.5, 0.4);
        assert_eq!(found(&gap), expected);
    }
}
