//! Noise and dither of an input: how large it is, and the levels that it leaves.

use std::borrow::Cow;

use crate::numerics::{limits, median, quantile};
use crate::units::ceil_to_index;

/// The levels of an input, and how far its samples are off them.
#[derive(Debug)]
pub(super) struct Levels<'a> {
    /// The input; where its noise is large, its running median, which keeps the place of an edge.
    pub(super) values: Cow<'a, [f64]>,
    /// The largest change that is noise; 0 where levels are exact, or where what the input takes back
    /// at once is not small beside its range.
    pub(super) tolerance: f64,
    /// Samples after an edge at which the median still knows the level before it; 0 without one.
    pub(super) reach: usize,
}

/// What an input may hold so briefly that hardly a joint moves, seconds.
const BRIEF_S: f64 = 0.02;

/// Part of the range that noise must stay below, and steps exceed.
const OF_RANGE: f64 = 0.08;

impl<'a> Levels<'a> {
    pub(super) fn of(input: &'a [f64], period_s: f64) -> Self {
        /// The window of the median: well below the shortest hold.
        const WINDOW_S: f64 = 0.09;
        const SAMPLES: std::ops::RangeInclusive<usize> = 5..=15;
        let exact = |values| Self { values, tolerance: 0.0, reach: 0 };
        let input = without_faults(Cow::Borrowed(input), 0.0, period_s);
        let Some(noise) = noise(&input) else { return exact(input) };
        let input = without_faults(input, noise, period_s);
        let (low, high) = limits(input.iter().copied());
        let is_small = |noise: f64| noise < OF_RANGE * (high - low);
        if is_small(noise) {
            return Self { tolerance: noise, ..exact(input) };
        }
        let window = in_samples(WINDOW_S, period_s).clamp(*SAMPLES.start(), *SAMPLES.end()) | 1;
        let tolerance = noise * left_by_median(window);
        if !is_small(tolerance) {
            return exact(input);
        }
        let values = Cow::Owned(running_median(&input, window));
        Self { values, tolerance, reach: window / 2 }
    }
}

