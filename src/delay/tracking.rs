//! Outputs that come to rest where their input says: the position of a servo after the limit of
//! its rate.
//!
//! After its dead time such an output goes to `y = a + b·u` and stays there. Its arrival bends it
//! as much as its departure does, and is no reaction to a step of the input. What says anything of a step
//! lies between the arrival of the step before and its own.

use std::ops::Range;

use super::motion::{StepMotion, arrival};
use super::prepared::Prepared;
use super::settings::Settings;
use super::steps::{InputStep, hold_ranges, joint_steps};
use crate::experiment::{Property, Record, Trial};
use crate::numerics::{PairSums, limits, noise_of_differences};

/// Levels of the input, and holds at whose end the output rests, that show a relation.
const FEWEST_LEVELS: usize = 3;
const FEWEST_RESTS: usize = 6;

/// Part of the holds that end at rest, at least.
const RESTING: f64 = 0.2;

/// Part of the output's travel by which its rests may be off the line, as a standard deviation.
const OFF: f64 = 0.02;

/// Where the output comes to rest: at `offset + gain · input`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tracking {
    offset: f64,
    gain: f64,
    /// How far from there it counts as arrived, output units.
    tolerance: f64,
    r_squared: f64,
}

/// Where the outputs of a joint come to rest, where its input says that.
pub(crate) fn tracking(record: &Record) -> Option<Tracking> {
    *record.property()
}

impl Property for Option<Tracking> {
    fn find(record: &Record) -> Self {
        Tracking::of(record, &joint_steps(record, &Settings::default()))
    }
}

impl Tracking {
    /// The output at rest while the input is zero, output units; 0 where it is nearer to that than
    /// is known.
    pub fn offset(&self) -> f64 {
        if self.offset.abs() < self.tolerance { 0.0 } else { self.offset }
    }

    /// How much farther it rests for one more of the input, output units per input unit.
    pub fn gain(&self) -> f64 {
        self.gain
    }

    /// The squared correlation of where it rests with the input.
    pub(crate) fn r_squared(&self) -> f64 {
        self.r_squared
    }

    /// The relation between where the output rests and the level that is held, over all `trials`
    /// with their `steps`; `None` where there is none.
    fn of(trials: &[Trial], steps: &[Vec<InputStep>]) -> Option<Self> {
        let holds = steps.iter().map(Vec::len).sum::<usize>();
        let (low, high) = limits(trials.iter().flat_map(Trial::output).copied());
        let range = high - low;
        let of_trial =
            |(trial, steps): (&Trial, &Vec<InputStep>)| resting_holds(trial.output(), steps, range);
        let rests: Vec<(f64, f64)> = trials.iter().zip(steps).flat_map(of_trial).collect();
        let mut levels: Vec<f64> = rests.iter().map(|(level, _)| *level).collect();
        levels.sort_by(f64::total_cmp);
        levels.dedup();
        let enough = rests.len() >= FEWEST_RESTS && rests.len() as f64 >= RESTING * holds as f64;
        if !enough || levels.len() < FEWEST_LEVELS {
            return None;
        }
        Self::through(&rests, noise_of_differences(trials.iter().map(Trial::output)))
    }

    /// The regression line of where the output rests, if it is near to it.
    fn through(rests: &[(f64, f64)], noise: f64) -> Option<Self> {
        let sums = PairSums::of(rests.iter().copied());
        let ((gain, offset), r_squared) = (sums.line(), sums.r_squared());
        // Two parameters: n − 2 degrees of freedom.
        let off = (sums.sse() / (rests.len() as f64 - 2.0)).sqrt();
        let (low, high) = limits(rests.iter().map(|(_, output)| *output));
        let travel = high - low;
        let tolerance = (3.0 * off).max(4.0 * noise).max(0.005 * travel);
        let is_near = gain.is_finite() && gain != 0.0 && off <= OFF * travel;
        is_near.then_some(Self { offset, gain, tolerance, r_squared })
    }

