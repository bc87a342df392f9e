//! How long the input of a joint holds which level, and how far the output goes meanwhile.

use super::steps::input_steps;
use crate::experiment::{Property, Record, Trial};
use crate::numerics::{median, noise_of_differences, quantile};

/// Part of the input's range within which two levels are one: chosen; converters and
/// potentiometers scatter by less, and no experiment steps by so little.
const SAME_LEVEL: f64 = 0.01;

/// The largest part of the range that noise makes of it: an input that never holds looks
/// like noise.
const MOST_NOISE: f64 = 0.05;

/// Standard deviations that noise reaches from its level: of normal noise one sample in 16 000 is
/// beyond.
const REACH: f64 = 4.0;

/// A time over which the input kept its level.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Hold {
    /// The level: the median of its samples, input units.
    pub(super) level: f64,
    /// How long it was held, seconds.
    pub(super) seconds: f64,
    /// How far the output went, output units.
    pub(super) travel: f64,
    /// How far it went in the second half.
    pub(super) late_travel: f64,
    /// Whether the trial begins with it.
    pub(super) is_first: bool,
    /// Whether the trial ends with it.
    pub(super) is_last: bool,
}

/// The distance, in input units, up to which two levels of the input are one: a part of its
/// range, or what its noise takes.
///
/// Noise is measured by the differences of neighbouring samples; a commanded input holds its
/// levels exactly, so that most of them are zero.
pub(crate) fn level_tolerance(record: &Record) -> f64 {
    record.property::<LevelTolerance>().0
}

struct LevelTolerance(f64);

impl Property for LevelTolerance {
    fn find(record: &Record) -> Self {
        /// Parts of the samples beyond which a level is a glitch.
        const GLITCHES: f64 = 1e-3;
        let inputs: Vec<f64> = record.iter().flat_map(Trial::input).copied().collect();
        let ends = quantile(&inputs, GLITCHES).zip(quantile(&inputs, 1.0 - GLITCHES));
        let range = ends.map_or(0.0, |(low, high)| high - low);
        let noise = noise_of_differences(record.iter().map(Trial::input));
        Self((SAME_LEVEL * range).max((REACH * noise).min(MOST_NOISE * range)))
    }
}

/// Groups of values, which are in the order of their levels: each level within `tolerance` of the
/// first of its group.
pub(crate) fn alike<T>(sorted: &[T], level: impl Fn(&T) -> f64, tolerance: f64) -> Vec<&[T]> {
    let (mut groups, mut rest) = (Vec::new(), sorted);
    while let Some(least) = rest.first() {
        let limit = level(least) + tolerance;
        let (same, others) = rest.split_at(rest.partition_point(|it| level(it) <= limit).max(1));
        groups.push(same);
        rest = others;
    }
    groups
}

/// The holds of a trial in their order: from each change of more than `tolerance` to the next.
pub(super) fn holds(trial: &Trial, tolerance: f64) -> Vec<Hold> {
    let steps = input_steps(trial.input(), tolerance);
    let changes = steps.iter().map(|step| step.sample - 1);
    let bounds: Vec<usize> = [0].into_iter().chain(changes).chain([trial.len()]).collect();
    let hold = |pair: &[usize]| match *pair {
        [start, end] => hold(trial, start, end),
        _ => None,
    };
    bounds.windows(2).filter_map(hold).collect()
}

/// The hold of the samples `start..end`, counted from 0.
fn hold(trial: &Trial, start: usize, end: usize) -> Option<Hold> {
    let output = trial.output().get(start..end)?;
    let (first, last) = (output.first()?, output.last()?);
    Some(Hold {
        level: median(trial.input().get(start..end)?)?,
        seconds: (end - start) as f64 * trial.period().seconds(),
        travel: last - first,
        late_travel: last - output.get(output.len() / 2)?,
        is_first: start == 0,
        is_last: end == trial.len(),
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::units::SamplePeriod;

    fn trial(input: Vec<f64>) -> Trial {
        let output = (0..input.len()).map(|k| k as f64).collect();
        Trial::new("1", 0.0, SamplePeriod::from_seconds(0.1).unwrap(), input, output).unwrap()
    }

    #[test]
    fn a_hold_has_its_level_and_how_far_the_output_went() {
        let trial = trial([vec![0.0; 10], vec![2.0; 20]].concat());
        let tolerance = level_tolerance(&Record::from([trial.clone()]));
        assert!((tolerance - 0.02).abs() < 1e-12);
        let found = holds(&trial, tolerance);
        let last = Hold {
            level: 2.0,
            seconds: 2.0,
            travel: 19.0,
            late_travel: 9.0,
            is_first: false,
            is_last: true,
        };
        assert_eq!((found.len(), found[1]), (2, last));
        assert!(found[0].is_first && !found[0].is_last);
    }

    #[test]
    fn noise_on_a_level_is_within_the_tolerance() {
        let noise = |k: i32| 0.03 * f64::from((k * 7919) % 101 - 50) / 50.0;
        let level = |k: i32| f64::from(k / 100 % 2);
        let trial = trial((0..600).map(|k| level(k) + noise(k)).collect());
        let tolerance = level_tolerance(&Record::from([trial.clone()]));
        assert!((0.03..=0.0531).contains(&tolerance), "{tolerance}");
        let noisy = holds(&trial, 2.0 * tolerance);
        assert_eq!(noisy.len(), 6);
    }
}
