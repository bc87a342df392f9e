//! Is what a model leaves more than noise?
//!
//! The residual of an integrating joint is correlated, and so may its noise be; a test
//! that takes it for white calls every model bad. Here the residual is regressed on what a
//! missing effect could have made of it, and that regression is judged after both sides
//! were whitened:
//!
//! 1. Shapes: velocities that a missing effect might add (of the level of the input, the
//!    direction, the angle, the time, their products with the speed), integrated; and
//!    transients behind each change of the input.
//! 2. Noise: an autoregression is fitted to what the residual keeps after all shapes are
//!    taken off, so that a misfit is not mistaken for noise, and another to the residual as
//!    it is, since the shapes also take some slow noise with them. Orders are Schwarz's.
//! 3. Test: residual, shapes and the sensitivities of the model's own parameters are
//!    filtered by that autoregression. The shapes together explain `F = ((R₀ − R₁)/q) /
//!    (R₁/(n − k))` of the rest, which is Fisher's with `q` and `n − k` degrees of freedom
//!    when nothing is missing. Of the two noises, the one that makes less of it counts.
//!
//! # References
//! T. Bohlin, "Practical Grey-box Process Identification", 2006, chapter 2 (falsification
//! by alternative models). G. Schwarz, "Estimating the dimension of a model", 1978.

use nalgebra::{DMatrix, DVector};
use serde::Serialize;

use crate::statistics::fisher_tail;

/// Whether a model can be told from the truth.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct LackOfFit {
    /// F of all shapes together.
    pub statistic: f64,
    /// The probability of so much or more when nothing is missing.
    pub p_value: f64,
    /// No lack of fit is shown at [`SIGNIFICANCE`].
    pub adequate: bool,
}

/// Probability of calling a model bad that is not.
pub const SIGNIFICANCE: f64 = 0.01;

/// Longest memory of the noise, in samples, that is told from motion.
const LONGEST_MEMORY: usize = 12;

/// The columns of the test, one window below the other.
#[derive(Clone, Debug, Default)]
pub struct TestColumns {
    /// What the model leaves, per window.
    pub residuals: Vec<Vec<f64>>,
    /// Derivatives of the residual to the model's own parameters: column, window, sample.
    pub own: Vec<Vec<Vec<f64>>>,
    /// What a missing effect could add: column, window, sample.
    pub shapes: Vec<Vec<Vec<f64>>>,
}

/// Tests whether `columns.shapes` explain more of the residual than noise would.
///
/// `None` when there are too few samples.
pub fn lack_of_fit(columns: &TestColumns) -> Option<LackOfFit> {
    let own: Vec<&Vec<Vec<f64>>> = columns.own.iter().collect();
    let all: Vec<&Vec<Vec<f64>>> = own.iter().copied().chain(&columns.shapes).collect();
    let noises = [&all, &own]
        .map(|columns_| Some(autoregression(&residuals_of(&columns.residuals, columns_)?)));
    let tests = noises.map(|noise| test(columns, &noise?));
    let [after_shapes, before_shapes] = tests;
    let (a, b) = (after_shapes?, before_shapes?);
    Some(if a.p_value >= b.p_value { a } else { b })
}

/// The test, with the noise given.
fn test(columns: &TestColumns, noise: &[f64]) -> Option<LackOfFit> {
    let whiten = |column: &Vec<Vec<f64>>| whitened(column, noise);
    let residuals = whiten(&columns.residuals);
    let own: Vec<_> = columns.own.iter().map(whiten).collect();
    let shapes: Vec<_> = columns.shapes.iter().map(whiten).collect();
    let own: Vec<&Vec<Vec<f64>>> = own.iter().collect();
    let every: Vec<&Vec<Vec<f64>>> = own.iter().copied().chain(&shapes).collect();
    let samples: usize = residuals.iter().map(Vec::len).sum();
    let restricted = Regression::of(&residuals, &own);
    let full = Regression::of(&residuals, &every);
    let windows = residuals.iter().filter(|window| !window.is_empty()).count();
    let freedom = samples.checked_sub(full.rank + windows).filter(|freedom| *freedom > 0)?;
    let added = full.rank.checked_sub(restricted.rank).filter(|added| *added > 0)?;
    let explained = (restricted.error - full.error).max(0.0) / added as f64;
    let statistic = explained / (full.error / freedom as f64).max(f64::MIN_POSITIVE);
    let p_value = fisher_tail(statistic, added, freedom)?;
    Some(LackOfFit { statistic, p_value, adequate: p_value >= SIGNIFICANCE })
}

