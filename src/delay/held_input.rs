//! The levels that an input holds where it was measured with noise.

use std::borrow::Cow;

use super::hold::alike;
use super::input_motion::InputMotion;
use super::input_noise::Levels;
use super::settings::Settings;
use super::steps::{hold_ranges, trial_steps};
use crate::experiment::{Record, Trial};
use crate::numerics::median;

/// The inputs of the trials of `record` without the noise that they were measured with: from each step to the next the
/// median of the samples, levels that noise tells apart taken as one; exact ones without the glitches of
/// a logger. None where they have neither, or where an input moves all the time.
pub(crate) fn held_inputs(record: &Record) -> Option<Vec<Vec<f64>>> {
    /// Parts of the largest change that is noise within which levels are one: its standard deviation.
    const ALIKE: f64 = 1.0 / 7.0;
    let levels = |trial| Levels::of(Trial::input(trial), Trial::period(trial).seconds());
    let levels: Vec<Levels<'_>> = record.iter().map(levels).collect();
    let tolerance = levels.iter().map(|levels| levels.tolerance).fold(0.0, f64::max);
    let is_as_measured = |levels: &Levels<'_>| matches!(levels.values, Cow::Borrowed(_));
    let is_exact = tolerance <= 0.0;
    if is_exact && levels.iter().all(is_as_measured) || InputMotion::of(record).is_continuous() {
        return None;
    }
    if is_exact {
        return Some(levels.into_iter().map(|levels| levels.values.into_owned()).collect());
    }
    let settings = Settings::default();
    let holds = record.iter().map(|trial| {
        let steps = trial_steps(trial, &settings);
        let first = steps.first().map_or(trial.len(), |step| step.sample - 1);
        let ranges = std::iter::once(0..first).chain(hold_ranges(&steps, trial.len()));
        let level =
            |range: &std::ops::Range<usize>| trial.input().get(range.clone()).and_then(median);
        ranges.filter_map(|range| Some((level(&range)?, range))).collect::<Vec<_>>()
    });
    let holds: Vec<Vec<_>> = holds.collect();
    let mut levels: Vec<f64> = holds.iter().flatten().map(|(level, _)| *level).collect();
    levels.sort_by(f64::total_cmp);
    let kinds = alike(&levels, |level| *level, ALIKE * tolerance);
    // The one that begins at the level or below it holds it.
    let kind_of = |level: f64| kinds.partition_point(|kind| kind[0] <= level).saturating_sub(1);
    let kind = |level: f64| kinds.get(kind_of(level)).copied().and_then(median).unwrap_or(level);
    let held = |holds: &Vec<(f64, std::ops::Range<usize>)>| {
        let hold = |(level, range): &(f64, std::ops::Range<usize>)| {
            std::iter::repeat_n(kind(*level), range.len())
        };
        holds.iter().flat_map(hold).collect()
    };
    Some(holds.iter().map(held).collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::numerics::testing::noise;
    use crate::units::SamplePeriod;

    fn trial(input: Vec<f64>) -> Trial {
        let period = SamplePeriod::from_seconds(0.01).unwrap();
        Trial::new("1", 0.0, period, input.clone(), input).unwrap()
    }

    #[test]
    fn levels_are_found_in_noise() {
        let level = |k: usize| [0.0, 1.0, -1.0, 0.5, 0.0, -0.5][k / 150 % 6];
        let exact: Vec<f64> = (0..6000).map(level).collect();
        assert_eq!(held_inputs(&Record::from([trial(exact.clone())])), None);
        for deviation in [2e-4, 5e-3, 0.04] {
            let noise = noise(3, 0.0, 6000);
            let input = exact.iter().zip(noise).map(|(level, noise)| level + deviation * noise);
            let held = held_inputs(&Record::from([trial(input.collect())])).unwrap().remove(0);
            let off = |k: &usize| (held[*k] - exact[*k]).abs() > 0.5 * deviation;
            assert!((0..6000).filter(off).count() < 40, "{deviation}: edges off by a sample");
            let mut levels = held;
            levels.sort_by(f64::total_cmp);
            levels.dedup();
            assert!(levels.len() <= 8, "{deviation} {levels:?}");
        }
    }

    #[test]
    fn what_moves_is_left_as_it_is() {
        let noise = noise(5, 0.0, 6000);
        let moves = noise.iter().enumerate();
        let moves = moves.map(|(k, noise)| (k as f64 / 40.0).sin() + 0.01 * noise);
        assert_eq!(held_inputs(&Record::from([trial(moves.collect())])), None);
    }
}
