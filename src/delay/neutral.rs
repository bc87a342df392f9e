//! The level of the input at which a joint is meant to stand still, and the kinds of steps by it.
//!
//! A valve's command is zero there, a servo's duty is some 7.5 %, a joystick's voltage half
//! its supply. It is found from the record, from what the input holds and the output does.

use std::cmp::Ordering;
use std::fmt;

use serde::Serialize;

use super::hold::{Hold, alike, holds, level_tolerance};
use super::steps::InputStep;
use crate::experiment::{Property, Record};

/// Where the input of a joint is neutral: at a level, and within a dead band about it.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Neutral {
    /// The level, input units.
    pub level: f64,
    /// The least input that counts as neutral.
    pub low: f64,
    /// The greatest input that counts as neutral.
    pub high: f64,
}

impl Property for Option<Neutral> {
    fn find(record: &Record) -> Self {
        let tolerance = level_tolerance(record);
        let held: Vec<Vec<Hold>> = record.iter().map(|trial| holds(trial, tolerance)).collect();
        let levels = Level::all(&held.concat(), tolerance);
        let level = neutral_level(&levels, tolerance)?;
        let (low, high) = dead_band(&held, level, tolerance);
        Some(Neutral { level, low: low - tolerance, high: high + tolerance })
    }
}

impl Neutral {
    /// The neutral level of a joint, found from all its trials; none where the record does
    /// not show it.
    ///
    /// The first of these that there is:
    /// 1. zero, where it is held and the output rests;
    /// 2. the level that most trials begin and end with, if the output rests there;
    /// 3. zero, where it is held and the output comes to rest;
    /// 4. the longest held level at which the output rests while it goes on moving at others;
    /// 5. zero, where the input is held there, or on both sides of it.
    ///
    /// The output comes to rest at a level when its mean speed in the second halves of the
    /// holds is at most a quarter of the mean speed at all other levels, and it rests when its
    /// speed in the whole holds is at most half of that, too: a joint coasts when its input
    /// becomes neutral, and one that is driven against a stop has moved before.
    ///
    /// The band reaches to those held levels that do not move the joint from rest, and beyond
    /// them by the tolerance of levels: a part of the input's range, or what its noise takes.
    pub fn of(record: &Record) -> Option<Self> {
        *record.property()
    }

    /// On which side of neutral an input is; equal within the band.
    pub fn side(&self, input: f64) -> Ordering {
        if input > self.high {
            Ordering::Greater
        } else if input < self.low {
            Ordering::Less
        } else {
            Ordering::Equal
        }
    }
}

/// The kind of a step of the input, by the sides of [neutral](Neutral) that it joins.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize)]
#[serde(rename_all = "snake_case")]
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

/// All holds of one level.
#[derive(Clone, Copy, Debug, Default)]
struct Level {
    /// The level of the longest hold.
    input: f64,
    longest_s: f64,
    seconds: f64,
    travel: f64,
    late_travel: f64,
    /// How many trials begin, and how many end with it.
    ends: usize,
}

impl Level {
    /// The levels in rising order, each at most `tolerance` wide.
    fn all(holds: &[Hold], tolerance: f64) -> Vec<Self> {
        let mut sorted: Vec<&Hold> = holds.iter().collect();
        sorted.sort_by(|a, b| a.level.total_cmp(&b.level));
        let groups = alike(&sorted, |hold| hold.level, tolerance);
        let level = |same: &[&Hold]| same.iter().fold(Self::default(), |it, hold| it.with(hold));
        groups.into_iter().map(level).collect()
    }

    fn with(self, hold: &Hold) -> Self {
        let is_longer = hold.seconds > self.longest_s;
        Self {
            input: if is_longer { hold.level } else { self.input },
            longest_s: self.longest_s.max(hold.seconds),
            seconds: self.seconds + hold.seconds,
            travel: self.travel + hold.travel.abs(),
            late_travel: self.late_travel + hold.late_travel.abs(),
            ends: self.ends + usize::from(hold.is_first) + usize::from(hold.is_last),
        }
    }

    /// How the output moves here, and at the other levels of `all`.
    fn motion(&self, all: &Self) -> Motion {
        /// Largest part of the mean speed elsewhere, coasting included (chosen).
        const REST: f64 = 0.5;
        /// Largest part of it in the second halves of holds, when the joint has coasted.
        const LATE: f64 = 0.25;
        let others_s = all.seconds - self.seconds;
        let elsewhere = (all.travel - self.travel) / others_s;
        // The second halves are half of the time.
        let late_elsewhere = 2.0 * (all.late_travel - self.late_travel) / others_s;
        let is_compared = others_s > 0.0 && elsewhere > 0.0;
        let comes_to_rest = 2.0 * self.late_travel / self.seconds <= LATE * elsewhere;
        Motion {
            comes_to_rest: is_compared && comes_to_rest,
            rests: is_compared && comes_to_rest && self.travel / self.seconds <= REST * elsewhere,
            moves_elsewhere: is_compared && late_elsewhere >= REST * elsewhere,
        }
    }
}

