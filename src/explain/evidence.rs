//! How likely a record is under each of several models.
//!
//! The noise of the measurement may have a memory. One autoregression is fitted to the residual
//! of the best model; the residuals of all models are filtered by it, and what remains is
//! held to be white. With sums of squares `R_t` of `n_t` samples that were fitted with `k`
//! parameters, and `R_v` of `n_v` samples that were not, a model is judged by
//!
//! ```text
//! n_t ln R_t + k ln n_t + n_v ln R_v
//! ```
//!
//! which is twice its negative log-likelihood with Schwarz's penalty on the part that was
//! fitted.
//!
//! Whether a model is better than a simpler one is tested twice. Fisher's test compares the
//! `R_t + R_v`. While much is still missing from both models, though, the memory of the best
//! one's residual is not that of the noise, and the filter can hide what is plain to see. So the
//! residuals `e` of the simpler one in all windows, fitted or not, are also regressed, without
//! whitening, on the change `d` that the other makes to them, with a variance that is robust to
//! any memory within a window (Liang and Zeger's sandwich, each window being a cluster, with the
//! leave-one-out correction of Bell and `McCaffrey`):
//!
//! ```text
//! β = Σ e·d / D,   D = Σ D_w,   D_w = |d_w|²,   h_w = D_w / D
//! var β = Σ_w ((e − β d)_w · d_w / (1 − h_w))² / D²
//! ```
//!
//! `β² / (var β · q)` is compared with Fisher's distribution for `q` parameters that were
//! added and as many windows as `d` is spread over, `D² / Σ D_w²`. An effect that acts in a
//! few windows only is beyond this test, and left to the first.
//!
//! # References
//! G. Schwarz, "Estimating the dimension of a model", Annals of Statistics 6 (1978), 461-464.
//! K.-Y. Liang and S. L. Zeger, "Longitudinal data analysis using generalized linear models",
//! Biometrika 73 (1986), 13-22. R. M. Bell and D. F. `McCaffrey`, "Bias reduction in standard
//! errors for linear regression with multi-stage samples", Survey Methodology 28 (2002), 169-181.

use crate::diagnosis::{BEYOND_NOISE, ErrorFigures, sensor_noise};
use crate::fit::{Fit, FitRecord, Part, Status};
use crate::numerics::NoiseModel;
use crate::numerics::fisher_tail;

/// The memory of a record's noise, as the residual of the best model shows it.
#[derive(Clone, Debug)]
pub(super) struct NoiseMemory {
    /// White where the residual is a misfit.
    model: NoiseModel,
}

/// One model's residuals.
#[derive(Clone, Debug)]
pub(super) struct Evidence {
    training: Squares,
    validation: Squares,
    /// The residuals of each window of both parts, not whitened.
    windows: Vec<Vec<f64>>,
    /// Parameters that were fitted.
    parameters: usize,
}

#[derive(Clone, Copy, Debug)]
struct Squares {
    sum: f64,
    samples: usize,
}

impl NoiseMemory {
    /// The memory of the residual of `fit`, both parts together.
    ///
    /// What is far more than the noise of the measurement is a misfit, whose memory is not that
    /// of the noise: models are then compared as if the noise were white.
    pub(super) fn of(record: &FitRecord<'_>, fit: &Fit) -> Self {
        let mut windows = record.cut(&fit.evaluation.residuals, Part::Training);
        windows.extend(record.cut(&fit.evaluation.residuals, Part::Validation));
        let error = ErrorFigures::of_record(record, &fit.evaluation);
        let is_misfit = error
            .zip(sensor_noise(&record.measured().trials))
            .is_some_and(|(error, floor)| error.rmse > BEYOND_NOISE * floor);
        let white = NoiseModel::white;
        Self { model: if is_misfit { white() } else { NoiseModel::of_centred(&windows) } }
    }