/// A least-squares regression of one column on others.
struct Regression {
    coefficients: DVector<f64>,
    /// Sum of squared errors.
    error: f64,
    /// Columns that are not combinations of others.
    rank: usize,
}

impl Regression {
    /// By the normal equations of columns of length one; combinations are left out.
    fn of(target: &[Vec<f64>], columns: &[&Vec<Vec<f64>>]) -> Self {
        /// Eigenvalues below this part of the largest belong to combinations.
        const RANK: f64 = 1e-9;
        let product = |a: &[Vec<f64>], b: &[Vec<f64>]| -> f64 {
            a.iter().zip(b).map(|(a, b)| dot(a, b)).sum()
        };
        // A column of zeros stays one.
        let length = |c: &&Vec<Vec<f64>>| Some(product(c, c).sqrt()).filter(|n| *n > 0.0);
        let lengths: Vec<f64> = columns.iter().map(|c| length(c).unwrap_or(1.0)).collect();
        let count = columns.len();
        let entry = |i: usize, j: usize| match (columns.get(i), columns.get(j)) {
            (Some(a), Some(b)) if i <= j => {
                product(a, b) / (lengths.get(i).unwrap_or(&1.0) * lengths.get(j).unwrap_or(&1.0))
            }
            _ => 0.0,
        };
        let upper = DMatrix::from_fn(count, count, entry);
        let gram = &upper + upper.transpose() - DMatrix::from_diagonal(&upper.diagonal());
        let with = columns.iter().zip(&lengths).map(|(c, n)| product(c, target) / n);
        let with = DVector::from_vec(with.collect());
        let total = product(target, target);
        if count == 0 {
            return Self { coefficients: with, error: total, rank: 0 };
        }
        let decomposed = gram.symmetric_eigen();
        let limit = RANK * decomposed.eigenvalues.max();
        let inverses = decomposed.eigenvalues.map(|v| if v > limit { 1.0 / v } else { 0.0 });
        let rotated = decomposed.eigenvectors.tr_mul(&with);
        let explained = rotated.component_mul(&rotated).dot(&inverses);
        let scaled = &decomposed.eigenvectors * rotated.component_mul(&inverses);
        let lengths = DVector::from_vec(lengths);
        Self {
            coefficients: scaled.component_div(&lengths),
            error: (total - explained).max(0.0),
            rank: inverses.iter().filter(|inverse| **inverse > 0.0).count(),
        }
    }
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// What is left of `target` after its regression on `columns`.
fn residuals_of(target: &[Vec<f64>], columns: &[&Vec<Vec<f64>>]) -> Option<Vec<Vec<f64>>> {
    let regression = Regression::of(target, columns);
    let mut left = target.to_vec();
    for (column, coefficient) in columns.iter().zip(regression.coefficients.iter()) {
        for (window, shape) in left.iter_mut().zip(column.iter()) {
            for (value, shape) in window.iter_mut().zip(shape) {
                *value -= coefficient * shape;
            }
        }
    }
    left.iter().flatten().all(|value| value.is_finite()).then_some(left)
}

/// Coefficients `a` of `e_k = Σ a_i e_(k−i) + white noise`, the order by Schwarz's
/// criterion, by the recursion of Levinson and Durbin.
fn autoregression(windows: &[Vec<f64>]) -> Vec<f64> {
    let samples: usize = windows.iter().map(Vec::len).sum();
    let covariance = |lag: usize| -> f64 {
        windows.iter().map(|w| dot(w, w.get(lag..).unwrap_or_default())).sum::<f64>()
            / samples.max(1) as f64
    };
    let most = LONGEST_MEMORY.min(samples / 10);
    let covariances: Vec<f64> = (0..=most).map(covariance).collect();
    let Some(&power) = covariances.first().filter(|power| **power > 0.0) else { return Vec::new() };
    let (mut current, mut variance): (Vec<f64>, f64) = (Vec::new(), power);
    let score = |variance: f64, order: usize| {
        samples as f64 * variance.ln() + order as f64 * (samples as f64).ln()
    };
    let mut best = (score(power, 0), Vec::new());
    for order in 1..=most {
        let predicted: f64 = current
            .iter()
            .zip(covariances.iter().take(order).skip(1).rev())
            .map(|(a, c)| a * c)
            .sum();
        let Some(reflection) = covariances.get(order).map(|c| (c - predicted) / variance) else {
            break;
        };
        let turned: Vec<f64> = current.iter().rev().copied().collect();
        for (a, b) in current.iter_mut().zip(turned) {
            *a -= reflection * b;
        }
        current.push(reflection);
        variance *= 1.0 - reflection * reflection;
        if variance <= 0.0 {
            break;
        }
        if score(variance, order) < best.0 {
            best = (score(variance, order), current.clone());
        }
    }
    best.1
}

/// `x_k − Σ a_i x_(k−i)`, and the mean of each window off; its first samples are lost.
fn whitened(windows: &[Vec<f64>], noise: &[f64]) -> Vec<Vec<f64>> {
    let order = noise.len();
    let filter = |window: &Vec<f64>| {
        let mut filtered: Vec<f64> = window
            .windows(order + 1)
            .map(|values| {
                let past = values.iter().rev().skip(1);
                let now = values.last().copied().unwrap_or_default();
                now - noise.iter().zip(past).map(|(a, x)| a * x).sum::<f64>()
            })
            .collect();
        let mean = filtered.iter().sum::<f64>() / filtered.len().max(1) as f64;
        for value in &mut filtered {
            *value -= mean;
        }
        filtered
    };
    windows.iter().map(filter).collect()
}

#[cfg(test)]
mod tests {
    use rand::SeedableRng as _;
    use rand_chacha::ChaCha8Rng;
    use rand_distr::{Distribution as _, StandardNormal};

