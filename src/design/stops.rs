//! Where a joint stands at its stops, which remove whatever a prediction was off before.

use crate::experiment::{Joint, Trial};
use crate::fit::follows_input;
use crate::numerics::limits;

/// Samples of the shortest free run that counts.
pub(super) const SHORTEST_RUN: usize = 20;

/// The stops of a joint, as its log shows them: places at which it stands although its input would
/// move it.
pub(super) struct Stops {
    places: Vec<f64>,
    /// Width of all that the joint went through, output units.
    width: f64,
}

/// A place is as near to a stop as to be at it, in parts of what the joint went through.
const NEAR: f64 = 0.02;

/// A joint that moves by less than this part of what it went through within the time before, and
/// within that after, stands.
const STANDS: f64 = 0.01;
const TIME_S: f64 = 0.25;

impl Stops {
    /// The stops that `joint` came to; none where its output regulates itself, and stands at every
    /// level of its input.
    pub(super) fn of(joint: &Joint) -> Self {
        /// Part of the largest input from which one moves a joint that is free.
        const MOVES: f64 = 0.5;
        let (low, high) = limits(joint.trials.iter().flat_map(Trial::output).copied());
        let mut stops = Self { places: Vec::new(), width: high - low };
        if follows_input(joint).is_some() {
            return stops;
        }
        let inputs = joint.trials.iter().flat_map(Trial::input);
        let largest = inputs.fold(0.0, |largest: f64, u| largest.max(u.abs()));
        for trial in &joint.trials {
            let (low, high) = limits(trial.output().iter().copied());
            let standing = stops.standing(trial);
            let both = trial.input().iter().zip(trial.output()).zip(standing);
            for ((input, output), stands) in both {
                let is_end =
                    output - low < NEAR * stops.width || high - output < NEAR * stops.width;
                let is_stop = stands && is_end && input.abs() >= MOVES * largest;
                if is_stop && !stops.is_near(*output) {
                    stops.places.push(*output);
                }
            }
        }
        stops
    }

    /// Whether the joint came to none.
    pub(super) fn are_none(&self) -> bool {
        self.places.is_empty()
    }

    /// Parts of the samples `from..to` of `trial` in which the joint is free: each from where what
    /// leads it away from a stop begins to act, `delay_s` after it is played, to where it comes
    /// near one, be it that it touches it for too short a time to be seen to stand.
    pub(super) fn free(
        &self,
        trial: &Trial,
        (from, to): (usize, usize),
        delay_s: f64,
    ) -> Vec<(usize, usize)> {
        let output = trial.output();
        let is_at_stop = |sample: usize| output.get(sample).is_some_and(|y| self.is_near(*y));
        let delay = samples_of(delay_s, trial);
        let (mut found, mut sample, mut arrived) = (Vec::new(), from, from);
        while sample < to {
            let end = (sample..to).find(|k| is_at_stop(*k)).unwrap_or(to);
            let begin = match played_before(trial, sample, from) {
                Some(played) if sample > from => (played + delay).clamp(arrived, sample),
                _ => sample,
            };
            if end >= begin + SHORTEST_RUN {
                found.push((begin, end));
            }
            arrived = end;
            sample = (end..to).find(|k| !is_at_stop(*k)).unwrap_or(to);
        }
        found
    }

    fn is_near(&self, output: f64) -> bool {
        self.places.iter().any(|place| (output - place).abs() < NEAR * self.width)
    }

    /// Whether the joint stands, at each sample.
    fn standing(&self, trial: &Trial) -> Vec<bool> {
        let near = samples_of(TIME_S, trial);
        let last = trial.len().saturating_sub(1);
        let at = |sample: usize| trial.output().get(sample.min(last)).copied().unwrap_or(0.0);
        // Where it turns it is as far off before as after.
        let moved = |sample: usize| {
            let (before, behind) = (at(sample.saturating_sub(near)), at(sample + near));
            (at(sample) - before).abs().max((behind - at(sample)).abs())
        };
        (0..trial.len()).map(|sample| moved(sample) < STANDS * self.width).collect()
    }
}

