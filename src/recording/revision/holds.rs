//! What each level of the input made of the joint.
//!
//! Where a level is held, the measured output runs along a line: its slope is a speed that
//! owes nothing to a model, but for when the level began to act. An output that follows the input
//! itself runs to a level of its own, which is looked at instead.

use std::ops::Range;

use super::figure::Held;
use crate::diagnosis::Comparison;
use crate::experiment::{Joint, Trial};
use crate::fit::follows_input;
use crate::model::Simulated;
use crate::recording::canvas::Span;

/// Fewest samples of a level whose speed is known.
const SHORTEST: usize = 12;

/// What is looked at while a level is held.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Shown {
    /// Its speed.
    Speed,
    /// The output to which it runs, over the last third of the hold.
    Output,
}

impl Shown {
    pub(super) fn of(joint: &Joint) -> Self {
        if follows_input(joint).is_some() { Self::Output } else { Self::Speed }
    }
}

/// What is shown of each level that acts; of parts of the record where no level is held.
pub(super) fn all_held(joint: &Joint, comparison: &Comparison, shown: Shown) -> Vec<Held> {
    let noise = comparison.sensor_noise.unwrap_or(0.0);
    let trials = joint.trials.iter().zip(&comparison.fit.evaluation.simulated);
    trials.flat_map(|(trial, simulated)| of_trial(trial, simulated, (noise, shown))).collect()
}

fn of_trial(trial: &Trial, simulated: &Simulated, (noise, shown): (f64, Shown)) -> Vec<Held> {
    /// Part of the largest input of its trial that drives a joint into a stop.
    const DRIVEN: f64 = 0.1;
    let acting = simulated.acting.as_slice();
    #[expect(clippy::float_cmp, reason = "a step is any change")]
    let levels: Vec<&[f64]> = acting.chunk_by(|a, b| a == b).collect();
    let known = levels.iter().map(|part| part.len()).filter(|samples| *samples >= SHORTEST);
    let is_held = 2 * known.sum::<usize>() > acting.len();
    let parts = if is_held { levels } else { acting.chunks(2 * SHORTEST).collect() };
    let mean = |values: &[f64]| values.iter().sum::<f64>() / values.len() as f64;
    let range = Span::around(trial.output().iter().copied(), 0.0);
    let largest = trial.input().iter().fold(0.0, |most: f64, level| most.max(level.abs()));
    let (mut start, mut before) = (0, f64::NEG_INFINITY);
    let mut all = Vec::new();
    for part in parts {
        let output = trial.output().get(start..start + part.len()).unwrap_or_default();
        let within = match shown {
            Shown::Speed if mean(part).abs() > DRIVEN * largest => moving(output, range),
            Shown::Speed => output.len() / 3..output.len(),
            Shown::Output => output.len() - output.len() / 3..output.len(),
        };
        let rows = start + within.start..start + within.end;
        let level = mean(part);
        let fell = shown == Shown::Output && level < before;
        (start, before) = (start + part.len(), level);
        let Some(measured) = output.get(within).filter(|_| part.len() >= SHORTEST) else {
            continue;
        };
        let period_s = trial.period().seconds();
        let (speed, std_error) = match shown {
            Shown::Speed => slope(measured, period_s, noise),
            Shown::Output => (mean(measured), noise / (measured.len() as f64).sqrt()),
        };
        // Of a simulation that is set back to the measurement now and then, the speed.
        let simulated = match shown {
            Shown::Speed => simulated.velocity.get(rows).map(mean),
            Shown::Output => simulated.output.get(rows).map(mean),
        };
        all.push(Held { level, speed, std_error, fell, simulated });
    }
    all
}

/// The samples over which a hold shows its speed: the later two thirds, since the joint must come up
/// to speed; of a stroke into an end of `range` those between a quarter and three quarters of its
/// way, since it stands behind.
fn moving(output: &[f64], range: Span) -> Range<usize> {
    const FEWEST: usize = 5;
    /// Part of the range that is its end.
    const END: f64 = 0.02;
    /// Part of its way by which a joint that stands may seem to move.
    const STILL: f64 = 0.02;
    let later = output.len() / 3..output.len();
    let Some((first, last)) = output.first().zip(output.last()) else { return later };
    let end = if last > first { range.high } else { range.low };
    let stands = |y: &f64| (y - end).abs() <= END * (range.high - range.low);
    let is_still = |y: &f64| (y - last).abs() <= STILL * (last - first).abs();
    let is_stroke = output.iter().rev().take(output.len() / 4).all(|y| stands(y) && is_still(y));
    let part = |y: &f64| (y - first) / (last - first);
    let begin = output.iter().position(|y| part(y) >= 0.25);
    let end = output.iter().rposition(|y| part(y) <= 0.75);
    match begin.zip(end) {
        Some((begin, end)) if is_stroke && end >= begin + FEWEST => begin..end + 1,
        _ => later,
    }
}