    /// Bounds what says anything of each step of `trial`, where nothing else is known of it.
    pub(super) fn bound(&self, trial: &mut Prepared<'_>, settings: &Settings) {
        let mut arrived = 0;
        let mut previous = trial.steps.first().map_or(0.0, |step| self.rest_at(step.before));
        let ranges = hold_ranges(&trial.steps, trial.raw.len());
        for ((step, motion), range) in trial.steps.iter().zip(&mut trial.motions).zip(ranges) {
            let start = range.start;
            let hold = Hold {
                output: &trial.raw[range],
                previous,
                target: self.rest_at(step.after),
                tolerance: self.tolerance,
            };
            if motion.is_none() {
                *motion = hold.motion(start, arrived, settings).map(Box::new);
            }
            arrived = hold.arrival().map_or(arrived, |arrival| start + arrival);
            previous = hold.target;
        }
        trial.is_tested = true;
    }

    fn rest_at(&self, level: f64) -> f64 {
        self.offset + self.gain * level
    }
}

/// The output while the input is held.
struct Hold<'a> {
    output: &'a [f64],
    /// Where it was going to before.
    previous: f64,
    /// Where it goes to.
    target: f64,
    tolerance: f64,
}

impl Hold<'_> {
    /// Samples until the output has arrived for good.
    fn arrival(&self) -> Option<usize> {
        let arrival = arrival(self.output, self.target, self.tolerance);
        (arrival < self.output.len()).then_some(arrival)
    }

    /// What bounds the reaction to a step at the index `start`, before which the output had
    /// `arrived`.
    fn motion(&self, start: usize, arrived: usize, settings: &Settings) -> Option<StepMotion> {
        /// Parts of the way by which it has plainly departed, and from which it may slow down.
        const DEPARTED: f64 = 0.2;
        const SLOWS: f64 = 0.8;
        let from = *self.output.first()?;
        let way = self.target - self.previous;
        if way.abs() <= 2.0 * self.tolerance {
            return None;
        }
        let rested = (from - self.previous).abs() <= self.tolerance;
        let slow = ((1.0 - SLOWS) * way.abs()).max(self.tolerance);
        let slows = start + arrival(self.output, self.target, slow);
        let (latest, end) = if rested {
            let is_away = |y: &f64| (y - from) / way >= DEPARTED;
            let latest = start + self.output.iter().position(is_away)?;
            (latest, slows.max(latest + settings.beta.max(settings.alpha / 2)))
        } else {
            (slows, slows)
        };
        Some(StepMotion { first: arrived, latest, end, rest: None })
    }
}

/// The level of each hold at whose end `output` rests, and where; `range` is that of the whole
/// record.
fn resting_holds(output: &[f64], steps: &[InputStep], range: f64) -> Vec<(f64, f64)> {
    /// Part of a hold at its end, and samples of it at least, over which the output rests, and
    /// part of the range by which it may move meanwhile.
    const PARTS: usize = 5;
    const FEWEST: usize = 6;
    const STILL: f64 = 0.01;
    let resting = |(step, hold): (&InputStep, Range<usize>)| {
        let samples = (hold.len() / PARTS).max(FEWEST);
        let tail = output.get(hold.end.checked_sub(samples)?.max(hold.start)..hold.end)?;
        if tail.len() < samples {
            return None;
        }
        let (first, last) = tail.split_at(tail.len() / 2);
        let mean = |values: &[f64]| values.iter().sum::<f64>() / values.len().max(1) as f64;
        let rests = (mean(last) - mean(first)).abs() <= STILL * range;
        rests.then(|| (step.after, mean(tail)))
    };
    steps.iter().zip(hold_ranges(steps, output.len())).filter_map(resting).collect()
}

#[cfg(test)]
mod tests {
    use super::super::estimate;
    use super::*;
    use crate::delay::Method;
    use crate::units::SamplePeriod;

    #[test]
    fn what_integrates_does_not_track() {
        let levels = [0.0, 2.0, -1.0, 1.0, -2.0, 0.0, 1.0, -1.0, 2.0, 0.0, -2.0, 1.0];
        let input: Vec<f64> =
            levels.iter().flat_map(|level| std::iter::repeat_n(*level, 60)).collect();
        let mut angle = 0.0;
        let late = std::iter::repeat_n(&0.0, 12).chain(&input).take(input.len());
        let output: Vec<f64> = late
            .map(|u| {
                angle = f64::clamp(angle + 0.02 * u, -1.5, 1.5);
                angle
            })
            .collect();
        let period = SamplePeriod::from_seconds(0.02).unwrap();
        let trial = Trial::new("1", 0.0, period, input, output).unwrap();
        assert_eq!(estimate(&trial, &Settings::of(Method::TWO_LINE)).unwrap().tracking, None);
    }
}
