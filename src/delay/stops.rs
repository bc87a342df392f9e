//! Stops at which the output comes to rest, whatever its input: the ends of its range.
//!
//! A joint that is driven against its stop bends there as much as where it departed, and answers
//! no step of the input.

use super::motion::StepMotion;
use super::prepared::Prepared;
use super::steps::InputStep;
use crate::experiment::Trial;
use crate::numerics::{median, robust_scale};

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

impl Stops {
    /// The stops that `trials` with these `steps` show; `None` where there is none.
    pub(super) fn of(trials: &[Trial], steps: &[Vec<InputStep>]) -> Option<Self> {
        let held: Vec<&[f64]> = trials.iter().zip(steps).flat_map(holds).collect();
        let last = |held: &&[f64]| median(held.get(held.len().checked_sub(STANDING)?..)?);
        let (low, high) = held
            .iter()
            .filter_map(last)
            .fold((f64::MAX, f64::MIN), |(low, high), y| (low.min(y), high.max(y)));
        let near = |end: f64| {
            let is_near = |y: &f64| (y - end).abs() <= NEAR * (high - low);
            // One that stands there all the time may rest there, where its input moves nothing.
            let moved = held.iter().filter(|held| !held.first().is_some_and(is_near));
            let standing = |held: &&[f64]| {
                let last = held.get(held.len().checked_sub(STANDING)?..)?;
                median(last).filter(|_| last.iter().all(is_near))
            };
            let levels: Vec<f64> = moved.filter_map(standing).collect();
            (levels.len() >= FEWEST).then_some(levels)
        };
        let (at_low, at_high) = (near(low), near(high));
        if at_low.is_none() && at_high.is_none() {
            return None;
        }
        let differences = trials.iter().flat_map(|trial| trial.output().windows(2));
        let differences: Vec<f64> = differences.map(|pair| pair[1] - pair[0]).collect();
        let noise = robust_scale(&differences) / std::f64::consts::SQRT_2;
        let tolerance = (4.0 * noise).max(THERE * (high - low));
        // Ends of holds that are only by chance at the end of the range are apart.
        let stop = |levels: Option<Vec<f64>>| {
            let levels = levels?;
            let level = median(&levels)?;
            let standing = levels.iter().filter(|y| (*y - level).abs() <= tolerance).count();
            (standing >= FEWEST && 2 * standing > levels.len()).then_some(level)
        };
        let (low, high) = (stop(at_low), stop(at_high));
        (low.is_some() || high.is_some()).then_some(Self { low, high, tolerance })
    }

    /// Bounds what says anything of each step of `trial` by arrivals at a stop, where nothing else
    /// is known of it.
    pub(super) fn bound(&self, trial: &mut Prepared<'_>) {
        let samples = trial.raw.len();
        let starts: Vec<usize> = trial.steps.iter().map(|step| step.sample - 1).collect();
        let ends = starts.iter().skip(1).copied().chain([samples]);
        let mut before = None;
        for (motion, (&start, end)) in trial.motions.iter_mut().zip(starts.iter().zip(ends)) {
            let arrival = self.arrival(trial.raw.get(start..end).unwrap_or_default());
            if motion.is_none() && (arrival.is_some_and(|after| after > 0) || before.is_some()) {
                trial.is_tested = true;
                let until = arrival.filter(|after| *after > 0).map(|after| start + after);
                *motion = Some(StepMotion {
                    first: before.unwrap_or(0),
                    latest: until.unwrap_or(samples),
                    end: until.unwrap_or(samples),
                    rest: None,
                });
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
            let is_off = |y: &f64| (y - stop).abs() > self.tolerance;
            let arrival = held.iter().rposition(is_off).map_or(0, |off| off + 1);
            (arrival <= last).then_some(arrival)
        };
        [self.low, self.high].into_iter().flatten().find_map(at)
    }
}

/// The output of each hold.
fn holds<'a>((trial, steps): (&'a Trial, &Vec<InputStep>)) -> Vec<&'a [f64]> {
    let starts = || steps.iter().map(|step| step.sample - 1);
    let ends = starts().skip(1).chain([trial.output().len()]);
    starts().zip(ends).filter_map(|(start, end)| trial.output().get(start..end)).collect()
}

#[cfg(test)]
mod tests {
    use super::super::{Decision, Settings, Verdict, estimate};
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
        let found = estimate(&trial, &Settings::default()).unwrap();
        let accepted = found.decisions.iter().filter(|d| d.verdict() == Verdict::Accepted);
        let delays: Vec<f64> = accepted.filter_map(Decision::delay).collect();
        assert!(delays.len() >= 6, "{delays:?}");
        assert!(delays.iter().all(|delay| (delay - DELAY as f64).abs() <= 8.0), "{delays:?}");
    }

    #[test]
    fn a_joint_that_turns_before_its_stop_shows_none() {
        let trial = between_stops(&[0.0, 0.5, -0.5, -0.5, 0.5, 0.25, -0.25, 0.0], 100);
        let steps = super::super::steps::input_steps(trial.input(), 0.0);
        assert_eq!(Stops::of(std::slice::from_ref(&trial), &[steps]), None);
    }
}
