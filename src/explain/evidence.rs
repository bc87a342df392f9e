//! How likely a record is under each of several models.
//!
//! The noise of the measurement may have a memory. One autoregression is fitted to what the
//! best model leaves; the residuals of all models are filtered by it, and what remains is
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
//! `R_t`. While much is still missing from both models, though, the memory of what the best
//! one leaves is no noise's, and the filter can hide what is plain to see. So the residuals
//! `e` of the simpler one in all windows, fitted or not, are also regressed, as they are, on
//! what the other does otherwise, `d`, with an error that allows for any memory within a
//! window (Liang and Zeger; each window in its turn left out, as Bell and `McCaffrey` have it):
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
//! Liang, K.-Y., and Zeger, S. L., 1986, Longitudinal data analysis using generalized linear
//! models, Biometrika 73; Bell, R. M., and `McCaffrey`, D. F., 2002, Bias reduction in standard
//! errors for linear regression with multi-stage samples, Survey Methodology 28.

use crate::diagnosis::{BEYOND_NOISE, ErrorFigures, floor_of};
use crate::fit::{Fit, FitRecord, Part, Status};
use crate::numerics::fisher_tail;
use crate::numerics::{autoregression, whitened};

/// The noise of a record, as the best model leaves it.
#[derive(Clone, Debug)]
pub(super) struct Noise {
    memory: Vec<f64>,
}

/// One model's residuals.
#[derive(Clone, Debug)]
pub(super) struct Evidence {
    training: Squares,
    validation: Squares,
    /// The residuals of each window of both parts, as they are.
    windows: Vec<Vec<f64>>,
    /// Parameters that were fitted.
    parameters: usize,
}

#[derive(Clone, Copy, Debug)]
struct Squares {
    sum: f64,
    samples: usize,
}

impl Noise {
    /// The memory of what `fit` leaves, both parts together.
    ///
    /// What is far more than the noise of the measurement is a misfit, whose memory is no
    /// noise's: models are then compared as if noise had none.
    pub(super) fn of(record: &FitRecord<'_>, fit: &Fit) -> Self {
        let mut windows = record.cut(&fit.evaluation.residuals, Part::Training);
        windows.extend(record.cut(&fit.evaluation.residuals, Part::Validation));
        let error = ErrorFigures::of(record, &fit.evaluation, Part::Training);
        let is_misfit = error
            .zip(floor_of(record, fit))
            .is_some_and(|(error, floor)| error.rmse > BEYOND_NOISE * floor);
        Self { memory: if is_misfit { Vec::new() } else { autoregression(&windows) } }
    }

