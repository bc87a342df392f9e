//! How large the signals of a record are, and how long it is.

use crate::experiment::{Property, Record, Trial};
use crate::model::coded_neutral;

/// The extent of what was measured, found once for all fits to a record.
#[derive(Debug)]
pub(super) struct Extent {
    /// The neutral of a coded input, else zero.
    pub(super) neutral: f64,
    /// The distinct magnitudes of the input from its neutral, ascending.
    pub(super) levels: Vec<f64>,
    /// Highest minus lowest input.
    pub(super) input_span: f64,
    /// Lowest and highest output.
    pub(super) output: (f64, f64),
    /// Highest minus lowest output, per trial.
    pub(super) spans: Vec<f64>,
    /// Lowest and highest value of each further signal, of the samples at which it was measured.
    pub(super) covariates: Vec<(f64, f64)>,
    /// Seconds from the start of the record to that of each trial.
    pub(super) starts_s: Vec<f64>,
    /// Seconds from the start of the record to its end.
    pub(super) duration_s: f64,
    /// Shortest time between two samples, seconds.
    pub(super) sample_period_s: f64,
}

impl Property for Extent {
    fn find(record: &Record) -> Self {
        let inputs = || record.iter().flat_map(Trial::input).copied();
        let neutral = coded_neutral(record).map_or(0.0, |neutral| neutral.level);
        let mut levels: Vec<f64> = inputs().map(|input| (input - neutral).abs()).collect();
        levels.sort_by(f64::total_cmp);
        levels.dedup();
        levels.shrink_to_fit();
        let (low, high) = ends(inputs());
        let outputs: Vec<_> =
            record.iter().map(|trial| ends(trial.output().iter().copied())).collect();
        let starts_s = trial_starts(record);
        let ends_s = record.iter().zip(&starts_s).map(|(trial, start_s)| start_s + length_s(trial));
        let of_covariate = |index: usize| {
            let values = record.iter().filter_map(|trial| trial.covariates().get(index)).flatten();
            ends(values.copied().filter(|value| value.is_finite()))
        };
        let covariates = record.first().map_or(0, |trial| trial.covariates().len());
        let period_s = |trial: &Trial| trial.period().seconds();
        Self {
            neutral,
            levels,
            input_span: high - low,
            output: ends(outputs.iter().flat_map(|(low, high)| [*low, *high])),
            spans: outputs.iter().map(|(low, high)| high - low).collect(),
            covariates: (0..covariates).map(of_covariate).collect(),
            duration_s: ends_s.fold(0.0, f64::max),
            starts_s,
            sample_period_s: record.iter().map(period_s).fold(f64::INFINITY, f64::min),
        }
    }
}

/// Seconds from the start of a record to that of each of its trials.
pub(crate) fn starts_s(record: &Record) -> Vec<f64> {
    record.property::<Extent>().starts_s.clone()
}

/// The lowest and the highest of `values`; (∞, −∞) of none.
fn ends(values: impl Iterator<Item = f64>) -> (f64, f64) {
    let none = (f64::INFINITY, f64::NEG_INFINITY);
    values.fold(none, |(low, high), value| (low.min(value), high.max(value)))
}

/// Seconds from the start of the record to that of each trial.
///
/// Where their times overlap, as when each counts from zero, they are taken to have followed
/// one another without a pause: what warms in one trial is warm in the next.
fn trial_starts(trials: &[Trial]) -> Vec<f64> {
    let times = || trials.iter().map(|trial| trial.time_s(1));
    let ends = trials.iter().map(|trial| trial.time_s(1) + length_s(trial));
    // Times are rounded: an end may seem to lie a little after the next start.
    let follow = ends
        .zip(trials.iter().skip(1))
        .all(|(end, next)| next.time_s(1) > end - 0.5 * next.period().seconds());
    if follow {
        let first = times().fold(f64::INFINITY, f64::min);
        return times().map(|time| time - first).collect();
    }
    let mut sum = 0.0;
    let before = |trial: &Trial| {
        let before = sum;
        sum += length_s(trial);
        before
    };
    trials.iter().map(before).collect()
}

fn length_s(trial: &Trial) -> f64 {
    trial.len() as f64 * trial.period().seconds()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::units::SamplePeriod;

    fn trial(start_s: f64, samples: usize) -> Trial {
        let period = SamplePeriod::from_seconds(0.5).unwrap();
        Trial::new("a", start_s, period, vec![0.0; samples], vec![0.0; samples]).unwrap()
    }

    #[test]
    fn trials_that_each_count_from_zero_follow_one_another() {
        assert_eq!(trial_starts(&[trial(7.0, 4), trial(20.0, 4)]), [0.0, 13.0]);
        assert_eq!(trial_starts(&[trial(0.0, 4), trial(0.0, 6), trial(0.0, 2)]), [0.0, 2.0, 5.0]);
    }
}