/// The slope of the regression line per second, and its standard error.
fn slope(values: &[f64], period_s: f64, noise: f64) -> (f64, f64) {
    let n = values.len() as f64;
    let spread = n * (n * n - 1.0) / 12.0;
    let middle = 0.5 * (n - 1.0);
    let moment: f64 = values.iter().zip(0_u32..).map(|(y, k)| (f64::from(k) - middle) * y).sum();
    (moment / spread / period_s, noise / spread.sqrt() / period_s)
}

/// How long a level is held on average, where the input is held at all.
pub(super) fn mean_hold_s(joint: &Joint) -> Option<f64> {
    #[expect(clippy::float_cmp, reason = "a step is any change")]
    let of_trial = |trial: &Trial| {
        let held = trial.input().chunk_by(|a, b| a == b).filter(|part| part.len() >= SHORTEST);
        let (holds, samples) =
            held.fold((0, 0), |(holds, all), part| (holds + 1, all + part.len()));
        (holds, samples as f64 * trial.period().seconds())
    };
    let of_trials = joint.trials.iter().map(of_trial);
    let (holds, held_s) =
        of_trials.fold((0, 0.0), |(n, s), (holds, held_s)| (n + holds, s + held_s));
    (holds > 0).then(|| held_s / f64::from(holds))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::units::SamplePeriod;

    fn trial(input: Vec<f64>, output: Vec<f64>) -> Trial {
        Trial::new("", 0.0, SamplePeriod::from_seconds(0.1).unwrap(), input, output).unwrap()
    }

    fn of(acting: Vec<f64>) -> Simulated {
        Simulated { output: acting.clone(), velocity: vec![0.25; acting.len()], acting }
    }

    #[test]
    fn the_slope_of_a_line_is_exact_and_its_error_is_that_of_the_noise() {
        let values: Vec<f64> = (0..20).map(|k| 3.0 + 0.4 * f64::from(k)).collect();
        let (speed, error) = slope(&values, 0.1, 0.05);
        assert!((speed - 4.0).abs() < 1e-12);
        // σ / (T √(n (n² − 1) / 12)) with n = 20: √665 = 25.788.
        assert!((error - 0.05 / 25.787_594 / 0.1).abs() < 1e-6);
    }

    #[test]
    fn a_level_has_one_speed_and_a_short_one_none() {
        let acting = [vec![1.0; 30], vec![-2.0; 5], vec![0.5; 25]].concat();
        let mut y = 0.0;
        let outputs = acting.iter().map(|level| {
            y += 0.3 * level;
            y
        });
        let trial = trial(acting.clone(), outputs.collect());
        let held = of_trial(&trial, &of(acting), (0.0, Shown::Speed));
        let found: Vec<_> = held.iter().map(|held| (held.level, held.speed)).collect();
        assert_eq!(found.len(), 2);
        assert!((found[0].1 - 3.0).abs() < 1e-9 && (found[1].1 - 1.5).abs() < 1e-9);
    }

    #[test]
    fn the_speed_of_a_stroke_is_that_of_its_middle() {
        let output: Vec<f64> =
            (0..100).map(|k| (f64::from(k - 20) * 0.5).clamp(0.0, 10.0)).collect();
        let acting = vec![1.0; 100];
        let held = of_trial(&trial(acting.clone(), output), &of(acting), (0.0, Shown::Speed));
        assert_eq!(held.len(), 1);
        // Half a unit each 0.1 s; it begins late, and stands at its stop for more than half.
        assert!((held[0].speed - 5.0).abs() < 1e-9, "{held:?}");
    }

    #[test]
    fn an_output_that_settles_is_shown_where_it_settles() {
        let acting = [vec![1.0; 30], vec![2.0; 30], vec![-1.0; 30]].concat();
        let settled = |k: usize| if k % 30 < 10 { 0.0 } else { acting[k] };
        let output: Vec<f64> = (0..90).map(settled).collect();
        let held = of_trial(&trial(acting.clone(), output), &of(acting), (0.0, Shown::Output));
        let found: Vec<_> = held.iter().map(|held| (held.level, held.speed, held.fell)).collect();
        assert_eq!(found, [(1.0, 1.0, false), (2.0, 2.0, false), (-1.0, -1.0, true)]);
    }

    #[test]
    fn an_input_that_is_never_held_is_cut_into_parts() {
        let acting: Vec<f64> = (0..240).map(|k| f64::from(k) / 240.0).collect();
        let trial = trial(acting.clone(), acting.clone());
        let held = of_trial(&trial, &of(acting), (0.0, Shown::Speed));
        assert_eq!(held.len(), 10);
        assert!(held.iter().all(|held| held.simulated == Some(0.25)));
        assert!(held.iter().all(|held| (held.speed - 10.0 / 240.0).abs() < 1e-9));
    }
}