/// What the output does at a level.
struct Motion {
    comes_to_rest: bool,
    rests: bool,
    /// Whether it goes on moving in the second halves of the holds of other levels.
    moves_elsewhere: bool,
}

fn neutral_level(levels: &[Level], tolerance: f64) -> Option<f64> {
    /// Smallest part of the record that a level at which the joint is meant to rest is held.
    const SHARE: f64 = 0.01;
    let all = levels.iter().fold(Level::default(), |sum, level| Level {
        seconds: sum.seconds + level.seconds,
        travel: sum.travel + level.travel,
        late_travel: sum.late_travel + level.late_travel,
        ends: sum.ends + level.ends,
        ..sum
    });
    let near = levels.iter().filter(|level| level.input.abs() <= tolerance);
    let zero = near.min_by(|a, b| a.input.abs().total_cmp(&b.input.abs()));
    let resting = || levels.iter().filter(|level| level.motion(&all).rests);
    let alone = resting().filter(|level| level.seconds >= SHARE * all.seconds);
    let alone = alone.filter(|level| level.motion(&all).moves_elsewhere);
    let is_inside = levels.first()?.input < 0.0 && levels.last()?.input > 0.0;
    let found = zero
        .filter(|zero| zero.motion(&all).rests)
        .or_else(|| resting().find(|level| 2 * level.ends > all.ends))
        .or_else(|| zero.filter(|zero| zero.motion(&all).comes_to_rest))
        .or_else(|| alone.max_by(|a, b| a.seconds.total_cmp(&b.seconds)))
        .or(zero);
    found.map(|level| level.input).or(is_inside.then_some(0.0))
}