/// An input with the sample before each fault of a logger in its place: a single sample that is off those
/// before and after it by more than `noise`, which have one level. It lasts so briefly that hardly a joint
/// moves, or lies far beyond all others; more than a few are no faults.
fn without_faults(input: Cow<'_, [f64]>, noise: f64, period_s: f64) -> Cow<'_, [f64]> {
    /// Samples to each, at least (chosen).
    const SELDOM: usize = 100;
    /// Part of the samples that are beyond all others, at most, and times the range of these.
    const OUTER: f64 = 1e-3;
    const BEYOND: f64 = 1.0;
    let is_alone = |k: &usize| {
        let [before, at, behind] = [input[k - 1], input[*k], input[k + 1]];
        (behind - before).abs() <= noise && (at - before).abs().min((at - behind).abs()) > noise
    };
    let mut faults: Vec<usize> = (1..input.len().saturating_sub(1)).filter(is_alone).collect();
    if !faults.is_empty() && period_s > BRIEF_S {
        let ends = [OUTER, 1.0 - OUTER].map(|part| quantile(&input, part).unwrap_or(0.0));
        let room = BEYOND * (ends[1] - ends[0]);
        faults.retain(|k| !(ends[0] - room..=ends[1] + room).contains(&input[*k]));
    }
    if faults.is_empty() || SELDOM * faults.len() > input.len() {
        return input;
    }
    let mut mended = input.into_owned();
    for fault in faults {
        mended[fault] = mended[fault - 1];
    }
    Cow::Owned(mended)
}

/// The part of the standard deviation of normal noise that a median of so many samples has
/// (asymptotically, `√(π / 2n)`).
fn left_by_median(samples: usize) -> f64 {
    (std::f64::consts::FRAC_PI_2 / samples as f64).sqrt()
}

/// The median of `window` samples about each, an odd number; at the ends of the first and the last.
fn running_median(values: &[f64], window: usize) -> Vec<f64> {
    let window = window.min(values.len());
    let about = |index: usize| {
        let start = index.saturating_sub(window / 2).min(values.len() - window);
        values.get(start..start + window).and_then(median)
    };
    (0..values.len()).filter_map(about).collect()
}

/// The noise or dither of an input, as the largest change that is one; none where its levels are
/// exact, or where it moves.
fn noise(input: &[f64]) -> Option<f64> {
    /// Samples within which noise takes back its change.
    const AT_ONCE: usize = 2;
    /// Fewest changes taken back, and their part of all changes: noise takes back every second.
    const FEWEST: usize = 3;
    const PART: f64 = 0.05;
    /// Multiples of the 95 % quantile and of the largest such change. Of normal noise the first
    /// is seven standard deviations, which no two samples of a long record are apart.
    const TIMES_USUAL: f64 = 3.5;
    const TIMES_LARGEST: f64 = 2.5;
    let pairs = input.iter().zip(input.iter().skip(1)).zip(1..);
    let changes = pairs.map(|((before, after), sample)| (sample, after - before));
    let changes: Vec<(usize, f64)> = changes.filter(|(_, change)| *change != 0.0).collect();
    let taken_back = changes.windows(2).filter_map(|pair| match pair {
        [(k, a), (next, b)] if next - k <= AT_ONCE && a * b < 0.0 => Some(a.abs().min(b.abs())),
        _ => None,
    });
    let taken_back: Vec<f64> = taken_back.collect();
    if taken_back.len() < FEWEST || (taken_back.len() as f64) < PART * changes.len() as f64 {
        return None;
    }
    let usual = quantile(&taken_back, 0.95).unwrap_or(0.0);
    let largest = taken_back.iter().copied().fold(0.0, f64::max);
    // Of few changes the quantile is uncertain, of many the largest is an outlier: the smaller.
    let tolerance = (TIMES_USUAL * usual).min(TIMES_LARGEST * largest);
    goes_to_and_fro(&changes, tolerance).then_some(tolerance)
}

/// Whether changes up to `largest` mostly take back the one before, as noise does and a smooth
/// input does at its peaks only.
///
/// Of white noise two in three do. About a peak the changes of an even curve are `…, 3d, d, −d,
/// −3d, …`; with `largest` 2.5 or 3.5 times `d`, one in four at most does.
fn goes_to_and_fro(changes: &[(usize, f64)], largest: f64) -> bool {
    const LEAST: f64 = 0.45;
    let small = || changes.windows(2).filter(|pair| pair.iter().all(|(_, a)| a.abs() <= largest));
    let back = small().filter(|pair| matches!(pair, [(_, a), (_, b)] if a * b < 0.0)).count();
    back as f64 > LEAST * small().count() as f64
}

/// Samples of so many seconds, rounded up where they are not whole.
pub(super) fn in_samples(seconds: f64, period_s: f64) -> usize {
    /// What a quotient may be above a whole number by rounding.
    const ROUNDING: f64 = 1e-9;
    ceil_to_index(seconds / period_s - ROUNDING)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::delay::Method;
    use crate::delay::input_motion::InputMotion;
    use crate::delay::settings::Settings;
    use crate::delay::steps::trial_steps;
    use crate::experiment::{Record, Trial};
    use crate::units::SamplePeriod;

    const PERIOD_S: f64 = 0.01;

    /// Normal noise of standard deviation 1.
    fn noise(k: usize) -> f64 {
        let wild = |k: f64| ((k * 12.9898 + 0.3).sin() * 43_758.545).rem_euclid(1.0);
        let k = 2.0 * k as f64;
        (-2.0 * wild(k).max(1e-9).ln()).sqrt() * (std::f64::consts::TAU * wild(k + 1.0)).cos()
    }

    fn trial(input: impl Fn(f64) -> f64, deviation: f64) -> Trial {
        let sample = |k: usize| input(k as f64 * PERIOD_S) + deviation * noise(k);
        let input: Vec<f64> = (0..8000).map(sample).collect();
        let period = SamplePeriod::from_seconds(PERIOD_S).unwrap();
        Trial::new("1", 0.0, period, input.clone(), input).unwrap()
    }

    fn stairs(time_s: f64) -> f64 {
        [0.0, 1.0, -1.0, -0.5, 0.0, 0.5, -0.5][ceil_to_index((time_s / 1.7 + 1e-9).floor()) % 7]
    }

    #[test]
    fn steps_in_noise_are_where_they_are_without() {
        let clean = trial_steps(&trial(stairs, 0.0), &Settings::of(Method::TWO_LINE));
        for deviation in [0.01, 0.03, 0.05] {
            let noisy = trial(stairs, deviation);
            assert!(
                !InputMotion::of(&Record::from([noisy.clone()])).is_continuous(),
                "{deviation}"
            );
            let found = trial_steps(&noisy, &Settings::of(Method::TWO_LINE));
            assert_eq!(found.len(), clean.len(), "{deviation}");
            for (found, clean) in found.iter().zip(&clean) {
                assert!(
                    found.sample.abs_diff(clean.sample) <= 1,
                    "{deviation} {found:?} {clean:?}"
                );
                assert!((found.after - clean.after).abs() < 4.0 * deviation, "{found:?} {clean:?}");
            }
        }
    }

    #[test]
    fn a_glitch_of_the_logger_or_of_a_sensor_is_no_step() {
        for deviation in [0.0, 0.01] {
            let clean = trial(stairs, deviation);
            for height in [0.8, 5.0, 50.0] {
                let mut input = clean.input().to_vec();
                input[3000] = height;
                input[5555] = -height;
                let period = SamplePeriod::from_seconds(PERIOD_S).unwrap();
                let marred = Trial::new("1", 0.0, period, input.clone(), input).unwrap();
                let motion = InputMotion::of(&Record::from([marred.clone()]));
                assert!(!motion.is_continuous(), "{deviation} {height}");
                let samples = |trial: &Trial| -> Vec<usize> {
                    let steps = trial_steps(trial, &Settings::of(Method::TWO_LINE));
                    steps.iter().map(|step| step.sample).collect()
                };
                assert_eq!(samples(&marred), samples(&clean), "{deviation} {height}");
            }
        }
    }

    #[test]
    fn a_sample_that_was_not_logged_is_no_step() {
        let clean = trial(stairs, 0.0);
        let mut input = clean.input().to_vec();
        for dropped in [200, 1033, 3000, 3500, 6100] {
            input[dropped] = 0.0;
        }
        let period = SamplePeriod::from_seconds(PERIOD_S).unwrap();
        let marred = Trial::new("1", 0.0, period, input.clone(), input).unwrap();
        let steps = |trial: &Trial| trial_steps(trial, &Settings::of(Method::TWO_LINE));
        assert_eq!(steps(&marred), steps(&clean));
        // One edge that a logger averaged, and a value that it dropped beside another.
        let edges: Vec<usize> = clean
            .input()
            .windows(2)
            .zip(1..)
            .filter(|(pair, _)| pair[0] < pair[1])
            .map(|(_, at)| at)
            .collect();
        let mut input = marred.input().to_vec();
        input[edges[3]] = 0.5 * (input[edges[3] - 1] + input[edges[3] + 1]);
        input[edges[5] + 1] = -7.0;
        let averaged = Trial::new("1", 0.0, period, input.clone(), input).unwrap();
        assert_eq!(steps(&averaged).len(), steps(&clean).len());
        // A joint has the time to follow a tenth of a second.
        let slow = SamplePeriod::from_seconds(0.1).unwrap();
        let input = marred.input().to_vec();
        let slow = Trial::new("1", 0.0, slow, input.clone(), input).unwrap();
        assert!(steps(&slow).len() > steps(&clean).len());
    }

    #[test]
    fn what_moves_in_noise_moves() {
        for frequency in [0.1, 0.4, 1.5] {
            for deviation in [0.01, 0.03, 0.05] {
                let moving = trial(|t| (std::f64::consts::TAU * frequency * t).sin(), deviation);
                let found = InputMotion::of(&Record::from([moving.clone()]));
                assert!(found.is_continuous(), "{frequency} {deviation} {found:?}");
            }
        }
    }

    #[test]
    fn the_running_median_leaves_an_edge_where_it_is() {
        let edge: Vec<f64> = (0..40).map(|k| f64::from(u8::from(k >= 17))).collect();
        assert_eq!(running_median(&edge, 9), edge);
        assert!((left_by_median(9) - 0.417_8).abs() < 1e-3);
    }
}
