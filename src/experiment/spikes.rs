//! Isolated spikes of the sensor, from the record alone.
//!
//! A sample, or two in a row, is a spike where it lies beyond all of the three samples before
//! and the three after it, further than these lie from one another and further than the
//! sensor's noise reaches. It gets no weight in a fit, and a line in its place where delays are
//! looked for. Whatever a model makes of a record, the samples
//! that count are the same: costs of models are sums of the same squares, and compare.

use std::collections::BTreeSet;
use std::ops::Range;

use super::record::Record;
use super::trial::Trial;
use crate::numerics::{quantile, robust_scale};

/// Samples on either side that a spike is held against.
const SIDE: usize = 3;

/// Samples in a row that can be a spike: what lasts longer may be motion.
const LONGEST: usize = 2;

/// Standard deviations of the noise beyond which no sample of a long record lies by chance, also
/// where differences show only half of a noise with a memory.
const BEYOND: f64 = 8.0;

/// The spikes in the trials of a joint, whose sensor has one noise.
pub(crate) struct Spikes(Vec<Vec<Range<usize>>>);

impl Spikes {
    pub(crate) fn of(trials: &[Trial]) -> Self {
        let noise = noise(trials);
        Self(trials.iter().map(|trial| spikes(trial.output(), noise)).collect())
    }

    /// For each of the `trials` the weights of its samples, 0 for spikes and for what was filled in where
    /// nothing was logged or measured, and 1 for others; `None` where all are 1.
    pub(crate) fn weights(&self, trials: &[Trial]) -> Option<Vec<Vec<f64>>> {
        let without = |(trial, spikes): (&Trial, &Vec<Range<usize>>)| -> Vec<Range<usize>> {
            let filled = trial.unlogged().iter().chain(trial.interpolated());
            spikes.iter().chain(filled).cloned().collect()
        };
        let without: Vec<_> = trials.iter().zip(&self.0).map(without).collect();
        let of = |(trial, without): (&Trial, &Vec<Range<usize>>)| {
            let mut weights = vec![1.0; trial.len()];
            for range in without {
                weights[range.clone()].fill(0.0);
            }
            weights
        };
        let any = without.iter().any(|ranges| !ranges.is_empty());
        any.then(|| trials.iter().zip(&without).map(of).collect())
    }

    /// `record` with lines in the place of the spikes of its output, so that they are no part of its
    /// range either; none where it has no spike.
    pub(crate) fn taken_out(&self, record: &Record) -> Option<Record> {
        if self.0.iter().all(Vec::is_empty) {
            return None;
        }
        let mend = |(trial, spikes): (&Trial, &Vec<Range<usize>>)| {
            trial.clone().with_output(with_lines(trial.output(), spikes))
        };
        Some(record.iter().zip(&self.0).map(mend).collect())
    }
}

/// Samples of `trial` that are spikes.
pub(crate) fn spike_count(trial: &Trial) -> usize {
    let spikes = spikes(trial.output(), noise(std::slice::from_ref(trial)));
    spikes.into_iter().flatten().collect::<BTreeSet<usize>>().len()
}

/// The output of `trial` with lines in the place of its spikes; none where it has no spike.
pub(crate) fn without_spikes(trial: &Trial) -> Option<Vec<f64>> {
    let spikes = spikes(trial.output(), noise(std::slice::from_ref(trial)));
    (!spikes.is_empty()).then(|| with_lines(trial.output(), &spikes))
}

/// `output` with lines in the place of its `spikes`.
fn with_lines(output: &[f64], spikes: &[Range<usize>]) -> Vec<f64> {
    let mut mended = output.to_vec();
    for &Range { start, end } in spikes {
        // A spike is never at an end of a trial.
        let (from, to) = (mended[start - 1], output[end]);
        let step = (to - from) / (end - start + 1) as f64;
        for (k, value) in mended[start..end].iter_mut().enumerate() {
            *value = from + step * (k + 1) as f64;
        }
    }
    mended
}

/// Standard deviation of the sensor's noise: from differences of the second order, which leave
/// little of a motion, and not below what most samples that change at all change by, which is about
/// the sensor's step where it is coarse, also where a grid lies between its samples.
fn noise(trials: &[Trial]) -> f64 {
    /// The variance of `a − 2b + c` in parts of that of white noise.
    const SECOND_ORDER: f64 = 6.0;
    /// Differences that are enough to know it.
    const ENOUGH: usize = 20_000;
    /// Changes that are smaller than most (chosen: a lower quartile).
    const SMALL: f64 = 0.25;
    let samples: usize = trials.iter().map(|trial| trial.output().len()).sum();
    let every = samples.div_ceil(ENOUGH).max(1);
    let triples = trials.iter().flat_map(|trial| trial.output().windows(3).step_by(every));
    let second: Vec<f64> = triples.map(|three| three[0] - 2.0 * three[1] + three[2]).collect();
    let pairs = trials.iter().flat_map(|trial| trial.output().windows(2).step_by(every));
    let steps = pairs.map(|pair| (pair[1] - pair[0]).abs()).filter(|step| *step > 0.0);
    let steps: Vec<f64> = steps.collect();
    let step = quantile(&steps, SMALL).unwrap_or(0.0);
    (robust_scale(&second) / SECOND_ORDER.sqrt()).max(step)
}

