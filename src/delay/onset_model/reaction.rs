//! Whether anything happened in a window: a bend against one line.
//!
//! # References
//! H. Hotelling, "Tubes and spheres in n-spaces", Am. J. Math. 61 (1939). M. Knowles and D. Siegmund,
//! "On Hotelling's approach to testing for a nonlinear parameter in regression", Int. Stat. Rev. 57
//! (1989).

use std::f64::consts::PI;

use super::dynamics::{Before, Dynamics, Response as _};
use super::response::bend;
use super::windows::{MARGIN, best};
use crate::numerics::fisher_tail;
use crate::units::floor_to_index;

/// What finds the best bend of windows.
pub(in crate::delay) struct Bends(Dynamics<2>);

/// The best bend of one window.
#[derive(Clone, Debug)]
pub(in crate::delay) struct Bend {
    /// The part of the squared error of one line that it removes.
    explained: f64,
    /// What it leaves over.
    pub(in crate::delay) residuals: Vec<f64>,
}

impl Bends {
    /// For windows of fewer than `longest` samples.
    pub(in crate::delay) fn within(longest: usize) -> Self {
        Self(bend(longest as f64 / 2.0, longest))
    }

    /// The best bend of `values`; `None` of too few.
    pub(in crate::delay) fn best(&self, values: &[f64]) -> Option<Bend> {
        let last = values.len().checked_sub(1 + MARGIN).filter(|last| *last >= MARGIN)?;
        let window = self.0.window(values, f64::INFINITY, Before::Any)?;
        let (position, jump) = best(window.as_ref(), MARGIN as f64, last as f64);
        let fitted = window.fitted(position);
        Some(Bend {
            explained: 1.0 - jump.sse / window.sse_without().max(f64::MIN_POSITIVE),
            residuals: values.iter().zip(fitted).map(|(y, fitted)| y - fitted).collect(),
        })
    }
}

impl Bend {
    /// How often noise alone bends as much, whose [memory] enlarges variances so much.
    pub(in crate::delay) fn p_value(&self, memory: f64) -> f64 {
        let samples = self.residuals.len() as f64;
        p_value(self.explained, (samples - 2.0) / memory, samples)
    }
}

/// The probability that noise alone gains the `share` of its power with a bend in a window of so many
/// `samples`, where there are that many `dimensions` to gain in.
///
/// It is that of a random direction coming so near to a curve on a sphere, whose length is
/// `√3/2 · ln(s/(1−s))` between the ends of the search, with `s` the position as a part of the window.
pub(super) fn p_value(share: f64, dimensions: f64, samples: f64) -> f64 {
    if !share.is_finite() || dimensions < 3.0 {
        return 1.0;
    }
    let share = share.clamp(0.0, 1.0);
    let odds = |position: f64| (position.max(1.0) / (samples - position).max(1.0)).ln();
    let (low, high) = (MARGIN as f64, samples - 1.0 - MARGIN as f64);
    let length = 0.75_f64.sqrt() * (odds(high) - odds(low)).max(0.0);
    // Knowles and Siegmund: length/(2π)·(1 − r²)^((m − 2)/2), for a gain of either sign.
    let tube = length / PI * (1.0 - share).powf((dimensions - 2.0) / 2.0);
    let freedom = dimensions - 1.0;
    let statistic = freedom * share / (1.0 - share).max(f64::MIN_POSITIVE);
    // The caps at both ends of the curve: together what one given direction gains, F with 1 and
    // m − 1 degrees of freedom.
    let ends = fisher_tail(statistic, 1, floor_to_index(freedom)).unwrap_or(1.0);
    (tube + ends).min(1.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::numerics::testing::noise;

    #[test]
    fn noise_alone_bends_as_often_as_the_p_value_says() {
        let p_values: Vec<f64> = (0..400)
            .map(|seed| Bends::within(100).best(&noise(seed, 0.0, 80)).unwrap().p_value(1.0))
            .collect();
        for level in [0.01, 0.05, 0.2] {
            let below = p_values.iter().filter(|p| **p < level).count() as f64 / 400.0;
            let error = (level * (1.0 - level) / 400.0).sqrt();
            assert!((below - level).abs() < 4.0 * error, "{level}: {below}");
        }
    }

    #[test]
    fn a_bend_is_none_of_noise() {
        let bent = |change: f64| -> Vec<f64> {
            let noise = noise(7, 0.0, 100);
            noise.iter().enumerate().map(|(k, e)| e + change * (k as f64 - 50.0).max(0.0)).collect()
        };
        let p_value = |values: &[f64]| Bends::within(200).best(values).unwrap().p_value(1.0);
        assert!(p_value(&bent(0.0)) > 0.02);
        assert!(p_value(&bent(0.6)) < 1e-9);
    }
}
