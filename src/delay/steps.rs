//! Where the input changes.
//!
//! The paper counts every change of the input. Inputs that were measured have noise, and logs
//! whose inputs were interpolated have edges of a few samples: there, [`trial_steps`] takes an
//! edge for one step and noise for none. An input whose levels are exact and last for three
//! samples or more has the paper's steps.

use std::ops::Range;

use super::input_motion::{edge_samples, tolerance};
use super::settings::Settings;
use crate::experiment::Trial;

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
    let mut samples = input.iter().zip(1..);
    let Some((&first, _)) = samples.next() else {
        return Vec::new();
    };
    let mut level = first;
    let mut steps = Vec::new();
    for (&value, sample) in samples {
        if (value - level).abs() > min_step {
            steps.push(InputStep { sample, before: level, after: value });
            level = value;
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
pub(crate) fn joint_steps(trials: &[Trial], settings: &Settings) -> Vec<Vec<InputStep>> {
    if settings.takes_as_continuous(trials) {
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
    let is_given = settings.min_step > 0.0;
    let min_step = if is_given { settings.min_step } else { tolerance(input) };
    with_edges_merged(input_steps(input, min_step), edge_samples(trial.period().seconds()))
}

/// Part of the largest step below which one is no step, where the input was interpolated: such
/// an input has bumps that are put back over a few samples.
const SMALLEST_PART: f64 = 0.01;

/// `steps` with those of one edge merged: the same direction, at most `longest` samples from
/// the first to the last, and no level between them that lasts.
fn with_edges_merged(steps: Vec<InputStep>, longest: usize) -> Vec<InputStep> {
    /// A level that is part of an edge lasts at most so many samples: one of a slower clock,
    /// seen at twice its rate.
    const LASTS: usize = 2;
    let rises = |step: &InputStep| step.after > step.before;
    let found = steps.len();
    let mut merged: Vec<InputStep> = Vec::new();
    let mut last = 0;
    for step in steps {
        match merged.last_mut() {
            Some(edge)
                if rises(edge) == rises(&step)
                    && step.sample - last <= LASTS
                    && step.sample - edge.sample <= longest =>
            {
                edge.after = step.after;
            }
            _ => merged.push(step),
        }
        last = step.sample;
    }
    if merged.len() < found {
        let size = |step: &InputStep| (step.after - step.before).abs();
        let largest = merged.iter().map(size).fold(0.0, f64::max);
        merged.retain(|step| size(step) >= SMALLEST_PART * largest);
    }
    merged
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::units::SamplePeriod;

    fn steps(period_s: f64, input: &[f64]) -> Vec<(usize, f64, f64)> {
        let period = SamplePeriod::from_seconds(period_s).unwrap();
        let trial = Trial::new("1", 0.0, period, input.to_vec(), input.to_vec()).unwrap();
        let found = trial_steps(&trial, &Settings::default());
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
