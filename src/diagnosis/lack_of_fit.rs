//! Is the residual of a model more than noise?
//!
//! The residual of an integrating joint is correlated, and so may its noise be; a test
//! that takes it for white calls every model bad. Here the residual is regressed on what a
//! missing effect could have made of it, and that regression is judged after both sides
//! were whitened:
//!
//! 1. Shapes: velocities that a missing effect might add (of the level of the input, the
//!    direction, the angle, the time, their products with the speed), integrated; and
//!    transients after each change of the input.
//! 2. Noise: an autoregression is fitted to what the residual keeps after all shapes are
//!    subtracted, so that a misfit is not mistaken for noise, and another to the residual as
//!    it is, since the shapes also take some slow noise with them, though only so much. Orders
//!    are Schwarz's.
//! 3. Test: residual, shapes and the sensitivities of the model's own parameters are
//!    filtered by that autoregression. The shapes together explain `F = ((R₀ − R₁)/q) /
//!    (R₁/(n − k))` of the rest, which is Fisher's with `q` and `n − k` degrees of freedom
//!    when nothing is missing. Of the two noises, the one that makes less of it counts; only
//!    the first where the residual is too large for noise, or the shapes take more of it than
//!    of any noise.
//! 4. Size: the test holds all that changes slowly for noise, and finds every trace in a long
//!    record. Up to 1.15 times the noise of the measurement it is negligible, unless what the
//!    shapes do not explain is less than half of that noise; beyond three times it is no
//!    noise. Nor is it noise where it is larger on the part that was not fitted.
//! 5. Evenness: nor is it where it stands out in a few windows ([`LocalMisfit`]).
//! 6. Times of the steps: where a lack of fit is shown, and the steps of the input lie between
//!    the samples of the log, the test is made again without what their times explain
//!    ([`InputEdges`]).
//!
//! # References
//! T. Bohlin, "Practical Grey-box Process Identification", 2006, chapter 2 (falsification
//! by alternative models). G. Schwarz, "Estimating the dimension of a model", 1978.

use serde::Serialize;

use super::input_edges::InputEdges;
use super::local_misfit::LocalMisfit;
use super::residual_size::{
    BEYOND_NOISE, NEAR_NOISE, ResidualSize, ShownBy, SizeVerdict, independent,
};
use crate::numerics::NoiseModel;
use crate::numerics::fisher_tail;
use crate::numerics::{Regression, residuals_of};

/// Whether the residual shows that a model lacks something.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct LackOfFit {
    /// F of all shapes together.
    pub statistic: f64,
    /// The probability of so much or more when nothing is missing.
    pub p_value: f64,
    /// The part of the squared residual that the shapes explain, before whitening.
    pub misfit_share: f64,
    /// The root mean square residual over the noise of the measurement, where it is known.
    pub times_noise: Option<f64>,
    /// The root mean square residual of the part that was not fitted over that of the part
    /// that was.
    pub times_training: Option<f64>,
    /// Where the residual stands out most; `None` where there are too few windows.
    pub local: Option<LocalMisfit>,
    /// What shows it, where it is shown; the first of these that does.
    pub shown_by: Option<ShownBy>,
    /// Where no lack of fit is left but for the times of the steps, what they explain.
    #[serde(rename = "input_edges", skip_serializing_if = "Option::is_none")]
    pub edges: Option<InputEdges>,
    /// No lack of fit is shown at [`SIGNIFICANCE`], or one that is below [`NEGLIGIBLE`]; near
    /// the noise always, far beyond it never, nor where the error is larger on data that were
    /// not fitted, nor where it stands out in a part of the record.
    pub adequate: bool,
}

/// Probability of calling a model bad that is not.
pub const SIGNIFICANCE: f64 = 0.001;

/// A misfit that explains a smaller part of the squared residual than this is negligible,
/// however significant: without it the error would be 1 % less.
pub const NEGLIGIBLE: f64 = 0.02;

/// A column of the test: window, sample.
pub type Column = Vec<Vec<f64>>;

/// The columns of the test, one window below the other, but for the shapes.
#[derive(Clone, Debug, Default)]
pub struct TestColumns {
    /// The residual of the model, per window.
    pub residuals: Column,
    /// Derivatives of the residual to the model's own parameters.
    pub own: Vec<Column>,
    /// How large the residuals are.
    pub size: ResidualSize,
    /// Where they stand out most.
    pub local: Option<LocalMisfit>,
}