/// The spikes of an output with this noise, the single ones first.
fn spikes(output: &[f64], noise: f64) -> Vec<Range<usize>> {
    let of_length = |length: usize| {
        let places = SIDE..output.len().saturating_sub(SIDE + length - 1);
        places.map(move |from| from..from + length)
    };
    let all = (1..=LONGEST).flat_map(of_length);
    all.filter(|place| is_spike(output, place.clone(), noise)).collect()
}

/// Whether the samples at `place` are a spike among their neighbours.
fn is_spike(output: &[f64], place: Range<usize>, noise: f64) -> bool {
    let jump = output[place.start] - output[place.start - 1];
    if jump.abs() <= BEYOND * noise {
        return false;
    }
    let before = &output[place.start - SIDE..place.start];
    let behind = &output[place.end..place.end + SIDE];
    let mut around: Vec<f64> = before.iter().chain(behind).copied().collect();
    let suspects = &output[place];
    // One of the neighbours may be another spike.
    around.sort_by(f64::total_cmp);
    let (without_low, without_high) = (around.get(1..), around.get(..around.len() - 1));
    let narrowest = [without_low, without_high].into_iter().flatten().map(span);
    let narrowest = narrowest.min_by(|a, b| (a.1 - a.0).total_cmp(&(b.1 - b.0)));
    let Some((low, high)) = narrowest else { return false };
    let room = (high - low).max(BEYOND * noise);
    let is_near = |y: &f64| (low - room..=high + room).contains(y);
    if !(before.last().is_some_and(is_near) && behind.first().is_some_and(is_near)) {
        return false;
    }
    let above = suspects.iter().all(|y| *y > high + room);
    above || suspects.iter().all(|y| *y < low - room)
}

/// The lowest and the highest of `values`.
fn span(values: &[f64]) -> (f64, f64) {
    values.iter().fold((f64::MAX, f64::MIN), |(low, high), y| (low.min(*y), high.max(*y)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::numerics::testing::noise as noisy;

    fn found(output: &[f64], noise: f64) -> Vec<usize> {
        spikes(output, noise).into_iter().flatten().collect::<BTreeSet<_>>().into_iter().collect()
    }

    #[test]
    fn one_and_two_samples_far_off_are_spikes_and_three_are_motion() {
        let mut output = noisy(3, 0.0, 400);
        output[50] += 30.0;
        output[53] -= 30.0;
        output[100..102].iter_mut().for_each(|y| *y -= 40.0);
        output[200..203].iter_mut().for_each(|y| *y += 40.0);
        assert_eq!(found(&output, 1.0), [50, 53, 100, 101]);
    }

    #[test]
    fn a_line_takes_the_place_of_a_spike() {
        let noise = noisy(3, 0.0, 400);
        let mut output = noise.clone();
        output[50] += 30.0;
        output[100..102].iter_mut().for_each(|y| *y -= 40.0);
        let period = crate::units::SamplePeriod::from_seconds(0.01).unwrap();
        let trial =
            |output: Vec<f64>| Trial::new("1", 0.0, period, vec![0.0; 400], output).unwrap();
        let mended = without_spikes(&trial(output)).unwrap();
        let others = (0..400).filter(|k| ![50, 100, 101].contains(k));
        assert!(others.into_iter().all(|k| mended[k].to_bits() == noise[k].to_bits()));
        assert!((mended[50] - f64::midpoint(noise[49], noise[51])).abs() < 1e-12);
        assert!((mended[101] - (noise[99] + 2.0 * noise[102]) / 3.0).abs() < 1e-12);
        assert_eq!(without_spikes(&trial(noise)), None);
    }

    #[test]
    fn noise_a_step_and_the_peak_of_a_motion_are_none() {
        assert_eq!(found(&noisy(5, 0.9, 20_000), 0.265), [0; 0]);
        let motion: Vec<f64> = (0..400).map(|k| (0.3 * f64::from(k)).sin()).collect();
        assert_eq!(found(&motion, 1e-9), [0; 0]);
        let step: Vec<f64> = (0..40).map(|k| if k < 20 { 0.0 } else { 9.0 }).collect();
        assert_eq!(found(&step, 0.01), [0; 0]);
    }
}