    /// The evidence of the model of `fit`.
    pub(super) fn evidence(&self, record: &FitRecord<'_>, fit: &Fit) -> Evidence {
        let cut = |part| record.cut(&fit.evaluation.residuals, part);
        let squares = |windows: &[Vec<f64>]| {
            let windows = whitened(windows, &self.memory);
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
    /// The criterion: less is better.
    pub(super) fn criterion(&self) -> f64 {
        let penalty = self.parameters as f64 * (self.training.samples.max(2) as f64).ln();
        self.deviance() + penalty
    }

    /// The criterion without its penalty: twice the negative log-likelihood.
    pub(super) fn deviance(&self) -> f64 {
        self.training.deviance() + self.validation.deviance()
    }

    /// The same beside a simpler model that is no special case of it: the way from that to
    /// the nearest of its own is a direction in which noise may lie, too, and counts as a
    /// parameter.
    pub(super) fn apart(self) -> Self {
        Self { parameters: self.parameters + 1, ..self }
    }

    /// The probability of so much more than a simpler model explains, were it no better: the
    /// smaller of two tests', times two.
    pub(super) fn p_value_against(&self, simpler: &Self) -> f64 {
        const TESTS: f64 = 2.0;
        (TESTS * self.by_likelihood(simpler).min(self.over_windows(simpler))).min(1.0)
    }

    /// Fisher's test of this model against one with fewer parameters, on the training part.
    fn by_likelihood(&self, simpler: &Self) -> f64 {
        let added = self.parameters.saturating_sub(simpler.parameters).max(1);
        let freedom = self.training.samples.saturating_sub(self.parameters).max(1);
        let gained = (simpler.training.sum - self.training.sum).max(0.0) / added as f64;
        let left = (self.training.sum / freedom as f64).max(f64::MIN_POSITIVE);
        fisher_tail(gained / left, added, freedom).unwrap_or(1.0)
    }

    /// The probability of so much more than another model explains in many windows, were this
    /// one no better: see the [module](self). 1 where it is spread over too few.
    pub(super) fn over_windows(&self, other: &Self) -> f64 {
        /// What a window does to the sum: `e·d` and `d·d`.
        struct Pull {
            with_residual: f64,
            own: f64,
        }
        let pull = |(before, after): (&Vec<f64>, &Vec<f64>)| {
            let pairs = || before.iter().zip(after).map(|(before, after)| (before, before - after));
            let with_residual = pairs().map(|(e, d)| e * d).sum();
            Pull { with_residual, own: pairs().map(|(_, d)| d * d).sum() }
        };
        let pulls: Vec<Pull> = other.windows.iter().zip(&self.windows).map(pull).collect();
        let sum = |of: &dyn Fn(&Pull) -> f64| pulls.iter().map(of).sum::<f64>();
        let whole = sum(&|pull| pull.own);
        let factor = sum(&|pull| pull.with_residual) / whole;
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a count")]
        let spread = (whole * whole / sum(&|pull| pull.own * pull.own)) as usize;
        let added = self.parameters.saturating_sub(other.parameters).max(1);
        let error = |pull: &Pull| {
            let left = pull.with_residual - factor * pull.own;
            (left / (1.0 - pull.own / whole)).powi(2)
        };
        let variance = (sum(&error) / (whole * whole)).max(f64::MIN_POSITIVE);
        let statistic = factor * factor / (variance * added as f64);
        if factor > 0.0 {
            fisher_tail(statistic, added, spread.saturating_sub(added)).unwrap_or(1.0)
        } else {
            1.0
        }
    }
}

impl Squares {
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
        let by = |gain: f64| evidence(1000.0 - gain, 3).by_likelihood(&plain);
        assert!((by(2.7) - 0.1).abs() < 0.01 && (by(10.0) - 0.0015).abs() < 0.0003);
    }

    #[test]
    fn the_way_to_a_model_that_does_not_nest_counts_as_a_parameter() {
        // One parameter turns a shift of any size: it meets the larger part of noise in two
        // directions, whose square is beyond 9.21 with probability 0.01.
        let plain = evidence(1000.0, 2);
        let found = |parameters| evidence(1000.0 - 9.21, parameters);
        let nested = found(3).by_likelihood(&plain);
        let apart = found(3).apart().by_likelihood(&plain);
        assert!((apart - 0.01).abs() < 0.001 && nested < 0.003);
        // Without a parameter of its own there is only the way.
        assert!((found(2).apart().by_likelihood(&plain) / nested - 1.0).abs() < 1e-9);
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

    /// The test of a model that takes `slope` times a ramp off each window, fitted.
    fn of_ramp(seed: u64, effect: impl Fn(usize) -> f64, parameters: usize) -> f64 {
        let before = windows(seed, effect);
        let places = || before.iter().flat_map(|w| (0..w.len()).map(|k| k as f64));
        let with: f64 = places().zip(before.iter().flatten()).map(|(x, e)| x * e).sum();
        let slope = with / places().map(|x| x * x).sum::<f64>();
        let less = |w: &Vec<f64>| w.iter().enumerate().map(|(k, e)| e - slope * k as f64).collect();
        let after =
            Evidence { windows: before.iter().map(less).collect(), ..evidence(1.0, parameters) };
        after.over_windows(&Evidence { windows: before, ..evidence(1.0, 2) })
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
        assert!((once.over_windows(&before) - 1.0).abs() < 1e-12);
    }

    #[test]
    fn without_a_validation_part_only_training_counts() {
        let none = Squares { sum: 0.0, samples: 0 };
        let evidence = Evidence { validation: none, ..evidence(500.0, 0) };
        assert!((evidence.criterion() - 1000.0 * 0.5_f64.ln()).abs() < 1e-9);
    }
}