/// Tests whether `shapes`, what a missing effect could add, explain more of the residual than
/// noise would. They are made once for each noise: there are dozens of them, and two sets would
/// be most of the memory that a long record takes.
///
/// `None` when there are too few samples.
pub fn lack_of_fit(columns: &TestColumns, shapes: impl Fn() -> Vec<Column>) -> Option<LackOfFit> {
    let made = shapes();
    let count = made.len();
    let own: Vec<&Column> = columns.own.iter().collect();
    let all: Vec<&Column> = own.iter().copied().chain(&made).collect();
    let before_shapes = residuals_of(&columns.residuals, &own)?;
    let after_shapes = residuals_of(&columns.residuals, &all)?;
    let [whole, rest] = [&before_shapes, &after_shapes].map(|r| square(r));
    let misfit_share = if whole > 0.0 { (1.0 - rest / whole).max(0.0) } else { 0.0 };
    // Step 2: the noise without the shapes, and, where it may be, with what they took of it.
    let mut judged = vec![test(columns, made, &NoiseModel::of_centred(&after_shapes))?];
    let is_small = columns.size.times_noise.is_none_or(|times| times <= BEYOND_NOISE);
    if is_small && misfit_share <= most_by_chance(columns, count) {
        judged.push(test(columns, shapes(), &NoiseModel::of_centred(&before_shapes))?);
    }
    // Step 3: of two noises the one that makes less of the residual.
    let (statistic, p_value) = judged.into_iter().max_by(|a, b| a.1.total_cmp(&b.1))?;
    let by_shapes = p_value < SIGNIFICANCE && misfit_share >= NEGLIGIBLE;
    let noise_is_known = is_noise(columns.size.times_noise, misfit_share);
    // Step 4, and then step 5.
    let as_a_whole = match columns.size.verdict() {
        Some(SizeVerdict::Misfit(shown_by)) => Some(shown_by),
        Some(SizeVerdict::Noise) if noise_is_known => None,
        Some(SizeVerdict::Noise) | None => by_shapes.then_some(ShownBy::Shapes),
    };
    let is_uneven = columns.local.is_some_and(|local| local.is_shown());
    let shown_by = as_a_whole.or_else(|| is_uneven.then_some(ShownBy::FewWindows));
    let ResidualSize { times_noise, times_training, .. } = columns.size;
    Some(LackOfFit {
        statistic,
        p_value,
        misfit_share,
        times_noise,
        times_training,
        local: columns.local,
        shown_by,
        edges: None,
        adequate: shown_by.is_none(),
    })
}

/// The part of the square of noise that the shapes may take, however long its memory.
///
/// So many parameters take `q` of as many independent values as there are: of `n` samples with
/// the correlation `ρ` that is `n (1 − ρ²) / (1 + ρ²)`.
fn most_by_chance(columns: &TestColumns, shapes: usize) -> f64 {
    /// Times what is expected: four in ten of a record of two minutes with noise of `ρ` = 0.95,
    /// where the most of a hundred such records was two in ten.
    const TIMES: f64 = 3.0;
    let samples: usize = columns.residuals.iter().map(Vec::len).sum();
    TIMES * shapes as f64 / independent(samples)
}

/// Whether what is held for the noise can be it: noise is no larger than the residual that the
/// shapes do not explain. Where a joint rings through its holds, the noise found there is motion.
fn is_noise(times_noise: Option<f64>, misfit_share: f64) -> bool {
    /// Part of the noise that remains at least: shapes explain some of a slow one, too.
    const LEFT: f64 = 0.5;
    times_noise.is_none_or(|times| times * (1.0 - misfit_share).max(0.0).sqrt() > LEFT)
}

impl LackOfFit {
    /// This test, of a residual that shows no lack of fit without what `edges` explain of it.
    #[must_use]
    pub(super) fn but_for(self, edges: InputEdges) -> Self {
        Self { shown_by: None, edges: Some(edges), adequate: true, ..self }
    }

    /// Whether the residual is hardly more than the noise.
    pub(crate) fn is_near_noise(&self) -> bool {
        self.times_noise.is_some_and(|times| times <= NEAR_NOISE)
    }
}

