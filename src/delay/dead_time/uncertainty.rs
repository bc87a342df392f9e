//! How well a dead time is known.
//!
//! The likelihood of a dead time, all else being fitted anew to it, gives an interval where
//! errors are independent and the structure is right. Neither is quite so: what the structure
//! lacks shows as errors that depend on the motion. So the threshold of the likelihood is
//! widened by as much as the sum of scores varies more from part to part of the record than
//! independent errors would let it,
//!
//! ```text
//! s_b = Σ e_k g_k over part b      widened = Σ s_b² / (σ² Σ g_k²), at least 1
//! ```
//!
//! `g` being what of the derivative of the prediction by the dead time no other parameter can
//! take over.
//!
//! # References
//! K.-Y. Liang and S. L. Zeger, "Longitudinal data analysis using generalized linear models",
//! Biometrika 73 (1986): the variance by parts. S. G. Self, R. H. Mauritsen, "Power/sample size
//! calculations for generalized linear models" (1988) for the scaled likelihood.

use super::record::{Rows, Whitened};
use super::response::Lags;
use super::search::Fitted;
use crate::numerics::{Regression, product, residuals_of};

/// A fit with all that follows from it at its best.
pub(super) struct Assessed {
    /// Coefficients of the curve's columns.
    pub(super) coefficients: Vec<f64>,
    /// Residuals, by rows.
    pub(super) errors: Rows,
    /// How much the threshold of the likelihood is widened.
    pub(super) widened: f64,
    /// Standard deviation of the dead time where the lags are known, samples.
    pub(super) deviation: f64,
}

/// Parts of the record.
pub(super) const PARTS: usize = 20;

impl Assessed {
    pub(super) fn of(trials: &[Whitened], best: Fitted) -> Self {
        /// Samples between two predictions whose difference is a derivative.
        const APART: f64 = 0.1;
        let own = best.design(trials);
        let columns: Vec<&Rows> = own.columns.iter().collect();
        let coefficients = Regression::of(&own.changes, &columns).coefficients;
        let coefficients: Vec<f64> = coefficients.iter().skip(1).copied().collect();
        let errors = own.residuals();
        let by = |fitted: Fitted| combined(&fitted.design(trials).columns[1..], &coefficients);
        let [slow, fast] = sensitivities_to_lags(best).map(|(up, down)| less(by(up), &by(down)));
        let below = (best.delay - 0.5 * APART).max(0.0);
        let at = |delay| Fitted { delay, ..best };
        let mut by_delay = less(by(at(below + APART)), &by(at(below)));
        by_delay.iter_mut().flatten().for_each(|value| *value /= APART);
        let alone = own.residuals_of(&by_delay).unwrap_or_default();
        let others: Vec<&Rows> = columns.into_iter().chain([&slow, &fast]).collect();
        // g: what neither curve nor lags can take over.
        let free = residuals_of(&by_delay, &others).unwrap_or_default();
        let rows: usize = own.changes.iter().map(Vec::len).sum();
        let freedom = rows.saturating_sub(others.len() + 1).max(1) as f64;
        let variance = product(&errors, &errors) / freedom;
        let widened = widened(&errors, &free, variance);
        // σ²·widened/Σ g², with the lags known.
        let deviation = (variance * widened / product(&alone, &alone)).sqrt();
        Self { coefficients, errors, widened, deviation }
    }
}

/// Both lags a little longer and shorter.
fn sensitivities_to_lags(best: Fitted) -> [(Fitted, Fitted); 2] {
    const BY: f64 = 0.02;
    let Lags { slow, fast } = best.lags;
    let with = |a: f64, b: f64| Fitted { lags: Lags::new(a, b), ..best };
    [
        (with(slow * (1.0 + BY), fast), with(slow, fast)),
        (with(slow, fast * (1.0 + BY)), with(slow, fast)),
    ]
}

fn combined(columns: &[Rows], coefficients: &[f64]) -> Rows {
    let mut sum: Rows = columns
        .first()
        .map_or_else(Vec::new, |column| column.iter().map(|rows| vec![0.0; rows.len()]).collect());
    for (column, c) in columns.iter().zip(coefficients) {
        let slots = sum.iter_mut().flatten().zip(column.iter().flatten());
        slots.for_each(|(slot, value)| *slot += c * value);
    }
    sum
}

fn less(mut from: Rows, other: &Rows) -> Rows {
    let slots = from.iter_mut().flatten().zip(other.iter().flatten());
    slots.for_each(|(slot, value)| *slot -= value);
    from
}

/// How much more the sums of scores vary than those of independent errors.
fn widened(errors: &Rows, derivative: &Rows, variance: f64) -> f64 {
    let scores = errors.iter().flatten().zip(derivative.iter().flatten()).map(|(e, g)| e * g);
    let scores: Vec<f64> = scores.collect();
    let part = scores.len().div_ceil(PARTS).max(1);
    // s_b², one of each part.
    let sums = scores.chunks(part).map(|part| part.iter().sum::<f64>().powi(2));
    let found = sums.sum::<f64>() / (variance * product(derivative, derivative));
    if found.is_finite() { found.max(1.0) } else { 1.0 }
}
