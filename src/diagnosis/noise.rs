//! The noise of the measurement, from the measurement and what a model follows of it.

use std::ops::Range;

use crate::experiment::Trial;
use crate::fit::Window;
use crate::model::Arrivals;
use crate::statistics::median;

/// Seconds after a change of the input in which a joint may still settle.
const SETTLING_S: f64 = 0.3;

/// Fewest samples of a stretch: three go into its parabola.
const SHORTEST: usize = 20;

/// Standard deviation of the measurement noise, output units; `None` where the joint is
/// nowhere steady for long enough.
///
/// Where the input has been constant for a while, a joint moves along a line that bends
/// slowly. Each such stretch is fitted by a parabola; the median over the stretches of
/// the residual variance `Σ r² / (n − 3)` is the noise. Noise that is correlated over more
/// than about a third of a stretch is taken for motion, and is missing in the result; a
/// joint that still swings there has its swing in it.
pub fn noise_floor<'a>(trials: impl Iterator<Item = (&'a Trial, &'a Arrivals)>) -> Option<f64> {
    let values = |(trial, arrivals): (&'a Trial, &'a Arrivals)| {
        let steady = steady(trial, arrivals).into_iter();
        steady.filter_map(|stretch| trial.output().get(stretch)).collect::<Vec<_>>()
    };
    of_stretches(trials.flat_map(values))
}

/// The part of that noise which is none, because a model follows it: `residuals` per trial and
/// sample, about parabolas in the steady stretches of `windows`, over the output there. At
/// most 1; 1 where there is too little.
///
/// A swing in the output is not in what a model leaves that swings alike. Noise is in both,
/// and with the same memory, so that what the parabolas take of it is the same.
pub(crate) fn part_left<'a>(
    trials: impl Iterator<Item = (&'a Trial, &'a Arrivals)>,
    residuals: &'a [Vec<f64>],
    windows: &'a [Window],
) -> f64 {
    let pieces = |(index, (trial, arrivals)): (usize, (&'a Trial, &'a Arrivals))| {
        let residuals = residuals.get(index).map_or(&[][..], Vec::as_slice);
        let of_trial: Vec<_> = windows.iter().filter(|window| window.trial == index).collect();
        let places = steady(trial, arrivals).into_iter().flat_map(|stretch| {
            let first = of_trial.partition_point(|window| window.end <= stretch.start);
            let met = of_trial.iter().skip(first).take_while(|window| window.start < stretch.end);
            met.map(|w| w.start.max(stretch.start)..w.end.min(stretch.end)).collect::<Vec<_>>()
        });
        let both =
            |place: Range<usize>| Some((trial.output().get(place.clone())?, residuals.get(place)?));
        places.filter_map(both).collect::<Vec<_>>()
    };
    let pieces: Vec<(&[f64], &[f64])> = trials.enumerate().flat_map(pieces).collect();
    let shown = of_stretches(pieces.iter().map(|piece| piece.0));
    let left = of_stretches(pieces.iter().map(|piece| piece.1));
    let part = shown.zip(left).map(|(shown, left)| left / shown);
    part.filter(|part| part.is_finite()).map_or(1.0, |part| part.min(1.0))
}

fn of_stretches<'a>(stretches: impl Iterator<Item = &'a [f64]>) -> Option<f64> {
    let long = stretches.filter(|values| values.len() >= SHORTEST);
    let variances = long.map(about_parabola).filter(|variance| variance.is_finite());
    median(&variances.collect::<Vec<_>>()).map(f64::sqrt)
}

/// Samples between the changes of the input, each from where the joint has settled.
fn steady(trial: &Trial, arrivals: &Arrivals) -> Vec<Range<usize>> {
    let period = trial.period().seconds();
    let starts = std::iter::once(-SETTLING_S).chain(arrivals.changes.iter().map(|c| c.time_s));
    let length_s = trial.len() as f64 * period;
    let ends = arrivals.changes.iter().map(|change| change.time_s).chain([length_s]);
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "inside")]
    let index = |time_s: f64| (time_s / period).ceil().clamp(0.0, trial.len() as f64) as usize;
    starts.zip(ends).map(|(start, end)| index(start + SETTLING_S)..index(end)).collect()
}

/// Residual variance of `values` about the best parabola.
///
/// By discrete Legendre polynomials `1, x, x² − mean(x²)` on a symmetric grid, which are
/// orthogonal, so that each coefficient stands alone.
fn about_parabola(values: &[f64]) -> f64 {
    let n = values.len() as f64;
    let mean = values.iter().sum::<f64>() / n;
    let places = || (0..values.len()).map(|k| k as f64 - (n - 1.0) / 2.0);
    let mean_square = places().map(|x| x * x).sum::<f64>() / n;
    let project = |shape: &dyn Fn(f64) -> f64| {
        let with = places().zip(values).map(|(x, y)| shape(x) * (y - mean)).sum::<f64>();
        with * with / places().map(|x| shape(x) * shape(x)).sum::<f64>()
    };
    let total: f64 = values.iter().map(|y| (y - mean) * (y - mean)).sum();
    let explained = project(&|x| x) + project(&|x| x * x - mean_square);
    (total - explained).max(0.0) / (n - 3.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::Arrival;
    use crate::units::SamplePeriod;

    #[test]
    fn a_parabola_leaves_nothing() {
        let parabola: Vec<f64> =
            (0..50).map(|k| 1e3 + 2.0 * f64::from(k) - 0.1 * f64::from(k * k)).collect();
        assert!(about_parabola(&parabola) < 1e-12);
    }

    #[test]
    fn noise_on_a_moving_joint_is_told_from_its_motion() {
        let period = SamplePeriod::from_seconds(0.01).unwrap();
        let noise = |k: usize| if k * 7919 % 13 < 6 { 0.05 } else { -0.05 };
        let input: Vec<f64> = (0..2000).map(|k| f64::from(k / 200 % 3)).collect();
        let mut angle = 0.0;
        let output = input.iter().enumerate().map(|(k, u)| {
            angle += 0.1 * u;
            angle + noise(k)
        });
        let trial = Trial::new("1", 0.0, period, input.clone(), output.collect()).unwrap();
        let changes =
            (1..10).map(|i| Arrival { time_s: 2.0 * f64::from(i), level: f64::from(i % 3) });
        let arrivals = Arrivals { initial: 0.0, changes: changes.collect() };
        let found = noise_floor(std::iter::once((&trial, &arrivals))).unwrap();
        assert!((found - 0.05).abs() < 0.003, "{found}");
    }

    #[test]
    fn a_joint_that_is_never_steady_has_no_noise_floor() {
        let period = SamplePeriod::from_seconds(0.01).unwrap();
        let trial = Trial::new("1", 0.0, period, vec![0.0; 10], vec![0.0; 10]).unwrap();
        let arrivals = Arrivals { initial: 0.0, changes: Vec::new() };
        assert_eq!(noise_floor(std::iter::once((&trial, &arrivals))), None);
    }
}
