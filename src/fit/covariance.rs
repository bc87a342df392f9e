//! How sure fitted parameters are, when residuals are correlated.
//!
//! With the Jacobian `J` of the simulated output and the residuals `r`, the covariance is
//! `(JᵀJ)⁻¹ · S · (JᵀJ)⁻¹`, where `S` is the long-run covariance of `g_k = J_k r_k`:
//! `S = Γ₀ + Σ_l w_l (Γ_l + Γ_lᵀ)` with Bartlett's weights. On white residuals it is the
//! usual `σ² (JᵀJ)⁻¹`; where residuals are correlated the usual one is too small.
//!
//! A parameter with which an effect jumps lies between the two jumps beside it, a width `w` apart. That is
//! one more observation of it, with the variance `w²/12` of a uniform distribution: without it, neither it
//! nor a gain of which only its product with it matters would be known at all.
//!
//! # References
//! W. K. Newey and K. D. West, "A simple, positive semi-definite, heteroskedasticity and
//! autocorrelation consistent covariance matrix", Econometrica 55 (1987), 703-708.
//! D. W. K. Andrews, "Heteroskedasticity and autocorrelation consistent covariance matrix
//! estimation", Econometrica 59 (1991), 817-858 (the choice of the number of lags).

use nalgebra::{DMatrix, DVector};

use super::result::Status;
use super::space::Space;
use crate::numerics::{PseudoInverse, column_products, rank};

/// The covariance of fitted parameters.
#[derive(Clone, Debug)]
pub(super) struct Covariance {
    /// `None` for a parameter that the data do not determine.
    std_errors: Vec<Option<f64>>,
    at_bound: Vec<bool>,
}

impl Covariance {
    /// The covariance at `values`, all of a model's, of those that are free in `space`: from the slopes of
    /// the residuals to these and the residuals there.
    pub(super) fn of(
        slopes: DMatrix<f64>,
        residuals: &DVector<f64>,
        space: &Space,
        values: &[f64],
    ) -> Self {
        let (free, bounds) = (&space.free, &space.bounds);
        let noise = residuals.norm() / (residuals.len() as f64).sqrt();
        let mut sums = Sums::of(slopes, residuals);
        for (place, index) in free.iter().enumerate() {
            if let Some(width) = space.width_between_jumps(place, values[*index]) {
                sums.observe(place, noise, width / 12.0_f64.sqrt());
            }
        }
        let at_bound = free.iter().zip(bounds).zip(&sums.lengths);
        let at_bound = at_bound.map(|((index, bounds), length)| {
            bounds.is_at(values[*index], noise / length.max(f64::MIN_POSITIVE))
        });
        let at_bound: Vec<bool> = at_bound.collect();
        Self { std_errors: with_bounds(&sums, &at_bound), at_bound }
    }

    /// What a fit could do with a free parameter of `space`, which it left at `value`.
    pub(super) fn status(&self, space: &Space, free: usize, value: f64) -> Status {
        let is_lost = |error| space.bounds[free].is_lost_in(error);
        match self.std_error(free) {
            _ if space.is_beyond_reach(free, value) => Status::BeyondReach,
            _ if self.at_bound[free] => Status::AtBound,
            Some(error) if !is_lost(error) => Status::Fitted,
            _ => Status::Undetermined,
        }
    }

    pub(super) fn std_error(&self, free: usize) -> Option<f64> {
        self.std_errors[free]
    }
}

/// Standard errors; those of parameters inside their bounds are as if the others were known
/// to lie where they do.
fn with_bounds(sums: &Sums, at_bound: &[bool]) -> Vec<Option<f64>> {
    let columns: Vec<usize> = (0..at_bound.len()).collect();
    let mut errors = sums.std_errors(&columns);
    if at_bound.contains(&true) {
        let inside: Vec<usize> = columns.into_iter().filter(|k| !at_bound[*k]).collect();
        for (k, error) in inside.iter().zip(sums.std_errors(&inside)) {
            errors[*k] = error;
        }
    }
    errors
}

/// The part of a parameter, squared, that may lie in undetermined directions.
const UNDETERMINED: f64 = 1e-3;

/// What of the Jacobian the covariance takes: sums over all samples, of columns of length one, so
/// that units do not matter to the rank.
struct Sums {
    samples: usize,
    /// Of each column.
    lengths: Vec<f64>,
    /// `JᵀJ`.
    products: DMatrix<f64>,
    /// `S`.
    long_run: DMatrix<f64>,
}

