//! Stops at which the output comes to rest, whatever its input: the ends of its range.
//!
//! A joint that is driven against its stop bends there as much as where it departed, and answers
//! no step of the input.

use std::cmp::Ordering;

use super::hold::level_tolerance;
use super::motion::{StepMotion, arrival};
use super::neutral::Neutral;
use super::prepared::Prepared;
use super::settings::Settings;
use super::steps::{InputStep, hold_ranges, joint_steps};
use super::tracking::tracking;
use crate::experiment::{Property, Record, Trial};
use crate::numerics::{limits, median, noise_of_differences};

/// Holds in which the joint comes to the same end of its range, which show a stop.
const FEWEST: usize = 3;

/// Samples at the end of a hold that stand at a stop.
const STANDING: usize = 6;

/// Parts of the range: how near to its end a stop may be, and how far from the stop the joint
/// counts as there.
const NEAR: f64 = 0.02;
const THERE: f64 = 0.002;

/// The stops of a joint.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Stops {
    low: Option<f64>,
    high: Option<f64>,
    /// How far from a stop the output counts as there, output units.
    tolerance: f64,
}

/// The stops that a record shows; none of an output that comes to rest where its input says.
pub(super) fn stops(record: &Record) -> Option<Stops> {
    *record.property()
}

impl Property for Option<Stops> {
    fn find(record: &Record) -> Self {
        if tracking(record).is_some() {
            return None;
        }
        Stops::of(record, &joint_steps(record, &Settings::default()))
    }
}

impl Stops {
    /// The stops that `trials` with these `steps` show; `None` where there is none.
    fn of<'a>(trials: &'a Record, steps: &[Vec<InputStep>]) -> Option<Self> {
        let of_trial = |(trial, steps): (&'a Trial, &Vec<InputStep>)| -> Vec<(f64, &'a [f64])> {
            let output = trial.output();
            let holds = steps.iter().zip(hold_ranges(steps, output.len()));
            holds.filter_map(|(step, hold)| Some((step.after, output.get(hold)?))).collect()
        };
        let mut holds: Vec<_> = trials.iter().zip(steps).flat_map(of_trial).collect();
        holds.sort_by(|a, b| a.0.total_cmp(&b.0));
        let tolerance = level_tolerance(trials);
        // Between levels that drive it one way and the other a joint is left alone.
        let neutral = Neutral::of(trials).filter(|neutral| {
            let is_on =
                |side: Ordering| holds.iter().any(|(level, _)| neutral.side(*level) == side);
            is_on(Ordering::Less) && is_on(Ordering::Greater)
        });
        let is_neutral = |level: f64| neutral.is_some_and(|it| it.side(level) == Ordering::Equal);
        holds.retain(|(level, _)| !is_neutral(*level));
        let holds = driven(&holds, tolerance);
        let ends = || holds.iter().filter_map(|held| Some((held, end_of(held)?)));
        let (low, high) = limits(ends().filter_map(|(_, end)| median(end)));
        // One that stands there all the time may rest there, where its input moves nothing.
        let arrived_near = |level: f64| -> Vec<f64> {
            let is_near = |y: &f64| (y - level).abs() <= NEAR * (high - low);
            let arrived = ends().filter(|(held, _)| !held.first().is_some_and(is_near));
            arrived
                .filter(|(held, end)| end.iter().all(is_near) && stands(held))
                .filter_map(|(_, end)| median(end))
                .collect()
        };
        let (at_low, at_high) = (arrived_near(low), arrived_near(high));
        if at_low.len().max(at_high.len()) < FEWEST {
            return None;
        }
        let noise = noise_of_differences(trials.iter().map(Trial::output));
        // Of normal noise one sample in 16 000 is beyond four standard deviations.
        let tolerance = (4.0 * noise).max(THERE * (high - low));
        // Ends of holds that are only by chance at the end of the range are apart.
        let stop = |levels: &[f64]| {
            let level = median(levels)?;
            let standing = levels.iter().filter(|y| (*y - level).abs() <= tolerance).count();
            (standing >= FEWEST && 2 * standing > levels.len()).then_some(level)
        };
        let (low, high) = (stop(&at_low), stop(&at_high));
        (low.is_some() || high.is_some()).then_some(Self { low, high, tolerance })
    }

    /// Bounds what says anything of each step of `trial` by arrivals at a stop, where nothing else
    /// is known of it.
    pub(super) fn bound(&self, trial: &mut Prepared<'_>) {
        let samples = trial.raw.len();
        let mut before = None;
        for (motion, hold) in trial.motions.iter_mut().zip(hold_ranges(&trial.steps, samples)) {
            let start = hold.start;
            let arrival = self.arrival(&trial.raw[hold]);
            if motion.is_none() && (arrival.is_some_and(|after| after > 0) || before.is_some()) {
                trial.is_tested = true;
                let until = arrival.filter(|after| *after > 0).map(|after| start + after);
                *motion = Some(Box::new(StepMotion {
                    first: before.unwrap_or(0),
                    latest: until.unwrap_or(samples),
                    end: until.unwrap_or(samples),
                    rest: None,
                }));
            }
            before = match arrival {
                Some(0) => before.or(Some(start)),
                arrival => arrival.map(|after| start + after),
            };
        }
    }

    /// Samples of a hold until its output stands at a stop, where it ends at one.
    fn arrival(&self, held: &[f64]) -> Option<usize> {
        let last = held.len().checked_sub(STANDING)?;
        let at = |stop: f64| {
            Some(arrival(held, stop, self.tolerance)).filter(|arrival| *arrival <= last)
        };
        [self.low, self.high].into_iter().flatten().find_map(at)
    }
}

