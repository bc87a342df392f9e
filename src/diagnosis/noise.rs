//! The noise of the measurement, from the measurement and what a model follows of it.

use std::ops::Range;

use crate::experiment::Trial;
use crate::model::{Arrivals, Simulated};
use crate::numerics::{least_change, median};

/// Seconds after a change of the input in which a joint may still settle.
const SETTLING_S: f64 = 0.3;

/// Seconds of a window: short beside the motion of a hydraulic joint.
const WINDOW_S: f64 = 0.2;

/// Fewest samples of a window: three go into its parabola.
const FEWEST: usize = 8;

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

/// Standard deviation of the noise of the sensor, output units, from the record alone; `None`
/// where every trial is too short.
///
/// Each window of 0.2 s is fitted by a parabola; the median of the residual variances
/// `Σ r² / (n − 3)` is that of the noise. A sensor that shows none where the joint rests has at
/// least that of its rounding, `q/√12` with the least change `q` (B. Widrow and I. Kollár,
/// "Quantization Noise", 2008). Motion within fractions of 0.2 s counts as noise; noise that is
/// slower than that does not.
pub fn sensor_noise(trials: &[Trial]) -> Option<f64> {
    let windows = trials.iter().flat_map(|trial| {
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "small")]
        let samples = (WINDOW_S / trial.period().seconds()).round() as usize;
        trial.output().chunks_exact(samples.max(FEWEST))
    });
    let variances: Vec<f64> =
        windows.map(about_parabola).filter(|variance| variance.is_finite()).collect();
    // Windows in which the joint starts or stops leave more; they are the fewer.
    let seen = median(&variances)?.sqrt();
    Some(seen.max(rounding(trials)))
}

/// Standard deviation of the rounding of an output: of its least change, where that is a step of
/// its scale, so that all changes are multiples of it.
fn rounding(trials: &[Trial]) -> f64 {
    /// Part of a step by which a change may miss a multiple of it.
    const OFF: f64 = 0.02;
    let pairs = || trials.iter().flat_map(|trial| trial.output().windows(2));
    let Some(least) = least_change(pairs()) else { return 0.0 };
    let is_multiple = |pair: &[f64]| {
        let steps = (pair[1] - pair[0]) / least;
        (steps - steps.round()).abs() < OFF
    };
    let is_step = pairs().all(is_multiple);
    // Rounding is even over ±q/2: q²/12.
    if is_step { least / 12.0_f64.sqrt() } else { 0.0 }
}

/// The part of [`noise_floor`] that a model does not follow: that of the output less the
/// motion that was simulated, over that of the output. At most 1; 1 where there is too little.
///
/// A swing in the output is not in the residual of a model that swings alike. Noise is in
/// both, with the same memory, so that parabolas explain the same part of it.
pub(crate) fn share_not_followed<'a>(
    trials: impl Iterator<Item = (&'a Trial, &'a Arrivals)>,
    simulated: &[Simulated],
) -> f64 {
    let pairs = trials.zip(simulated).flat_map(|((trial, arrivals), simulated)| {
        let pair = |stretch: Range<usize>| {
            let output = trial.output().get(stretch.clone())?;
            let residual =
                without(output, simulated.velocity.get(stretch)?, trial.period().seconds());
            Some((output, residual))
        };
        steady(trial, arrivals).into_iter().filter_map(pair).collect::<Vec<_>>()
    });
    let pairs: Vec<(&[f64], Vec<f64>)> =
        pairs.filter(|(_, residual)| residual.iter().all(|value| value.is_finite())).collect();
    let shown = of_stretches(pairs.iter().map(|pair| pair.0));
    let residual = of_stretches(pairs.iter().map(|pair| pair.1.as_slice()));
    let part = shown.zip(residual).map(|(shown, residual)| residual / shown);
    part.filter(|part| part.is_finite()).map_or(1.0, |part| part.min(1.0))
}