impl Sums {
    fn of(mut jacobian: DMatrix<f64>, residuals: &DVector<f64>) -> Self {
        let lengths: Vec<f64> = jacobian.column_iter().map(|column| column.norm()).collect();
        for (mut column, length) in jacobian.column_iter_mut().zip(&lengths) {
            column /= if *length > 0.0 { *length } else { 1.0 };
        }
        let products = column_products(&jacobian);
        let long_run = long_run(&jacobian, residuals);
        Self { samples: residuals.len(), lengths, products, long_run }
    }

    /// Adds an observation of one parameter with this deviation, beside residuals of the deviation `noise`.
    fn observe(&mut self, parameter: usize, noise: f64, deviation: f64) {
        let length = self.lengths[parameter];
        let slope = if length > 0.0 { noise / (deviation * length) } else { 0.0 };
        self.products[(parameter, parameter)] += slope.powi(2);
        self.long_run[(parameter, parameter)] += (slope * noise).powi(2);
    }

    /// Of these parameters, the others being known: `(JᵀJ)⁻¹ S (JᵀJ)⁻¹`.
    fn std_errors(&self, of: &[usize]) -> Vec<Option<f64>> {
        if of.is_empty() {
            return Vec::new();
        }
        let some = |all: &DMatrix<f64>| all.select_rows(of).select_columns(of);
        let pseudo_inverse = PseudoInverse::of(some(&self.products), rank::SENSITIVITIES);
        let inverse = pseudo_inverse.matrix();
        let covariance = &inverse * some(&self.long_run) * &inverse;
        let freedom = self.samples.saturating_sub(of.len()).max(1);
        let correction = self.samples as f64 / freedom as f64;
        let error = |(index, column): (usize, &usize)| {
            let variance = covariance[(index, index)] * correction;
            let error = variance.max(0.0).sqrt() / self.lengths[*column];
            let is_determined = pseudo_inverse.undetermined(index) < UNDETERMINED;
            (is_determined && error.is_finite()).then_some(error)
        };
        of.iter().enumerate().map(error).collect()
    }
}

/// The long-run covariance of `g_k = J_k r_k`, by sums over all spans of `L + 1` samples, of which
/// those beyond the record are 0:
///
/// ```text
/// S = Σ_l w_l Γ_l = 1/(L + 1) Σ_t B_t B_tᵀ,   w_l = 1 − |l|/(L + 1),   B_t = g_(t−L) + … + g_t
/// ```
///
/// which takes as long for any number of lags.
fn long_run(jacobian: &DMatrix<f64>, residuals: &DVector<f64>) -> DMatrix<f64> {
    let (samples, parameters) = jacobian.shape();
    let span = bandwidth(residuals.as_slice()) + 1;
    let add = |sum: &mut DVector<f64>, index: usize, sign: f64| {
        let by = sign * residuals[index];
        sum.iter_mut().enumerate().for_each(|(k, sum)| *sum += by * jacobian[(index, k)]);
    };
    let mut sum = DVector::zeros(parameters);
    let mut products = DMatrix::zeros(parameters, parameters);
    for last in 0..samples + span - 1 {
        if last < samples {
            add(&mut sum, last, 1.0);
        }
        if let Some(gone) = last.checked_sub(span) {
            add(&mut sum, gone, -1.0);
        }
        products.ger(1.0, &sum, &sum, 1.0);
    }
    products / span as f64
}