fn square(windows: &[Vec<f64>]) -> f64 {
    windows.iter().flatten().map(|value| value * value).sum()
}

/// Statistic and p-value, with the noise given.
fn test(columns: &TestColumns, shapes: Vec<Column>, noise: &NoiseModel) -> Option<(f64, f64)> {
    let whiten = |column: &Column| noise.whitened(column);
    let residuals = whiten(&columns.residuals);
    let own: Vec<Column> = columns.own.iter().map(whiten).collect();
    // Each shape is given up as soon as it is whitened.
    let shapes: Vec<Column> = shapes.into_iter().map(|shape| whiten(&shape)).collect();
    let own: Vec<&Column> = own.iter().collect();
    let every: Vec<&Column> = own.iter().copied().chain(&shapes).collect();
    let samples: usize = residuals.iter().map(Vec::len).sum();
    let restricted = Regression::of(&residuals, &own);
    let full = Regression::of(&residuals, &every);
    let windows = residuals.iter().filter(|window| !window.is_empty()).count();
    // Each window has lost its mean as well.
    let freedom = samples.checked_sub(full.rank + windows).filter(|freedom| *freedom > 0)?;
    let added = full.rank.checked_sub(restricted.rank).filter(|added| *added > 0)?;
    // (R₀ − R₁)/q.
    let explained = (restricted.error - full.error).max(0.0) / added as f64;
    let statistic = explained / (full.error / freedom as f64).max(f64::MIN_POSITIVE);
    Some((statistic, fisher_tail(statistic, added, freedom)?))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::numerics::testing::noise;

    /// Slow shapes, as integrated velocities are.
    fn shapes(count: usize) -> Vec<Column> {
        let wave = |cycles: f64| {
            (0..count)
                .map(|k| (k as f64 * cycles / count as f64 * std::f64::consts::TAU).sin())
                .collect()
        };
        (1..=20).map(|cycles| vec![wave(f64::from(cycles) * 0.7)]).collect()
    }

    fn p_value(residuals: Vec<f64>) -> f64 {
        let shapes = shapes(residuals.len());
        let columns = TestColumns { residuals: vec![residuals], ..TestColumns::default() };
        lack_of_fit(&columns, || shapes.clone()).unwrap().p_value
    }

    #[test]
    fn noise_is_seldom_called_a_misfit() {
        for rho in [0.0, 0.5, 0.95] {
            let found =
                (0..60).filter(|seed| p_value(noise(*seed, rho, 4000)) < SIGNIFICANCE).count();
            // 0.1 % of 60 are none; 4 would be a bad test.
            assert!(found < 4, "{found} of 60 at {rho}");
        }
    }

    #[test]
    fn a_misfit_of_the_size_of_the_noise_is_seen() {
        for (rho, amplitude) in [(0.0, 0.5), (0.5, 0.7), (0.9, 1.5)] {
            for seed in 0..10 {
                let mut residuals = noise(seed, rho, 4000);
                for (k, r) in residuals.iter_mut().enumerate() {
                    *r += amplitude * (k as f64 / 300.0).sin();
                }
                let p = p_value(residuals);
                assert!(p < 0.01, "{rho}: {p}");
            }
        }
    }

    /// Where a joint rings through its holds, a parabola leaves of it what passes for noise.
    #[test]
    fn motion_that_was_taken_for_noise_is_no_noise() {
        let verdict = |residuals: Vec<f64>| {
            let mut size = ResidualSize::default();
            size.times_noise = Some(0.98);
            let (shapes, residuals) = (shapes(residuals.len()), vec![residuals]);
            let columns = TestColumns { residuals, size, ..TestColumns::default() };
            lack_of_fit(&columns, || shapes.clone()).unwrap()
        };
        let rung = |(k, r): (usize, f64)| {
            20.0 * (k as f64 * 2.1 / 4000.0 * std::f64::consts::TAU).sin() + r
        };
        let rings = noise(1, 0.0, 4000).into_iter().enumerate().map(rung).collect();
        assert_eq!(verdict(rings).shown_by, Some(ShownBy::Shapes));
        for rho in [0.0, 0.9, 0.95] {
            assert!((0..20).all(|seed| verdict(noise(seed, rho, 4000)).adequate), "{rho}");
        }
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