    use super::*;

    /// Noise of first order.
    fn noise(seed: u64, rho: f64, count: usize) -> Vec<f64> {
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        let mut value = 0.0;
        let mut next = || {
            let e: f64 = StandardNormal.sample(&mut random);
            value = rho * value + (1.0 - rho * rho).sqrt() * e;
            value
        };
        (0..count + 200).map(|_| next()).skip(200).collect()
    }

    /// Slow shapes, as integrated velocities are.
    fn shapes(count: usize) -> Vec<Vec<Vec<f64>>> {
        let wave = |cycles: f64| {
            (0..count)
                .map(|k| (k as f64 * cycles / count as f64 * std::f64::consts::TAU).sin())
                .collect()
        };
        (1..=20).map(|cycles| vec![wave(f64::from(cycles) * 0.7)]).collect()
    }

    fn p_value(residuals: Vec<f64>) -> f64 {
        let shapes = shapes(residuals.len());
        lack_of_fit(&TestColumns { residuals: vec![residuals], own: Vec::new(), shapes })
            .unwrap()
            .p_value
    }

    #[test]
    fn noise_is_seldom_called_a_misfit() {
        for rho in [0.0, 0.5, 0.95] {
            let found =
                (0..200).filter(|seed| p_value(noise(*seed, rho, 4000)) < SIGNIFICANCE).count();
            // 1 % of 200 are 2; five times as many would be a bad test.
            assert!(found <= 10, "{found} of 200 at {rho}");
        }
    }

    #[test]
    fn a_misfit_as_large_as_the_noise_is_seen() {
        for (rho, amplitude) in [(0.0, 0.5), (0.5, 0.7), (0.9, 1.5)] {
            for seed in 0..10 {
                let mut residuals = noise(seed, rho, 4000);
                for (k, r) in residuals.iter_mut().enumerate() {
                    *r += amplitude * (k as f64 / 300.0).sin();
                }
                let p = p_value(residuals);
                assert!(p < SIGNIFICANCE, "{rho}: {p}");
            }
        }
    }

    #[test]
    fn the_memory_of_noise_is_found() {
        let found = autoregression(&[noise(3, 0.8, 20_000)]);
        assert!((found[0] - 0.8).abs() < 0.03, "{found:?}");
    }

    #[test]
    fn combinations_of_columns_count_once() {
        let ramp = vec![(0..100).map(f64::from).collect::<Vec<_>>()];
        let twice = vec![ramp[0].iter().map(|x| 2.0 * x).collect::<Vec<_>>()];
        let regression = Regression::of(&ramp, &[&ramp, &twice]);
        assert_eq!(regression.rank, 1);
        assert!(regression.error < 1e-6);
    }
}