/// Andrews' number of lags for Bartlett's weights: `1.1447 (α n)^(1/3)` with
/// `α = 4ρ²/((1 − ρ)²(1 + ρ)²)` of a first-order process.
fn bandwidth(residuals: &[f64]) -> usize {
    /// Lags that are still affordable.
    const MOST: f64 = 400.0;
    let n = residuals.len() as f64;
    let power: f64 = residuals.iter().map(|r| r * r).sum();
    let products = residuals.iter().zip(residuals.iter().skip(1)).map(|(a, b)| a * b);
    let rho = (products.sum::<f64>() / power.max(f64::MIN_POSITIVE)).clamp(-0.99, 0.99);
    let alpha = 4.0 * rho * rho / ((1.0 - rho).powi(2) * (1.0 + rho).powi(2));
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "0 to 400")]
    let lags = (1.1447 * (alpha * n).cbrt()).min(MOST).min(n / 4.0) as usize;
    lags
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::numerics::testing;

    fn noise(count: usize) -> Vec<f64> {
        testing::noise(3, 0.0, count)
    }

    fn std_errors(columns: &[DVector<f64>], residuals: &DVector<f64>) -> Vec<Option<f64>> {
        let sums = Sums::of(DMatrix::from_columns(columns), residuals);
        with_bounds(&sums, &vec![false; columns.len()])
    }

    #[test]
    fn on_white_residuals_it_is_the_usual_standard_error() {
        let n = 20_000;
        let residuals = DVector::from_vec(noise(n));
        let ones = DVector::from_element(n, 1.0);
        let error = std_errors(&[ones], &residuals)[0].unwrap();
        let usual = 1.0 / (n as f64).sqrt();
        assert!((error / usual - 1.0).abs() < 0.15, "{error} {usual}");
    }

    #[test]
    fn correlation_makes_the_mean_less_sure() {
        // First order with ρ = 0.9: the mean's variance is (1+ρ)/(1−ρ) = 19 times greater.
        let n = 40_000;
        let mut value = 0.0;
        let filter = |e: f64| {
            value = 0.9 * value + (1.0 - 0.81f64).sqrt() * e;
            value
        };
        let residuals = DVector::from_vec(noise(n).into_iter().map(filter).collect());
        let error = std_errors(&[DVector::from_element(n, 1.0)], &residuals)[0].unwrap();
        let expected = (19.0 / n as f64).sqrt();
        assert!((error / expected - 1.0).abs() < 0.2, "{error} {expected}");
    }

    #[test]
    fn it_is_the_weighted_sum_of_the_covariances_at_each_lag() {
        let (n, p) = (200, 2);
        let residuals = DVector::from_vec(testing::noise(5, 0.8, n));
        let jacobian = DMatrix::from_vec(n, p, testing::noise(6, 0.5, n * p));
        let lags = bandwidth(residuals.as_slice());
        assert!(lags > 3);
        let score = |k: usize, i: usize| jacobian[(k, i)] * residuals[k];
        let covariance = |lag: usize, i, j| (lag..n).map(|k| score(k - lag, i) * score(k, j)).sum();
        let found = long_run(&jacobian, &residuals);
        for (i, j) in [(0, 0), (0, 1), (1, 0), (1, 1)] {
            let mut expected: f64 = covariance(0, i, j);
            for lag in 1..=lags {
                let weight = 1.0 - lag as f64 / (lags + 1) as f64;
                let both: [f64; 2] = [covariance(lag, i, j), covariance(lag, j, i)];
                expected += weight * (both[0] + both[1]);
            }
            assert!((found[(i, j)] - expected).abs() < 1e-10 * expected.abs().max(1.0));
        }
    }

    #[test]
    fn what_changes_nothing_has_no_standard_error() {
        let n = 1000;
        let residuals = DVector::from_vec(noise(n));
        let ramp = DVector::from_fn(n, |k, _| k as f64);
        let twice = &ramp * 2.0;
        let errors = std_errors(&[ramp, twice, DVector::zeros(n)], &residuals);
        assert_eq!(errors, [None, None, None]);
    }

    #[test]
    fn of_a_product_both_factors_are_known_as_well_as_one_is_observed() {
        let n = 1000;
        let residuals = DVector::from_vec(noise(n));
        let ramp = DVector::from_fn(n, |k, _| k as f64);
        let twice = &ramp * 2.0;
        let mut sums = Sums::of(DMatrix::from_columns(&[ramp, twice]), &residuals);
        let deviation = residuals.norm() / (n as f64).sqrt();
        sums.observe(1, deviation, 0.3);
        let errors = with_bounds(&sums, &[false, false]).into_iter().map(Option::unwrap);
        let errors: Vec<f64> = errors.collect();
        assert!((errors[1] / 0.3 - 1.0).abs() < 0.01 && (errors[0] / 0.6 - 1.0).abs() < 0.01);
    }

    #[test]
    fn what_lies_at_a_bound_is_known_to_the_others() {
        let n = 1000;
        let residuals = DVector::from_vec(noise(n));
        let ones = DVector::from_element(n, 1.0);
        let ramp = DVector::from_fn(n, |k, _| k as f64);
        let alone = std_errors(std::slice::from_ref(&ones), &residuals)[0].unwrap();
        let sums = Sums::of(DMatrix::from_columns(&[ones, ramp]), &residuals);
        let both = with_bounds(&sums, &[false, false]);
        let held = with_bounds(&sums, &[false, true]);
        assert!((held[0].unwrap() / alone - 1.0).abs() < 0.01, "{held:?} {alone}");
        assert!(both[0].unwrap() > 1.5 * alone, "{both:?} {alone}");
        assert_eq!(held[1], both[1]);
    }
}
