//! Whether an input holds its levels or moves all the time, judged by the record alone.
//!
//! An input that is made of steps travels from one level that it holds to the next in no time;
//! a joystick's input travels in between. What is measured is the **part of its travel that is
//! made in steps**: with `L_j` the levels that it holds and `|u_k − u_(k−1)|` summed up as its
//! whole travel,
//!
//! ```text
//! share = Σ |L_(j+1) − L_j| / Σ |u_k − u_(k−1)|      over edges of at most 0.1 s
//! ```
//!
//! A level is held when the input stays within its noise for 0.15 s and five samples (where levels
//! are exact, far apart and last differently long, as those that are drawn for a fast joint, for five
//! samples); that with
//! which a trial begins was held before, however short the rest of it is. Noise and
//! dither are what the input takes back at once: changes that the next change undoes. They are
//! ignored, as far as they are small beside the range or become so by a running median.
//!
//! Of 27 inputs of real machines and made ones, those made of steps have a share of 0.93 or
//! more, at 10 Hz to 1 kHz, with noise, dither and interpolated edges; joysticks, sines, ramps,
//! feedback and levels drawn anew every 0.1 s have 0.32 or less.

use std::collections::VecDeque;
use std::ops::Range;

use serde::Serialize;

use super::input_noise::{Levels, in_samples};
use crate::experiment::{Property, Record, Trial};
use crate::numerics::{limits, median};

/// How an input is to be taken.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum InputKind {
    /// As its record shows: see [`InputMotion`].
    #[default]
    Auto,
    /// As steps from level to level, each of which has a delay.
    Steps,
    /// As moving all the time: one dead time over the record.
    Continuous,
}

/// How the input of a joint moves.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct InputMotion {
    /// The part of the samples at which the input differs from the sample before.
    pub changes: f64,
    /// The part of the time in which the input holds a level.
    pub held: f64,
    /// The part of its travel that is made in steps between levels that it holds, 0 to 1; none
    /// for an input that hardly ever changes.
    pub travel_in_steps: Option<f64>,
}

/// Part of the travel made in steps below which an input moves continuously: in the wide gap
/// between the measured 0.32 and 0.93.
const LEAST_IN_STEPS: f64 = 0.6;

/// Changes of the input below which nothing can be said of how it moves: no fit of its
/// dynamics would be determined by so few.
const FEWEST_CHANGES: f64 = 20.0;

/// Longest edge of a step: shorter than the dead time of a hydraulic joint, longer than the
/// 80 ms over which a test bench interpolated its stairs.
const EDGE_S: f64 = 0.1;

/// An edge may take as many samples, however slow the log is.
const EDGE_SAMPLES: usize = 3;

/// Shortest hold: about the shortest reaction of a hydraulic joint, longer than the period of a
/// slow joystick (10 Hz), which holds its samples in a faster log.
const HOLD_S: f64 = 0.15;

/// Fewest samples of a hold: half of the ten that two regression lines need.
const HOLD_SAMPLES: usize = 5;

/// Samples of the longest edge of a step.
pub(super) fn edge_samples(period_s: f64) -> usize {
    in_samples(EDGE_S, period_s).max(EDGE_SAMPLES)
}

impl Property for InputMotion {
    fn find(record: &Record) -> Self {
        let found: Vec<Moved> = record.iter().map(Moved::of).collect();
        let sum = |part: fn(&Moved) -> f64| found.iter().map(part).fold(0.0, |sum, one| sum + one);
        let (samples, travel) = (sum(|one| one.samples).max(1.0), sum(|one| one.travel));
        let in_steps = sum(|one| one.in_steps);
        let moves = travel > 0.0 && sum(|one| one.changes) >= FEWEST_CHANGES;
        Self {
            changes: sum(|one| one.changes) / samples,
            held: sum(|one| one.held) / samples,
            travel_in_steps: moves.then(|| (in_steps / travel).min(1.0)),
        }
    }
}

impl InputMotion {
    /// Of the input of all trials of a joint.
    pub fn of(record: &Record) -> Self {
        *record.property()
    }

    /// Whether it moves all the time, so that its changes are no steps.
    pub fn is_continuous(&self) -> bool {
        self.travel_in_steps.is_some_and(|share| share < LEAST_IN_STEPS)
    }
}