    /// The evidence of the model of `fit`.
    pub(super) fn evidence(&self, record: &FitRecord<'_>, fit: &Fit) -> Evidence {
        let cut = |part| record.cut(&fit.evaluation.residuals, part);
        let squares = |windows: &[Vec<f64>]| {
            let windows = self.model.whitened(windows);
            let sum: f64 = windows.iter().flatten().map(|e| e * e).sum();
            Squares { sum, samples: windows.iter().map(Vec::len).sum() }
        };
        let (mut windows, unseen) = (cut(Part::Training), cut(Part::Validation));
        let (training, validation) = (squares(&windows), squares(&unseen));
        windows.extend(unseen);
        Evidence { training, validation, windows, parameters: parameters(record, fit) }
    }
}

impl Evidence {
    /// Schwarz's criterion, `n_t ln R_t + k ln n_t + n_v ln R_v` but for a constant: less is
    /// better.
    pub(super) fn criterion(&self) -> f64 {
        let penalty = self.parameters as f64 * (self.training.samples.max(2) as f64).ln();
        self.deviance() + penalty
    }

    /// The criterion without its penalty: twice the negative log-likelihood.
    pub(super) fn deviance(&self) -> f64 {
        self.training.deviance() + self.validation.deviance()
    }

    /// This evidence beside a simpler model that is no special case of it: the way from that to
    /// the nearest of its own is a direction in which noise may lie, too, and counts as a
    /// parameter.
    pub(super) fn not_nested(self) -> Self {
        Self { parameters: self.parameters + 1, ..self }
    }

    /// The p-value of what this model explains beyond a simpler one: the smaller of two tests',
    /// times two (Bonferroni).
    pub(super) fn p_value_against(&self, simpler: &Self) -> f64 {
        const TESTS: f64 = 2.0;
        let smaller = self.fisher_p_value(simpler).min(self.p_value_over_windows(simpler));
        (TESTS * smaller).min(1.0)
    }

    /// The p-value of Fisher's test of this model against one with fewer parameters, on both parts:
    ///
    /// ```text
    /// F = ((R₀ − R) / (k − k₀)) / (R / (n − k)),   R = R_t + R_v,   n = n_t + n_v
    /// ```
    ///
    /// By chance parameters gain no more on the part that was not fitted than on the other, so that
    /// the test is no looser than on that alone.
    fn fisher_p_value(&self, simpler: &Self) -> f64 {
        let added = self.parameters.saturating_sub(simpler.parameters).max(1);
        let (own, other) = (self.both_parts(), simpler.both_parts());
        let freedom = own.samples.saturating_sub(self.parameters).max(1);
        let gained = (other.sum - own.sum).max(0.0) / added as f64;
        let variance = (own.sum / freedom as f64).max(f64::MIN_POSITIVE);
        fisher_tail(gained / variance, added, freedom).unwrap_or(1.0)
    }

    fn both_parts(&self) -> Squares {
        let Self { training, validation, .. } = self;
        Squares {
            sum: training.sum + validation.sum,
            samples: training.samples + validation.samples,
        }
    }

    /// The p-value of what this model explains beyond another in many windows: see the
    /// [module](self). 1 where it is spread over too few.
    pub(super) fn p_value_over_windows(&self, other: &Self) -> f64 {
        self.beyond_over_windows(other).1
    }

    /// Whether many windows show, at `level`, that this model is nearer to what was measured than
    /// `other`: of what separates the two, more than half is missing from the other.
    pub(super) fn is_nearer_over_windows(&self, other: &Self, level: f64) -> bool {
        let (share, p_value) = self.beyond_over_windows(other);
        share > 0.5 && p_value < level
    }

