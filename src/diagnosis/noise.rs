//! The noise of the sensor, from the record alone.

use crate::experiment::{Property, Record, Trial};
use crate::fit::is_rounding;
use crate::numerics::{least_change, median};

/// Seconds of a window: short beside the motion of a hydraulic joint.
const WINDOW_S: f64 = 0.2;

/// Fewest samples of a window: three go into its parabola.
const FEWEST: usize = 8;

/// Standard deviation of the noise of the sensor, output units: one number for a record, whatever
/// the model. `None` where every trial is too short, and where the log does not resolve it: where
/// windows leave no more than the rounding of a double.
///
/// Each window of 0.2 s is fitted by a parabola; the median of the residual variances
/// `Σ r² / (n − 3)` is that of the noise. A sensor that shows none where the joint rests has at
/// least that of its rounding, `q/√12` with the least change `q` (B. Widrow and I. Kollár,
/// "Quantization Noise", 2008). Motion within fractions of 0.2 s counts as noise; noise that is
/// slower than that does not.
pub fn sensor_noise(record: &Record) -> Option<f64> {
    record.property::<SensorNoise>().0
}

/// The [`sensor_noise`] of a record.
#[derive(Debug)]
struct SensorNoise(Option<f64>);

impl Property for SensorNoise {
    fn find(record: &Record) -> Self {
        let windows = || {
            record.iter().flat_map(|trial| {
                #[expect(
                    clippy::cast_possible_truncation,
                    clippy::cast_sign_loss,
                    reason = "small"
                )]
                let samples = (WINDOW_S / trial.period().seconds()).round() as usize;
                trial.output().chunks_exact(samples.max(FEWEST))
            })
        };
        let of = |windows: &mut dyn Iterator<Item = &[f64]>| {
            let variances = windows.map(about_parabola).filter(|variance| variance.is_finite());
            variances.collect::<Vec<f64>>()
        };
        let is_moving = |window: &&[f64]| window.first() != window.last();
        let (variances, moving) = (of(&mut windows()), of(&mut windows().filter(is_moving)));
        // Windows in which the joint starts or stops leave more; they are the fewer.
        let seen =
            median(&variances).map(|variance| variance.sqrt().max(rounding(record, &moving)));
        Self(seen.filter(|noise| !is_rounding(record, *noise)))
    }
}

/// Standard deviation of the rounding of an output: of its least change, where that is a step of
/// its scale, so that all changes are multiples of it, and where it shows while the joint moves: a
/// simulated motion along lines has changes that are multiples of one, too, and no rounding.
fn rounding(trials: &[Trial], moving: &[f64]) -> f64 {
    /// Part of the rounding that windows of a moving joint leave at least: parabolas take some.
    const SHOWS: f64 = 0.1;
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
    let rounding = least / 12.0_f64.sqrt();
    let shows = median(moving).is_none_or(|variance| variance.sqrt() > SHOWS * rounding);
    if is_step && shows { rounding } else { 0.0 }
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
    use crate::numerics::testing::noise;
    use crate::units::SamplePeriod;

    #[test]
    fn a_parabola_has_no_residual() {
        let parabola: Vec<f64> =
            (0..50).map(|k| 1e3 + 2.0 * f64::from(k) - 0.1 * f64::from(k * k)).collect();
        assert!(about_parabola(&parabola) < 1e-12);
    }

    #[test]
    fn the_noise_of_the_sensor_needs_no_model() {
        let made = |period_s: f64, output: &dyn Fn(f64) -> f64| {
            let samples: Vec<f64> = (0..4000).map(|k| output(f64::from(k) * period_s)).collect();
            let period = SamplePeriod::from_seconds(period_s).unwrap();
            let trial = Trial::new("1", 0.0, period, vec![0.0; 4000], samples).unwrap();
            sensor_noise(&[trial].into())
        };
        let white = noise(5, 0.0, 4000);
        for period_s in [0.1, 0.01, 0.002] {
            #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "inside")]
            let index = |t: f64| (t / period_s).round() as usize;
            let found = made(period_s, &|t| 20.0 * (0.3 * t).sin() + 0.05 * white[index(t)]);
            let found = found.unwrap();
            assert!((found / 0.05 - 1.0).abs() < 0.1, "{period_s} {found}");
        }
        let rounded = made(0.01, &|t| (t - 30.0).clamp(0.0, 5.0).div_euclid(0.1) * 0.1);
        let rounded = rounded.unwrap();
        assert!((rounded / (0.1 / 12.0_f64.sqrt()) - 1.0).abs() < 0.02, "{rounded}");
        assert_eq!(made(0.01, &|_| 7.0), None);
        let line = |t: f64| 0.1 + 3.0 * t;
        assert_eq!(made(0.01, &line), None, "a double rounds, no sensor");
    }
}