/// The outputs of `holds`, which are in the order of their levels, without those of levels at which the
/// joint stands at one place and at another: it rests there, and needs no stop to end its motion.
fn driven<'a>(holds: &[(f64, &'a [f64])], same: f64) -> Vec<&'a [f64]> {
    /// The part of a hold, one in so many, in which a joint that rests has come to rest.
    const LAST: usize = 3;
    let (low, high) = limits(holds.iter().flat_map(|(_, held)| held.iter().copied()));
    // Over the last of a hold, whose halves are compared: noise is not motion.
    let rests_at = |held: &'a [f64]| {
        let end = held.get(held.len() - held.len() / LAST..).filter(|end| end.len() >= STANDING)?;
        let (first, second) = end.split_at(end.len() / 2);
        let (from, to) = (median(first)?, median(second)?);
        ((to - from).abs() <= 2.0 * THERE * (high - low)).then_some(to)
    };
    let is_driven = |of_level: &&[(f64, &'a [f64])]| {
        let (least, most) = limits(of_level.iter().filter_map(|(_, held)| rests_at(held)));
        most - least <= NEAR * (high - low)
    };
    let levels = holds.chunk_by(|a, b| b.0 - a.0 <= same).filter(is_driven);
    levels.flatten().map(|(_, held)| *held).collect()
}

/// Whether the output goes no longer at the end of a hold in which it went: of what a hold ends with by
/// chance at the end of the range, it does.
fn stands(held: &[f64]) -> bool {
    /// Parts of a hold in which one goes, and the part of its fastest in which it stands.
    const PARTS: usize = 10;
    const STILL: f64 = 0.25;
    let length = STANDING.max(held.len() / PARTS);
    let way = |part: &[f64]| {
        let (first, second) = part.split_at(part.len() / 2);
        Some((median(second)? - median(first)?).abs())
    };
    let parts = held.rchunks(length).filter(|part| part.len() == length);
    let ways: Vec<f64> = parts.filter_map(way).collect();
    let fastest = ways.iter().copied().fold(0.0, f64::max);
    ways.first().is_some_and(|last| *last <= STILL * fastest)
}

/// The last samples of a hold.
fn end_of<'a>(held: &&'a [f64]) -> Option<&'a [f64]> {
    held.get(held.len().checked_sub(STANDING)?..)
}

#[cfg(test)]
mod tests {
    use super::super::{Decision, Method, Settings, Verdict, estimate};
    use super::*;
    use crate::numerics::testing::noise;
    use crate::units::SamplePeriod;

    /// Samples by which the joint is late.
    const DELAY: usize = 15;

    /// A joint that goes by 0.1 per sample and unit of its input, between −10 and 10.
    fn between_stops(levels: &[f64], hold: usize) -> Trial {
        let input: Vec<f64> =
            levels.iter().flat_map(|level| std::iter::repeat_n(*level, hold)).collect();
        let mut angle = 0.0;
        let late = std::iter::repeat_n(&0.0, DELAY).chain(&input).take(input.len());
        let output: Vec<f64> = late
            .zip(noise(3, 0.0, input.len()))
            .map(|(u, e)| {
                angle = f64::clamp(angle + 0.1 * u, -10.0, 10.0);
                angle + 0.02 * e
            })
            .collect();
        let period = SamplePeriod::from_seconds(0.01).unwrap();
        Trial::new("1", 0.0, period, input, output).unwrap()
    }

    #[test]
    fn the_arrival_at_a_stop_is_no_reaction() {
        let levels = [0.0, 1.5, -1.0, -1.5, 1.0, 2.0, 0.5, -2.0, -0.5, 1.5, 1.0, -1.0, -2.0, 0.0];
        let trial = between_stops(&levels, 120);
        let found = estimate(&trial, &Settings::of(Method::TWO_LINE)).unwrap();
        let accepted = found.decisions.iter().filter(|d| d.verdict() == Verdict::Accepted);
        let delays: Vec<f64> = accepted.filter_map(Decision::delay).collect();
        assert!(delays.len() >= 6, "{delays:?}");
        assert!(delays.iter().all(|delay| (delay - DELAY as f64).abs() <= 8.0), "{delays:?}");
    }

    #[test]
    fn a_joint_that_comes_back_to_the_same_places_shows_none() {
        let levels: Vec<f64> = (0..40).map(|k| [1.0, 0.0, -1.0, 0.0][k % 4]).collect();
        let trial = between_stops(&levels, 90);
        let found = estimate(&trial, &Settings::of(Method::TWO_LINE)).unwrap();
        let delays: Vec<f64> = found.decisions.iter().filter_map(Decision::delay).collect();
        let is_right = |delay: &&f64| (**delay - DELAY as f64).abs() <= 5.0;
        assert!(delays.iter().filter(is_right).count() > 36, "{delays:?}");
    }

    #[test]
    fn a_joint_that_is_switched_off_where_it_began_shows_none() {
        for (speed, hold) in [(1.0, 150), (0.3, 150), (0.3, 300)] {
            let levels: Vec<f64> = (0..42).map(|k| speed * [1.0, -1.0, 0.0][k % 3]).collect();
            let trial = between_stops(&levels, hold);
            let steps = super::super::steps::input_steps(trial.input(), 0.0);
            assert_eq!(Stops::of(&Record::from([trial.clone()]), &[steps]), None, "{speed}");
        }
    }

    #[test]
    fn a_joint_that_turns_before_its_stop_shows_none() {
        let trial = between_stops(&[0.0, 0.5, -0.5, -0.5, 0.5, 0.25, -0.25, 0.0], 100);
        let steps = super::super::steps::input_steps(trial.input(), 0.0);
        assert_eq!(Stops::of(&Record::from([trial.clone()]), &[steps]), None);
    }
}