/// Sums over one trial.
struct Moved {
    samples: f64,
    changes: f64,
    held: f64,
    travel: f64,
    in_steps: f64,
}

impl Moved {
    fn of(trial: &Trial) -> Self {
        let (input, period_s) = (trial.input(), trial.period().seconds());
        let Levels { values, tolerance, .. } = Levels::of(input, period_s);
        let shortest = if tolerance == 0.0 && is_drawn_in_time_of_its_own(input) {
            HOLD_SAMPLES
        } else {
            in_samples(HOLD_S, period_s).max(HOLD_SAMPLES)
        };
        let holds = holds(&values, tolerance, shortest);
        let edge = edge_samples(period_s);
        let steps = holds.windows(2).filter_map(|pair| match pair {
            [from, to] if to.start - from.end <= edge => Some((to.first - from.last).abs()),
            _ => None,
        });
        let pairs = input.iter().zip(input.iter().skip(1));
        Self {
            samples: input.len() as f64,
            changes: pairs.filter(|(before, after)| (*before - *after).abs() > 0.0).count() as f64,
            held: holds.iter().map(|hold| (hold.end - hold.start) as f64).sum(),
            travel: travel(&values, tolerance),
            in_steps: steps
                .filter(|step| *step > 2.0 * tolerance)
                .fold(0.0, |sum, step| sum + step),
        }
    }
}

/// Whether levels that are exact are those of an experiment, however short they are: they last
/// differently long, and lie far apart.
///
/// A slow joystick in a faster log has holds of one length, that of its own period, and one whose
/// travel is counted in units has levels that lie beside one another.
fn is_drawn_in_time_of_its_own(input: &[f64]) -> bool {
    /// How far holds of one length are from their median, and the part of them that are so. Of
    /// lengths drawn evenly between one and its double, 0.3 are.
    const ALIKE: f64 = 0.1;
    const MOST_ALIKE: f64 = 0.5;
    /// The least usual step, as a part of the range: of levels drawn evenly it is 0.29.
    const FAR: f64 = 0.1;
    #[expect(clippy::float_cmp, reason = "levels are exact")]
    let runs: Vec<&[f64]> = input.chunk_by(|a, b| a == b).collect();
    let lengths: Vec<f64> = runs.iter().map(|run| run.len() as f64).collect();
    let steps = runs.windows(2).map(|pair| (pair[1][0] - pair[0][0]).abs());
    let steps: Vec<f64> = steps.collect();
    let median = |values: &[f64]| median(values).unwrap_or_default();
    let (usual, (low, high)) = (median(&lengths), limits(input.iter().copied()));
    let alike = lengths.iter().filter(|length| (*length - usual).abs() <= ALIKE * usual).count();
    (alike as f64) < MOST_ALIKE * lengths.len() as f64 && median(&steps) >= FAR * (high - low)
}

/// A level that is held from `start` up to `end`.
///
/// What drifts within the noise is far from its first level when it leaves it, and makes no step.
struct Hold {
    start: usize,
    end: usize,
    /// The level with which it begins and that with which it ends.
    first: f64,
    last: f64,
}

/// Samples that stay within `tolerance` of their middle, `shortest` or more of them, or the first
/// of all.
///
/// Every sample enters and leaves the window once: its extremes stand in front of two queues.
fn holds(input: &[f64], tolerance: f64, shortest: usize) -> Vec<Hold> {
    let (mut holds, mut start) = (Vec::new(), 0);
    let (mut lowest, mut highest) = (VecDeque::new(), VecDeque::new());
    for end in 0..=input.len() {
        while start < end && !fits(input, end, (&lowest, &highest), tolerance) {
            if end - start >= shortest || start == 0 {
                holds.push(hold(input, start..end, shortest));
                lowest.clear();
                highest.clear();
                start = end;
            } else {
                start += 1;
                lowest.pop_front_if(|front: &mut usize| *front < start);
                highest.pop_front_if(|front: &mut usize| *front < start);
            }
        }
        let Some(value) = input.get(end) else { break };
        while lowest.pop_back_if(|back| input[*back] >= *value).is_some() {}
        while highest.pop_back_if(|back| input[*back] <= *value).is_some() {}
        lowest.push_back(end);
        highest.push_back(end);
    }
    holds
}

