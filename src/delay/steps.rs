//! Where the input changes.
//!
//! The paper counts every change of the input. Inputs that were measured have noise, and logs
//! whose inputs were interpolated have edges of a few samples: there, [`trial_steps`] takes an
//! edge for one step and noise for none. An input whose levels are exact and last for three
//! samples or more has the paper's steps.

use std::ops::Range;

use super::input_motion::{InputMotion, edge_samples};
use super::input_noise::Levels;
use super::settings::{FirstLast, Settings};
use crate::experiment::{Property, Record, Trial};

/// A change of the input: sample `p_i` and the levels on both sides.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct InputStep {
    /// First sample with the new level, counted from 1.
    pub sample: usize,
    /// Level before.
    pub before: f64,
    /// Level after.
    pub after: f64,
}

/// All steps of `input`: `p_i` where `u_k ≠ u_(k−1)`.
///
/// With `min_step` above zero (input units) a change counts once the input is more than
/// that away from the level of the last step; it is for inputs that were measured.
pub(crate) fn input_steps(input: &[f64], min_step: f64) -> Vec<InputStep> {
    steps_beyond(min_step, input, 0)
}

/// The steps of more than `min_step`; the level of each shows `reach` samples after its edge.
fn steps_beyond(min_step: f64, input: &[f64], reach: usize) -> Vec<InputStep> {
    let Some(&first) = input.first() else {
        return Vec::new();
    };
    let (mut before, mut known_from) = (first, 1);
    let mut steps = Vec::new();
    for (index, &value) in input.iter().enumerate() {
        if index >= known_from && (value - before).abs() > min_step {
            let after = input.get(index + reach).or(input.last()).copied().unwrap_or(value);
            steps.push(InputStep { sample: index + 1, before, after });
            (before, known_from) = (after, index + reach + 1);
        }
    }
    steps
}

/// From each step to the next, and from the last one to the end: indices of a trial of `samples`.
pub(super) fn hold_ranges(
    steps: &[InputStep],
    samples: usize,
) -> impl Iterator<Item = Range<usize>> + Clone {
    let starts = steps.iter().map(|step| step.sample - 1);
    let ends = starts.clone().skip(1).chain([samples]);
    starts.zip(ends).map(|(start, end)| start..end)
}

/// The steps of each of the `trials` of a joint, as `settings` ask for: none of an input that
/// moves all the time.
pub(crate) fn joint_steps(trials: &Record, settings: &Settings) -> Vec<Vec<InputStep>> {
    if settings.takes_as_continuous(&InputMotion::of(trials)) {
        return trials.iter().map(|_| Vec::new()).collect();
    }
    trials.iter().map(|trial| trial_steps(trial, settings)).collect()
}

/// The steps of a trial whose input is made of steps: noise of the input is no step, and an
/// edge over a few samples is one, which begins where the edge begins.
pub(super) fn trial_steps(trial: &Trial, settings: &Settings) -> Vec<InputStep> {
    let input = trial.input();
    if settings.paper || settings.grows {
        return input_steps(input, settings.min_step);
    }
    let longest = edge_samples(trial.period().seconds());
    if settings.min_step > 0.0 {
        return with_edges_merged(input_steps(input, settings.min_step), longest, longest);
    }
    let levels = Levels::of(input, trial.period().seconds());
    let steps = steps_beyond(levels.tolerance, &levels.values, levels.reach);
    // Levels that are exact were commanded, and after no filter.
    let tail = if levels.tolerance > 0.0 { longest } else { 0 };
    with_edges_merged(steps, longest, tail)
}

/// Part of the largest step below which one is no step, where the input was interpolated: such
/// an input has bumps that are put back over a few samples.
const SMALLEST_PART: f64 = 0.01;

/// `steps` with those of one edge merged: the same direction, at most `longest` samples from
/// the first to the last, and no level between them that lasts; and its tail, parts of which are no more
/// than `tail` samples apart.
fn with_edges_merged(steps: Vec<InputStep>, longest: usize, tail: usize) -> Vec<InputStep> {
    /// A level that is part of an edge lasts at most so many samples: one of a slower clock,
    /// seen at twice its rate.
    const LASTS: usize = 2;
    /// Parts of an edge that its tail goes on by at most: an input that was measured after a filter
    /// comes to its level ever more slowly.
    const TAIL: f64 = 0.25;
    let rises = |step: &InputStep| step.after > step.before;
    let size = |step: &InputStep| (step.after - step.before).abs();
    let is_tail = |edge: &InputStep, step: &InputStep, since: usize| {
        since <= tail && size(step) <= TAIL * size(edge) && step.sample - edge.sample <= 3 * longest
    };
    let found = steps.len();
    let mut merged: Vec<InputStep> = Vec::new();
    let mut last = 0;
    for step in steps {
        match merged.last_mut() {
            Some(edge)
                if rises(edge) == rises(&step)
                    && (step.sample - last <= LASTS && step.sample - edge.sample <= longest
                        || is_tail(edge, &step, step.sample - last)) =>
            {
                edge.after = step.after;
            }
            _ => merged.push(step),
        }
        last = step.sample;
    }
    if merged.len() < found {
        let largest = merged.iter().map(size).fold(0.0, f64::max);
        merged.retain(|step| size(step) >= SMALLEST_PART * largest);
    }
    merged
}

