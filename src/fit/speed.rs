//! The speed of a joint where a simulation starts, from the measurement.

use super::window::Window;
use crate::experiment::Trial;

/// Samples on either side from which a speed is taken.
const SIDE: usize = 10;

/// A speed, output units per second.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Speed {
    value: f64,
    /// Its squared error in white noise.
    of_noise: f64,
    /// What it is off beyond that, squared: below zero where chance has it, but not in the
    /// mean.
    beyond: f64,
}

/// Whether the speeds at the start of `windows` are better taken from the measurement than
/// from a simulation.
///
/// A simulation carries its own errors on, and at the start of a trial knows nothing: its
/// joint is steady there. A measured speed has the error of the noise, and of a motion that
/// bends faster than it can tell. It is preferred where that is a hundredth of the speeds in
/// the record, which a model of a real joint hardly reaches.
pub(super) fn are_measured(trials: &[Trial], windows: &[Window]) -> bool {
    /// Largest error of speeds, in parts of their root mean square.
    const ERROR: f64 = 0.01;
    let speeds = || windows.iter().filter_map(|w| Speed::at(trials.get(w.trial)?, w.start));
    let whole = trials.iter().flat_map(|trial| {
        (SIDE..trial.len()).step_by(SIDE).filter_map(|sample| Speed::at(trial, sample))
    });
    let mean = |values: &mut dyn Iterator<Item = f64>| {
        let (sum, count) = values.fold((0.0, 0.0), |(sum, n), value| (sum + value, n + 1.0));
        sum / f64::max(count, 1.0)
    };
    let beyond = mean(&mut speeds().map(|speed| speed.beyond));
    let error = mean(&mut speeds().map(|speed| speed.of_noise)) + beyond.max(0.0);
    error < ERROR * ERROR * mean(&mut whole.map(|speed| speed.value * speed.value))
}

/// The measured speed at a sample; `None` in a trial that is too short.
pub(super) fn measured(trial: &Trial, sample: usize) -> Option<f64> {
    Speed::at(trial, sample).map(|speed| speed.value)
}

impl Speed {
    /// From the best parabola around `sample`, or after the start of the trial.
    ///
    /// With `x` from the middle, and polynomials that are orthogonal on the grid, it is
    /// `a + b x + c (x² − mean x²)`, with the slope `b + 2 c x`.
    ///
    /// Its error is what white noise does, and what a cubic would change beyond that: noise
    /// with a memory, and jerk, leave little beside a short parabola and still turn it.
    fn at(trial: &Trial, sample: usize) -> Option<Self> {
        let from = sample.saturating_sub(SIDE).min(trial.len().saturating_sub(2 * SIDE + 1));
        let values = trial.output().get(from..=from + 2 * SIDE)?;
        let (middle, offset) = (values.get(SIDE)?, sample.checked_sub(from)?);
        let offset = (offset <= 2 * SIDE).then_some(offset as f64 - SIDE as f64)?;
        let n = values.len() as f64;
        let x = |k: usize| k as f64 - SIDE as f64;
        let (square, odd) = ((n * n - 1.0) / 12.0, (3.0 * n * n - 7.0) / 20.0);
        let project = |shape: &dyn Fn(f64) -> f64| {
            let (mut with, mut own) = (0.0, 0.0);
            for (k, y) in values.iter().enumerate() {
                with += shape(x(k)) * (y - middle);
                own += shape(x(k)) * shape(x(k));
            }
            (with / own, own)
        };
        let (mean, _) = project(&|_| 1.0);
        let (slope, linear) = project(&|x| x);
        let (bend, quadratic) = project(&|x| x * x - square);
        let rest = values.iter().enumerate().map(|(k, y)| {
            let parabola = mean + slope * x(k) + bend * (x(k) * x(k) - square);
            (y - middle - parabola).powi(2)
        });
        let variance = rest.sum::<f64>() / (n - 3.0);
        let of_slope = variance * (1.0 / linear + 4.0 * offset * offset / quadratic);
        let (twist, cubic) = project(&|x| x * x * x - odd * x);
        let turn = 3.0 * offset * offset - odd;
        let beyond = turn * turn * (twist * twist - variance / cubic);
        let period = trial.period().seconds();
        Some(Self {
            value: (slope + 2.0 * bend * offset) / period,
            of_noise: of_slope / (period * period),
            beyond: beyond / (period * period),
        })
    }
}

#[cfg(test)]
mod tests {
    use rand::SeedableRng as _;
    use rand_chacha::ChaCha8Rng;
    use rand_distr::{Distribution as _, StandardNormal};

    use super::*;
    use crate::units::SamplePeriod;

    fn trial(output: impl Fn(f64) -> f64) -> Trial {
        let period = SamplePeriod::from_seconds(0.1).unwrap();
        let output = (0..50).map(|k| output(0.1 * f64::from(k))).collect();
        Trial::new("a", 0.0, period, vec![0.0; 50], output).unwrap()
    }

    #[test]
    fn of_a_parabola_it_is_exact_everywhere() {
        let trial = trial(|t| 7.0 + 3.0 * t - 2.0 * t * t);
        for sample in [0, 5, 10, 30, 49] {
            let speed = Speed::at(&trial, sample).unwrap();
            let expected = 3.0 - 4.0 * 0.1 * sample as f64;
            assert!((speed.value - expected).abs() < 1e-9);
            assert!(speed.of_noise < 1e-18 && speed.beyond < 1e-18);
        }
        assert_eq!(measured(&trial, 50), None);
    }

    #[test]
    fn noise_decides() {
        let window = Window {
            trial: 0,
            start: 20,
            end: 50,
            part: super::super::Part::Training,
            restarts: true,
        };
        let noisy = |size: f64| trial(|t| 3.0 * t + size * (97.0 * t).sin());
        assert!(are_measured(&[noisy(0.001)], &[window]));
        assert!(!are_measured(&[noisy(0.3)], &[window]));
    }

    #[test]
    fn the_squared_error_is_right_in_the_mean_for_white_noise_and_not_too_small_for_jerk() {
        const WINDOWS: usize = 20_000;
        let mut random = ChaCha8Rng::seed_from_u64(7);
        let noise: Vec<f64> =
            (0..21 * WINDOWS).map(|_| StandardNormal.sample(&mut random)).collect();
        let errors = |size: f64, jerk: f64| {
            let output = (0..).zip(&noise).map(|(k, noise)| {
                let x = f64::from(k % 21) - 10.0;
                size * noise + jerk * x * x * x
            });
            let period = SamplePeriod::from_seconds(1.0).unwrap();
            let output: Vec<f64> = output.collect();
            let trial = Trial::new("a", 0.0, period, vec![0.0; output.len()], output).unwrap();
            let found = (0..WINDOWS).map(|i| Speed::at(&trial, 21 * i + 10).unwrap());
            let (reported, is) = found.fold((0.0, 0.0), |(reported, is), speed| {
                (reported + speed.of_noise + speed.beyond, is + speed.value * speed.value)
            });
            reported / is
        };
        let white = errors(1.0, 0.0);
        assert!((white - 1.0).abs() < 0.15, "{white}");
        assert!(errors(1e-9, 1.0) > 0.9);
    }
}