/// Whether the sample `next` is within `tolerance` of the middle of those of a window with the
/// extremes in front of two queues; nothing is after the last sample.
fn fits(
    input: &[f64],
    next: usize,
    (lowest, highest): (&VecDeque<usize>, &VecDeque<usize>),
    tolerance: f64,
) -> bool {
    let ends = lowest.front().zip(highest.front()).zip(input.get(next));
    ends.is_some_and(|((low, high), next)| {
        input[*high].max(*next) - input[*low].min(*next) <= 2.0 * tolerance
    })
}

/// The samples of `span`, of which so many show the level at either end.
fn hold(input: &[f64], Range { start, end }: Range<usize>, shown_by: usize) -> Hold {
    let level = |samples: &[f64]| samples.iter().sum::<f64>() / samples.len() as f64;
    let shown_by = shown_by.min(end - start);
    let (first, last) =
        (level(&input[start..start + shown_by]), level(&input[end - shown_by..end]));
    Hold { start, end, first, last }
}

/// How far the input goes in all, what is within its noise left out.
fn travel(input: &[f64], tolerance: f64) -> f64 {
    let mut at = input.first().copied().unwrap_or(0.0);
    let mut travel = 0.0;
    for value in input {
        // The shortest way that stays within the noise of every sample.
        let next = at.clamp(value - tolerance, value + tolerance);
        travel += (next - at).abs();
        at = next;
    }
    travel
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

    use super::*;
    use crate::delay::Settings;
    use crate::units::{SamplePeriod, ceil_to_index};

    const LEVELS: [f64; 7] = [0.0, 1.0, -2.0, 0.5, 2.0, -1.0, -0.5];

    fn motion(period_s: f64, input: impl Fn(f64) -> f64) -> InputMotion {
        let input: Vec<f64> =
            (0..ceil_to_index(40.0 / period_s)).map(|k| input(k as f64 * period_s)).collect();
        let (period, output) = (SamplePeriod::from_seconds(period_s).unwrap(), input.clone());
        InputMotion::of(&Record::from([Trial::new("1", 0.0, period, input, output).unwrap()]))
    }

    fn steps(time_s: f64) -> f64 {
        LEVELS[ceil_to_index((time_s / 1.3).floor()) % LEVELS.len()]
    }

    /// Noise of a time, between −½ and ½.
    fn noise(time_s: f64) -> f64 {
        let wild = (time_s * 12_989.8 + 0.3).sin() * 43_758.545;
        wild - wild.floor() - 0.5
    }

    fn joystick(time_s: f64) -> f64 {
        let sum: f64 = [0.13, 0.31, 0.47, 0.7, 1.1].iter().map(|f| (TAU * f * time_s).sin()).sum();
        sum.signum() * (sum.abs() - 1.0).clamp(0.0, 2.0)
    }

    /// The longest run from each start, looked for anew.
    fn holds_one_by_one(input: &[f64], tolerance: f64, shortest: usize) -> Vec<Range<usize>> {
        let (mut found, mut start) = (Vec::new(), 0);
        while start < input.len() {
            let within = |end: &usize| {
                let window = &input[start..*end];
                let low = window.iter().copied().fold(f64::INFINITY, f64::min);
                let high = window.iter().copied().fold(f64::NEG_INFINITY, f64::max);
                high - low <= 2.0 * tolerance
            };
            let end = (start + 1..=input.len()).take_while(within).last().unwrap();
            let is_held = end - start >= shortest || start == 0;
            found.extend(is_held.then_some(start..end));
            start = if is_held { end } else { start + 1 };
        }
        found
    }

    #[test]
    fn holds_are_those_that_are_found_one_by_one() {
        for (tolerance, kinds) in [(0.0, 2.0), (0.5, 4.0), (1.0, 5.0)] {
            for seed in 0..40 {
                let at = |k: i32| (kinds * (noise(f64::from(7 * seed + k)) + 0.5)).floor();
                let input: Vec<f64> = (0..120).map(|k| at(k / (1 + seed % 4))).collect();
                for shortest in [1, 3, 8] {
                    let found = holds(&input, tolerance, shortest);
                    let found: Vec<_> = found.iter().map(|hold| hold.start..hold.end).collect();
                    assert_eq!(found, holds_one_by_one(&input, tolerance, shortest));
                }
            }
        }
    }

    #[test]
    fn steps_stay_steps_at_any_rate_with_noise_dither_and_ramped_edges() {
        for period_s in [0.1, 0.02, 0.01, 0.001] {
            let dither = |t: f64| 0.02 * (t / period_s * 2.1).sin().signum();
            let inputs: [&dyn Fn(f64) -> f64; 4] =
                [&steps, &|t| steps(t) + 0.05 * noise(t), &|t| steps(t) + dither(t), &|t| {
                    let edge = 2.0 * period_s;
                    [0.0, 0.5, 1.0]
                        .iter()
                        .map(|part| steps((t - part * edge).max(0.0)))
                        .sum::<f64>()
                        / 3.0
                }];
            for (number, input) in inputs.iter().enumerate() {
                let found = motion(period_s, input);
                assert!(!found.is_continuous(), "{period_s} {number} {found:?}");
                assert!(found.travel_in_steps.unwrap() > 0.8, "{period_s} {number} {found:?}");
            }
        }
    }

    #[test]
    fn levels_drawn_for_a_fast_joint_are_steps() {
        for shortest in [6.0, 30.0, 100.0] {
            let (mut input, mut drawn) = (Vec::new(), 0.0);
            while input.len() < 4000 {
                drawn += 1.0;
                let length = ceil_to_index(shortest * (1.0 + 2.0 * (noise(drawn) + 0.5)));
                input.extend(std::iter::repeat_n((20.0 * noise(-drawn)).round() / 4.0, length));
            }
            let period = SamplePeriod::from_seconds(0.001).unwrap();
            let trial = Trial::new("1", 0.0, period, input.clone(), input).unwrap();
            let found = InputMotion::of(&Record::from([trial]));
            assert!(!found.is_continuous(), "{shortest} {found:?}");
        }
    }

    #[test]
    fn joysticks_sines_and_ramps_move_continuously() {
        for period_s in [0.1, 0.02, 0.01, 0.001] {
            let slow = |t: f64| joystick((t / 0.05).floor() * 0.05);
            let inputs: [&dyn Fn(f64) -> f64; 5] = [
                &joystick,
                &|t| (TAU * 0.3 * t).sin(),
                &|t| (joystick(t) * 30.0).round() / 30.0,
                &|t| joystick(t) + 0.02 * noise(t),
                &slow,
            ];
            for (number, input) in inputs.iter().enumerate() {
                let found = motion(period_s, input);
                assert!(found.is_continuous(), "{period_s} {number} {found:?}");
                assert!(found.travel_in_steps.unwrap() < 0.4, "{period_s} {number} {found:?}");
            }
        }
    }

    #[test]
    fn single_steps_of_many_trials_are_steps_however_early_they_come() {
        for before in [1, 3, 10] {
            let trial = |number: usize| {
                let input: Vec<f64> = (0..200).map(|k| f64::from(u8::from(k >= before))).collect();
                let period = SamplePeriod::from_seconds(0.01).unwrap();
                Trial::new(number.to_string(), 0.0, period, input.clone(), input).unwrap()
            };
            let found = InputMotion::of(&Record::from((0..30).map(trial).collect::<Vec<_>>()));
            assert_eq!(found.travel_in_steps, Some(1.0), "{before}");
        }
    }

    #[test]
    fn an_input_that_never_moves_is_no_joystick() {
        let found = motion(0.01, |_| 7.5);
        assert!(!found.is_continuous() && found.travel_in_steps.is_none());
        let asked = |input| Settings { input, ..Settings::default() };
        assert!(asked(InputKind::Continuous).takes_as_continuous(&found));
        assert!(!asked(InputKind::Auto).takes_as_continuous(&found));
    }

    #[test]
    fn levels_that_are_exact_have_no_noise() {
        let tolerance = |input: &[f64]| Levels::of(input, 0.01).tolerance;
        assert!(tolerance(&[0.0, 0.0, 1.0, 1.0, 0.0, 0.0, 1.0, 1.0]).abs() < 1e-12);
        let flickers: Vec<f64> =
            (0..100).map(|k| f64::from(k / 50) + 0.01 * f64::from(k % 2)).collect();
        assert!((tolerance(&flickers) - 0.025).abs() < 1e-12);
    }
}