/// The least and the greatest of the levels about `level` that do not move the joint from
/// rest: where the output goes but a small part of what it does at other levels, in every
/// hold that follows on `level` and is nearer to it.
///
/// A hold that may be shorter than the delay shows nothing: only those count that are half as
/// long as the one in which a sample lies on average.
fn dead_band(held: &[Vec<Hold>], level: f64, tolerance: f64) -> (f64, f64) {
    /// Largest part of the mean speed of all holds, and of their mean travel (chosen).
    const STILL: f64 = 0.05;
    let all = || held.iter().flatten();
    let sum = |value: fn(&Hold) -> f64| all().map(value).sum::<f64>();
    let (seconds, travel) = (sum(|hold| hold.seconds), sum(|hold| hold.travel.abs()));
    // Σ s²/Σ s: the mean hold of a sample.
    let long_s = 0.5 * sum(|hold| hold.seconds * hold.seconds) / seconds;
    let mean = travel / all().count() as f64;
    let most = |hold: &Hold| STILL * mean.min(travel / seconds * hold.seconds);
    let pairs = held.iter().flat_map(|holds| holds.iter().zip(holds.iter().skip(1)));
    let after = pairs.filter(|(before, _)| (before.level - level).abs() <= tolerance);
    let after = after.filter(|(_, hold)| hold.seconds >= long_s);
    let after: Vec<(f64, bool)> =
        after.map(|(_, hold)| (hold.level - level, hold.travel.abs() <= most(hold))).collect();
    let reach = |side: f64| {
        let here = || after.iter().map(|(away, still)| (side * away, *still));
        let here = || here().filter(|(away, _)| *away > 0.0);
        let moving = here().filter(|(_, still)| !still).map(|(away, _)| away);
        // A level that moves the joint bounds the band, even where one beyond it does not.
        let least = moving.fold(f64::INFINITY, f64::min) - tolerance;
        let still = here().filter(|(away, still)| *still && *away < least);
        side * still.map(|(away, _)| away).fold(0.0, f64::max)
    };
    (level + reach(-1.0), level + reach(1.0))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::experiment::Trial;
    use crate::units::SamplePeriod;
    use proptest::prelude::*;

    /// A joint that goes as fast as its input is beyond a dead band about `neutral`, 15
    /// samples late, between two stops, with a little noise.
    fn joint(neutral: f64, dead: f64, levels: &[f64], hold: usize, stop: f64) -> Trial {
        let input: Vec<f64> =
            levels.iter().flat_map(|u| std::iter::repeat_n(neutral + u, hold)).collect();
        let mut angle: f64 = 0.0;
        let output = (0..input.len()).map(|k| {
            let u = input[k.saturating_sub(15)] - neutral;
            angle += 0.1 * u.signum() * (u.abs() - dead).max(0.0);
            angle = angle.clamp(-stop, stop);
            angle + 0.002 * ((k * 7919) % 101) as f64 / 50.0
        });
        let output = output.collect();
        let period = SamplePeriod::from_seconds(0.01).unwrap();
        Trial::new("1", 0.0, period, input, output).unwrap()
    }

    const LEVELS: [f64; 12] = [0.0, 1.0, -1.0, 0.0, 2.0, 1.0, 0.0, -2.0, 0.0, -1.0, 2.0, 0.0];

    fn level(trials: &[Trial]) -> Option<f64> {
        Neutral::of(&trials.to_vec().into()).map(|neutral| neutral.level)
    }

    #[test]
    fn zero_is_neutral_where_it_is_held() {
        assert_eq!(level(&[joint(0.0, 0.0, &LEVELS, 100, 1e9)]), Some(0.0));
        // A stroke from stop to stop, held there.
        let strokes = [2.0, -2.0, 1.0].map(|u| joint(0.0, 0.0, &[0.0, u, u, u, 0.0], 200, 5.0));
        assert_eq!(level(&strokes), Some(0.0));
    }

    #[test]
    fn zero_is_not_neutral_where_the_joint_moves_and_rests_elsewhere() {
        let levels = LEVELS.map(|u| 1.25 * u);
        assert_eq!(level(&[joint(2.5, 0.0, &levels, 100, 1e9)]), Some(2.5));
        let strokes = [2.5, -2.5, 1.0].map(|u| joint(2.5, 0.0, &[0.0, u, u, u, 0.0], 200, 5.0));
        assert_eq!(level(&strokes), Some(2.5));
    }

    #[test]
    fn zero_between_the_levels_is_neutral_and_one_beyond_them_is_not() {
        let turns = [1.0, -1.0, 2.0, -2.0, 1.0, -2.0];
        assert_eq!(level(&[joint(0.0, 0.0, &turns, 100, 1e9)]), Some(0.0));
        assert_eq!(level(&[joint(7.0, 0.0, &turns, 100, 1e9)]), None);
        assert_eq!(level(&[]), None);
    }

    #[test]
    fn an_output_that_settles_at_every_level_keeps_zero() {
        let input: Vec<f64> =
            (0..3000).map(|k| f64::from((k / 200_i32).min(14 - k / 200))).collect();
        let mut speed = 0.0;
        let output = input.iter().map(|u| {
            speed += 0.05 * (u - speed);
            speed
        });
        let output = output.collect();
        let period = SamplePeriod::from_seconds(0.02).unwrap();
        let trial = Trial::new("1", 0.0, period, input, output).unwrap();
        let neutral = Neutral::of(&Record::from([trial])).unwrap();
        assert_eq!(neutral.side(0.0), Ordering::Equal);
        assert_eq!(neutral.side(1.0), Ordering::Greater);
    }

    #[test]
    fn levels_that_do_not_move_the_joint_are_neutral() {
        let levels = [0.0, 0.3, 0.0, 2.0, 0.0, -0.3, 0.0, -2.0, 0.0, 0.6, 0.0, 1.0, 0.0, -1.0, 0.0];
        let neutral = Neutral::of(&Record::from([joint(1.0, 0.7, &levels, 100, 1e9)])).unwrap();
        let sides = [0.4, 0.7, 1.0, 1.3, 1.6, 1.95].map(|u| neutral.side(u));
        let band = [Ordering::Equal; 4];
        assert_eq!(sides[1..5], band);
        assert_eq!((sides[0], sides[5]), (Ordering::Less, Ordering::Greater));
    }

    proptest! {
        #[test]
        fn it_moves_and_scales_with_the_input(
            neutral in -20.0..20.0_f64,
            gain in 0.1..50.0_f64,
            hold in 60_usize..200,
            noise in 0.0..0.02_f64,
        ) {
            let shaken = |trial: Trial| {
                let wiggle = |k: usize| noise * (((k * 7919) % 101) as f64 / 50.0 - 1.0);
                let input = trial.input().iter().enumerate();
                let input = input.map(|(k, u)| gain * (u + wiggle(k))).collect();
                Trial::new("1", 0.0, trial.period(), input, trial.output().to_vec()).unwrap()
            };
            let trials = [shaken(joint(neutral, 0.0, &LEVELS, hold, 1e9))];
            let found = Neutral::of(&Record::from(trials.clone())).unwrap();
            let expected = gain * neutral;
            prop_assert!((found.level - expected).abs() <= 0.05 * gain, "{found:?} {expected}");
            prop_assert_eq!(found.side(expected), Ordering::Equal);
            prop_assert_eq!(found.side(expected + gain), Ordering::Greater);
            prop_assert_eq!(found.side(expected - gain), Ordering::Less);
        }
    }

    #[test]
    fn without_a_neutral_level_every_step_is_a_change() {
        let step = InputStep { sample: 9, before: 0.0, after: 1.0 };
        assert_eq!(Transition::of(&step, None), Transition::Change);
    }
}