    /// The share `β` of the change from `other` to this model that is in the residual of `other`,
    /// and its p-value.
    fn beyond_over_windows(&self, other: &Self) -> (f64, f64) {
        let pairs = other.windows.iter().zip(&self.windows);
        let windows: Vec<_> = pairs.map(|(before, after)| WindowSums::of(before, after)).collect();
        let sum = |of: &dyn Fn(&WindowSums) -> f64| windows.iter().map(of).sum::<f64>();
        // D = Σ D_w and β = Σ e·d / D.
        let whole = sum(&|window| window.change_squared);
        let slope = sum(&|window| window.residual_by_change) / whole;
        // As many windows as d is spread over: D² / Σ D_w².
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a count")]
        let spread = (whole * whole / sum(&|window| window.change_squared.powi(2))) as usize;
        // var β = Σ_w ((e − β d)_w · d_w / (1 − h_w))² / D², with the leverage h_w = D_w / D.
        let squared_score = |window: &WindowSums| {
            let score = window.residual_by_change - slope * window.change_squared;
            (score / (1.0 - window.change_squared / whole)).powi(2)
        };
        let variance = (sum(&squared_score) / (whole * whole)).max(f64::MIN_POSITIVE);
        // F = β² / (var β · q), one-sided: a change against the residual explains nothing.
        let added = self.parameters.saturating_sub(other.parameters).max(1);
        let statistic = slope * slope / (variance * added as f64);
        let p_value = if slope > 0.0 {
            fisher_tail(statistic, added, spread.saturating_sub(added)).unwrap_or(1.0)
        } else {
            1.0
        };
        (slope, p_value)
    }
}

/// What one window adds to the regression of residuals on their change.
struct WindowSums {
    /// `e_w · d_w`.
    residual_by_change: f64,
    /// `D_w = |d_w|²`.
    change_squared: f64,
}

impl WindowSums {
    /// Of the residuals `before` and `after` an effect was added.
    fn of(before: &[f64], after: &[f64]) -> Self {
        let pairs = || before.iter().zip(after).map(|(before, after)| (before, before - after));
        Self {
            residual_by_change: pairs().map(|(e, d)| e * d).sum(),
            change_squared: pairs().map(|(_, d)| d * d).sum(),
        }
    }
}

impl Squares {
    /// Twice the negative log-likelihood of white noise of unknown variance: `n ln (R / n)`.
    fn deviance(self) -> f64 {
        if self.samples == 0 {
            return 0.0;
        }
        self.samples as f64 * (self.sum / self.samples as f64).max(f64::MIN_POSITIVE).ln()
    }
}