/// Trials with a step from which a joint is known to be driven in strokes.
const FEWEST_STROKES: usize = 3;

/// Whether the trials of a joint are strokes.
struct Strokes(bool);

impl Property for Strokes {
    fn find(record: &Record) -> Self {
        let changes = |trial: &Trial| input_steps(trial.input(), 0.0).len();
        let changes: Vec<usize> = record.iter().map(changes).collect();
        let driven = changes.iter().filter(|changes| **changes > 0).count();
        let are_few = changes.iter().all(|changes| FirstLast::Auto.are_judged(*changes));
        Self(driven >= FEWEST_STROKES && are_few)
    }
}

/// Whether the trials of a joint are strokes: each has so few changes of the input that its first
/// and last step are judged, see [`FirstLast::Auto`], and several have any.
pub(crate) fn are_strokes(record: &Record) -> bool {
    record.property::<Strokes>().0
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::delay::Method;
    use crate::units::SamplePeriod;

    fn steps(period_s: f64, input: &[f64]) -> Vec<(usize, f64, f64)> {
        let period = SamplePeriod::from_seconds(period_s).unwrap();
        let trial = Trial::new("1", 0.0, period, input.to_vec(), input.to_vec()).unwrap();
        let found = trial_steps(&trial, &Settings::of(Method::TWO_LINE));
        found.iter().map(|step| (step.sample, step.before, step.after)).collect()
    }

    #[test]
    fn an_edge_over_a_few_samples_is_one_step_from_its_start() {
        let stairs = [0.0, 0.0, 0.0, 0.2, 0.7, 1.0, 1.0, 1.0, 1.0, 1.6, 1.6, 2.0, 2.0, 2.0];
        assert_eq!(steps(0.02, &stairs), [(4, 0.0, 1.0), (10, 1.0, 2.0)]);
        let ramp: Vec<f64> = (0..30).map(|k| f64::from((k - 5).clamp(0, 20))).collect();
        assert!(steps(0.02, &ramp).len() > 1, "a ramp of 0.4 s is no edge");
    }

    #[test]
    fn the_tail_of_an_edge_behind_a_filter_is_part_of_it() {
        for constant in [1.0, 2.0, 3.0] {
            let left = f64::exp(-1.0 / constant);
            let mut shown = 0.0;
            let filtered = (0..800).map(|k| {
                let level = [0.0, 1.0, -0.5, 0.5][k / 150 % 4];
                shown = level + (shown - level) * left;
                let noise = 0.002 * ((k as f64 * 12.9898).sin() * 43_758.545).fract();
                shown + noise
            });
            let found = steps(0.01, &filtered.collect::<Vec<_>>());
            let samples: Vec<usize> = found.iter().map(|step| step.0).collect();
            assert_eq!(samples, [151, 301, 451, 601, 751], "{constant}: {found:?}");
        }
    }

    #[test]
    fn levels_of_three_samples_are_the_papers_steps() {
        let input = [0.0, 0.0, 0.0, 1.0, 1.0, 1.0, 2.0, 2.0, 2.0, 0.5, 0.5, 0.5];
        let found: Vec<_> = input_steps(&input, 0.0)
            .iter()
            .map(|step| (step.sample, step.before, step.after))
            .collect();
        assert_eq!(steps(0.01, &input), found);
        assert_eq!(found.len(), 3);
    }

    #[test]
    fn a_pulse_goes_both_ways() {
        let pulse = [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0];
        assert_eq!(steps(0.01, &pulse), [(4, 0.0, 1.0), (5, 1.0, 0.0)]);
    }

    #[test]
    fn noise_is_no_step() {
        let wild = |k: f64| (k * 12.9898 + 0.3).sin() * 43_758.545;
        let noise = |k: u32| wild(f64::from(k)).fract() - 0.5;
        let noisy: Vec<f64> = (0..200).map(|k| f64::from(k / 50) + 0.02 * noise(k)).collect();
        let found = steps(0.01, &noisy);
        assert_eq!(found.iter().map(|(sample, ..)| *sample).collect::<Vec<_>>(), [51, 101, 151]);
    }

    #[test]
    fn a_step_is_the_first_sample_of_a_new_level() {
        let steps = input_steps(&[0.0, 0.0, 1.0, 1.0, -1.0], 0.0);
        let expected = [(3, 0.0, 1.0), (5, 1.0, -1.0)].map(|(sample, before, after)| InputStep {
            sample,
            before,
            after,
        });
        assert_eq!(steps, expected);
    }

    #[test]
    fn a_constant_input_has_no_step() {
        assert_eq!(input_steps(&[0.5; 9], 0.0), []);
        assert_eq!(input_steps(&[], 0.0), []);
    }

    #[test]
    fn noise_below_the_smallest_step_is_none() {
        let steps = input_steps(&[0.0, 0.01, -0.01, 1.0, 1.01, 0.99], 0.1);
        assert_eq!(steps.len(), 1);
        assert_eq!(steps[0].sample, 4);
    }
}
