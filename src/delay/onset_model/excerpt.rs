//! What of a joint's record is searched: its runs, how far about each onset they are looked at, and how
//! many of their samples.

use super::residual::sensor_noise;
use super::search::{FEW, Search};
use super::shape::Family;
use super::windows::{Run, Step};
use crate::delay::motion::StepMotion;
use crate::delay::neutral::{Neutral, Transition};
use crate::delay::prepared::Prepared;
use crate::delay::steps::InputStep;
use crate::numerics::{limits, median};
use crate::units::{SamplePeriod, ceil_to_index, floor_to_index};

/// What is looked at to each side of an onset, in holds and in samples. Of a record with few steps,
/// as a bump test, more.
const REACH: f64 = 1.5;
const REACHES: (f64, f64) = (60.0, 750.0);
const REACH_OF_FEW: f64 = 2000.0;
const LEAST_REACH: f64 = 16.0;

/// Rounding of sums over windows, in parts of an output's range; and where fits to windows end, whose states
/// have a prior of `1e-11` of the information on them.
const ROUNDING: f64 = 1e-7;
const END: f64 = 1e-5;

/// Part of the noise that is left where a fit is too good.
const FLOOR: f64 = 0.1;

/// Where the runs of a joint are from.
pub(super) struct Origin {
    pub(super) period: SamplePeriod,
    pub(super) neutral: Option<Neutral>,
    pub(super) families: &'static [Family],
}

impl Search {
    /// Samples to each side of an onset that are looked at at most.
    pub(super) fn longest_reach(&self) -> f64 {
        if self.has_few_steps() { REACH_OF_FEW } else { REACHES.1 }
    }

    /// Every so many samples of runs, about a part of the reach.
    pub(super) fn of(
        mut runs: Vec<Run>,
        (every, part): (usize, f64),
        families: &'static [Family],
    ) -> Option<Self> {
        if every > 1 {
            runs = runs.iter().map(|run| thinned(run, every)).collect();
        }
        let hold = median(&runs.iter().flat_map(holds).collect::<Vec<f64>>())?;
        let outputs = runs.iter().map(|run| run.output.as_slice());
        let (low, high) = limits(outputs.clone().flatten().copied());
        // An output that was computed has no noise but its rounding.
        let noise = sensor_noise(&outputs).max(ROUNDING * (high - low));
        let changes = runs.iter().flat_map(|run| &run.steps).map(|step| step.change().abs());
        let change = median(&changes.collect::<Vec<f64>>())?;
        let floor = (FLOOR * noise).max(END * (high - low)).max(f64::MIN_POSITIVE.sqrt());
        let mut search = Self { runs, reach: 0, noise, floor, hold, change, families };
        search.reach = reach_of(hold, 1, part, search.longest_reach());
        Some(search)
    }
}

/// Samples to each side of an onset that are looked at, where every so many of a hold are.
pub(super) fn reach_of(hold: f64, every: usize, part: f64, most: f64) -> usize {
    let (least, _) = REACHES;
    let reach = (REACH * hold / every as f64).clamp(least, most) * part;
    ceil_to_index(reach.max(LEAST_REACH)) * every
}

/// Samples from each step to the next.
pub(super) fn holds(run: &Run) -> Vec<f64> {
    let ends = run.steps.iter().skip(1).map(|step| step.at).chain([run.output.len() as f64]);
    run.steps.iter().zip(ends).map(|(step, end)| end - step.at).collect()
}

/// Every so many samples of a run.
fn thinned(run: &Run, every: usize) -> Run {
    let factor = every as f64;
    let step = |step: &Step| Step {
        at: step.at / factor,
        first: step.first / factor,
        end: step.end / factor,
        latest: step.latest / factor,
        ..*step
    };
    Run {
        output: run.output.iter().step_by(every).copied().collect(),
        steps: run.steps.iter().map(step).collect(),
        is_window: false,
    }
}

/// The first runs of so many samples together, the last of them up to one of its steps.
pub(super) fn beginning(runs: &[Run], enough: usize) -> Vec<Run> {
    /// Steps of a run that is cut.
    const FEWEST: usize = 2;
    let mut left = enough as f64;
    let mut taken = Vec::new();
    for run in runs {
        if left <= 0.0 {
            break;
        }
        let within = run.steps.iter().filter(|step| step.at < left).count();
        let steps = within.max(FEWEST).min(run.steps.len());
        let end = run.steps.get(steps).map_or(run.output.len(), |step| floor_to_index(step.at));
        let (output, steps) = (run.output[..end].to_vec(), run.steps[..steps].to_vec());
        taken.push(Run { output, steps, is_window: false });
        left -= end as f64;
    }
    taken
}

/// A trial as it is fitted: its output as it was measured, and its steps with what bounds the reaction to
/// each.
pub(super) fn run_of(trial: &Prepared<'_>, longest: Option<usize>, origin: &Origin) -> Run {
    let samples = trial.raw.len();
    // A bump test of an output that settles is its way to a level.
    let is_bounded = trial.steps.len() > FEW || !origin.families.contains(&Family::Settling);
    let step = |(step, motion): (&InputStep, &Option<Box<StepMotion>>)| {
        let at = step.sample - 1;
        // What was filled in while nothing was logged says nothing.
        let before = trial.unlogged.iter().rev().find(|gap| gap.end <= at);
        let behind = trial.unlogged.iter().find(|gap| gap.start > at);
        let bounds = motion.as_ref().filter(|_| is_bounded);
        let first = before.map_or(0, |gap| gap.end).max(bounds.map_or(0, |it| it.first));
        let end = behind.map_or(samples, |gap| gap.start);
        let end = end.min(bounds.map_or(samples, |it| it.end));
        let asked = longest.map_or(usize::MAX, |longest| at.saturating_add(longest));
        let latest = motion.as_ref().map_or(samples, |motion| motion.latest).min(asked);
        Step {
            kind: Transition::of(step, origin.neutral.as_ref()),
            at: at as f64,
            before: step.before,
            after: step.after,
            first: first as f64,
            end: end as f64,
            latest: latest as f64,
            rests: motion.as_ref().and_then(|motion| motion.rest).is_some_and(|rest| rest.lasts()),
        }
    };
    let steps = trial.steps.iter().zip(&trial.motions).map(step).collect();
    Run { output: trial.raw.to_vec(), steps, is_window: false }
}