fn samples_of(seconds: f64, trial: &Trial) -> usize {
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "at least 0")]
    let samples = (seconds / trial.period().seconds()).round().max(0.0) as usize;
    samples
}

/// The last sample up to `sample`, but not before `from`, at which the input changes.
fn played_before(trial: &Trial, sample: usize, from: usize) -> Option<usize> {
    let input = trial.input();
    let changes = |k: &usize| *k > 0 && input.get(*k) != input.get(k - 1);
    (from..=sample).rev().find(changes)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::units::SamplePeriod;

    /// One second of rest, `level` for 7 s, and rest again, from one stop to the other: 20 units a
    /// second, 0.1 s late.
    fn stroke(level: f64) -> Trial {
        let start = if level > 0.0 { 0.0 } else { 60.0 };
        driven(start, |k| if (50..400).contains(&k) { level } else { 0.0 })
    }

    /// Nine seconds between the stops from `start` on.
    fn driven(start: f64, level: impl Fn(usize) -> f64) -> Trial {
        let input: Vec<f64> = (0..450).map(level).collect();
        let mut y: f64 = start;
        let output = (0..450_usize).map(|k| {
            let now = y;
            y = (y + 0.4 * input[k.saturating_sub(5)]).clamp(0.0, 60.0);
            now
        });
        let output = output.collect();
        let period = SamplePeriod::from_seconds(0.02).unwrap();
        Trial::new("1", 0.0, period, input, output).unwrap()
    }

    fn joint(trials: Vec<Trial>) -> Joint {
        let (name, covariates) = ("boom".to_owned(), Vec::new());
        Joint { name, input_unit: None, output_unit: None, covariates, trials: trials.into() }
    }

    #[test]
    fn a_joint_is_free_from_where_its_input_acts_to_where_it_stops() {
        let joint = joint(vec![stroke(1.0), stroke(-1.0)]);
        let stops = Stops::of(&joint);
        for trial in &joint.trials {
            let free = stops.free(trial, (0, trial.len()), 0.1);
            let [(from, to)] = free.as_slice() else { panic!("{free:?}") };
            // Played at sample 50, seen to move from 56 on, and at the stop from 205 on.
            assert!((50..=60).contains(from) && (190..=209).contains(to), "{from} to {to}");
        }
    }

    #[test]
    fn a_touch_of_a_stop_ends_a_motion_though_the_joint_does_not_stand_there() {
        // It is turned round as it arrives: on the stop for some 0.1 s.
        let touching = |sample: usize| match sample {
            50..205 => 1.0,
            205..300 => -1.0,
            _ => 0.0,
        };
        let touching = driven(0.0, touching);
        let joint = joint(vec![stroke(1.0), stroke(-1.0), touching]);
        let free = Stops::of(&joint).free(&joint.trials[2], (0, 450), 0.1);
        let [(_, arrived), (left, end)] = free.as_slice() else { panic!("{free:?}") };
        assert!((190..=206).contains(arrived) && (205..=214).contains(left), "{free:?}");
        assert_eq!(*end, 450);
    }

    #[test]
    fn a_joint_that_comes_to_no_stop_is_free_all_the_time() {
        let input: Vec<f64> = (0..450).map(|k| if k % 150 < 60 { 1.0 } else { 0.0 }).collect();
        let period = SamplePeriod::from_seconds(0.02).unwrap();
        let output = input.iter().scan(0.0, |y, u| {
            *y += 0.4 * u;
            Some(*y)
        });
        let output: Vec<f64> = output.collect();
        let trial = Trial::new("1", 0.0, period, input, output).unwrap();
        let joint = joint(vec![trial]);
        assert_eq!(Stops::of(&joint).free(&joint.trials[0], (10, 450), 0.1), [(10, 450)]);
    }
}