/// `output` less the way gone at `velocity`, from its first value on.
fn without(output: &[f64], velocity: &[f64], period_s: f64) -> Vec<f64> {
    let ways = velocity.iter().scan(0.0, |way, velocity| {
        let now = *way;
        *way += velocity * period_s;
        Some(now)
    });
    output.iter().zip(ways).map(|(y, way)| y - way).collect()
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

/// Residual variance of the regression of `values` on a parabola.
///
/// By discrete Legendre polynomials `1, x, x² − mean(x²)` on a symmetric grid, which are
/// orthogonal, so that each coefficient stands alone.
fn about_parabola(values: &[f64]) -> f64 {
    let n = values.len() as f64;
    let mean = values.iter().sum::<f64>() / n;
    let times = || (0..values.len()).map(|k| k as f64 - (n - 1.0) / 2.0);
    let mean_square = times().map(|x| x * x).sum::<f64>() / n;
    let project = |shape: &dyn Fn(f64) -> f64| {
        let with = times().zip(values).map(|(x, y)| shape(x) * (y - mean)).sum::<f64>();
        with * with / times().map(|x| shape(x) * shape(x)).sum::<f64>()
    };
    let total: f64 = values.iter().map(|y| (y - mean) * (y - mean)).sum();
    let explained = project(&|x| x) + project(&|x| x * x - mean_square);
    (total - explained).max(0.0) / (n - 3.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::Arrival;
    use crate::numerics::testing::noise;
    use crate::units::SamplePeriod;

    #[test]
    fn a_parabola_has_no_residual() {
        let parabola: Vec<f64> =
            (0..50).map(|k| 1e3 + 2.0 * f64::from(k) - 0.1 * f64::from(k * k)).collect();
        assert!(about_parabola(&parabola) < 1e-12);
    }

    #[test]
    fn noise_on_a_moving_joint_is_separated_from_its_motion() {
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
    fn a_swing_that_the_model_follows_is_no_noise() {
        let period = SamplePeriod::from_seconds(0.01).unwrap();
        let noise = noise(3, 0.9, 2000);
        let swing = |k: usize| (k as f64 / 8.0).sin();
        let output = (0..2000).map(|k| swing(k) + 0.1 * noise[k]).collect();
        let trial = Trial::new("1", 0.0, period, vec![0.0; 2000], output).unwrap();
        let changes = (1..10).map(|i| Arrival { time_s: 2.0 * f64::from(i), level: 0.0 });
        let arrivals = Arrivals { initial: 0.0, changes: changes.collect() };
        let trials = || std::iter::once((&trial, &arrivals));
        let part = |share: f64| {
            let velocity = (0..2000).map(|k| share * (swing(k + 1) - swing(k)) / 0.01);
            let simulated = Simulated { velocity: velocity.collect(), ..Simulated::default() };
            share_not_followed(trials(), &[simulated]) * noise_floor(trials()).unwrap()
        };
        assert!(part(0.0) > 0.6 && (part(0.5) / part(0.0) - 0.5).abs() < 0.02);
        // Parabolas take some of a noise with a memory of 10 samples.
        assert!((0.08..0.1).contains(&part(1.0)), "{}", part(1.0));
        // What makes it worse is no reason for more noise.
        assert!((part(-1.0) - part(0.0)).abs() < 1e-12);
    }

    #[test]
    fn the_noise_of_the_sensor_needs_no_model() {
        let made = |period_s: f64, output: &dyn Fn(f64) -> f64| {
            let samples: Vec<f64> = (0..4000).map(|k| output(f64::from(k) * period_s)).collect();
            let period = SamplePeriod::from_seconds(period_s).unwrap();
            let trial = Trial::new("1", 0.0, period, vec![0.0; 4000], samples).unwrap();
            sensor_noise(&[trial]).unwrap()
        };
        let white = noise(5, 0.0, 4000);
        for period_s in [0.1, 0.01, 0.002] {
            #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "inside")]
            let index = |t: f64| (t / period_s).round() as usize;
            let found = made(period_s, &|t| 20.0 * (0.3 * t).sin() + 0.05 * white[index(t)]);
            assert!((found / 0.05 - 1.0).abs() < 0.1, "{period_s} {found}");
        }
        let rounded = made(0.01, &|t| (t - 30.0).clamp(0.0, 5.0).div_euclid(0.1) * 0.1);
        assert!((rounded / (0.1 / 12.0_f64.sqrt()) - 1.0).abs() < 0.02, "{rounded}");
        assert!(made(0.01, &|_| 7.0) == 0.0);
    }

    #[test]
    fn a_joint_that_is_never_steady_has_no_noise_floor() {
        let period = SamplePeriod::from_seconds(0.01).unwrap();
        let trial = Trial::new("1", 0.0, period, vec![0.0; 10], vec![0.0; 10]).unwrap();
        let arrivals = Arrivals { initial: 0.0, changes: Vec::new() };
        assert_eq!(noise_floor(std::iter::once((&trial, &arrivals))), None);
    }
}