/// Parameters that were fitted, and delays that were measured.
fn parameters(record: &FitRecord<'_>, fit: &Fit) -> usize {
    let fitted = fit.parameters.iter().filter(|parameter| parameter.status != Status::Fixed);
    fitted.count() + record.measured_delays(&fit.model)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::numerics::testing::noise;

    fn evidence(sum: f64, parameters: usize) -> Evidence {
        let training = Squares { sum, samples: 1000 };
        let validation = Squares { sum: 400.0, samples: 400 };
        Evidence { training, validation, windows: Vec::new(), parameters }
    }

    #[test]
    fn a_parameter_must_earn_its_penalty() {
        let plain = evidence(1000.0, 2);
        // One parameter gains about 1 of 1000 by chance, and must gain ln 1000 = 6.9.
        assert!(evidence(999.0, 3).criterion() > plain.criterion());
        assert!(evidence(990.0, 3).criterion() < plain.criterion());
    }

    #[test]
    fn fisher_judges_what_a_parameter_gains() {
        let plain = evidence(1000.0, 2);
        // F(1, 997) of 2.7 is exceeded with probability 0.10, of 10 with 0.0016.
        let by = |gain: f64| evidence(1000.0 - gain, 3).fisher_p_value(&plain);
        assert!((by(2.7) - 0.1).abs() < 0.01 && (by(10.0) - 0.0015).abs() < 0.0003);
    }

    #[test]
    fn what_only_the_part_shows_that_was_not_fitted_counts() {
        let plain = evidence(1000.0, 2);
        let validation = Squares { sum: 200.0, samples: 400 };
        let found = Evidence { validation, ..evidence(1000.0, 3) };
        assert!(found.fisher_p_value(&plain) < 1e-9);
        // What is lost there counts against what the fit gained.
        let validation = Squares { sum: 430.0, samples: 400 };
        let lost = Evidence { validation, ..evidence(980.0, 3) };
        assert!((lost.fisher_p_value(&plain) - 1.0).abs() < 1e-9);
    }

    #[test]
    fn the_way_to_a_model_that_does_not_nest_counts_as_a_parameter() {
        // One parameter turns a shift of any size: it meets the larger part of noise in two
        // directions, whose square is beyond 9.21 with probability 0.01.
        let plain = evidence(1000.0, 2);
        let found = |parameters| evidence(1000.0 - 9.21, parameters);
        let nested = found(3).fisher_p_value(&plain);
        let apart = found(3).not_nested().fisher_p_value(&plain);
        assert!((apart - 0.01).abs() < 0.001 && nested < 0.003);
        // Without a parameter of its own there is only the way.
        assert!((found(2).not_nested().fisher_p_value(&plain) / nested - 1.0).abs() < 1e-9);
    }

    /// Windows of 50 samples of noise with a memory, with `effect` in each window.
    fn windows(seed: u64, effect: impl Fn(usize) -> f64) -> Vec<Vec<f64>> {
        let values = noise(seed, 0.95, 50 * 60);
        let window = |(index, values): (usize, &[f64])| {
            let with = |(k, e): (usize, &f64)| e + effect(index) * k as f64;
            values.iter().enumerate().map(with).collect()
        };
        values.chunks(50).enumerate().map(window).collect()
    }

    /// The test of a model that explains `slope` times a ramp in each window, fitted.
    fn of_ramp(seed: u64, effect: impl Fn(usize) -> f64, parameters: usize) -> f64 {
        let before = windows(seed, effect);
        let ramp = || before.iter().flat_map(|w| (0..w.len()).map(|k| k as f64));
        let with: f64 = ramp().zip(before.iter().flatten()).map(|(x, e)| x * e).sum();
        let slope = with / ramp().map(|x| x * x).sum::<f64>();
        let less = |w: &Vec<f64>| w.iter().enumerate().map(|(k, e)| e - slope * k as f64).collect();
        let after =
            Evidence { windows: before.iter().map(less).collect(), ..evidence(1.0, parameters) };
        after.p_value_over_windows(&Evidence { windows: before, ..evidence(1.0, 2) })
    }

    #[test]
    fn noise_with_a_memory_is_no_effect_whatever_the_windows_show() {
        let of_noise: Vec<f64> = (0..400).map(|seed| of_ramp(seed, |_| 0.0, 3)).collect();
        let below = |limit: f64| of_noise.iter().filter(|p| **p < limit).count();
        assert!((20..=60).contains(&below(0.1)), "{} of 400", below(0.1));
        assert!(below(0.001) <= 3, "{} of 400", below(0.001));
    }

    #[test]
    fn an_effect_in_many_windows_shows_and_one_in_a_single_window_does_not() {
        assert!(of_ramp(7, |_| 0.1, 3) < 1e-6);
        assert!(of_ramp(7, |index| if index % 3 == 0 { 0.3 } else { 0.0 }, 3) < 1e-3);
        let once = Evidence { windows: vec![vec![0.0, 0.0], vec![0.0, 0.0]], ..evidence(1.0, 3) };
        let before = vec![vec![1.0, 5.0], vec![0.0, 0.0]];
        let before = Evidence { windows: before, ..evidence(1.0, 2) };
        assert!((once.p_value_over_windows(&before) - 1.0).abs() < 1e-12);
    }

    #[test]
    fn without_a_validation_part_only_training_counts() {
        let none = Squares { sum: 0.0, samples: 0 };
        let evidence = Evidence { validation: none, ..evidence(500.0, 0) };
        assert!((evidence.criterion() - 1000.0 * 0.5_f64.ln()).abs() < 1e-9);
    }
}
