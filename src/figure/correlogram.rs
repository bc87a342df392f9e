//! How the residual is correlated with itself and with the input, lag by lag.

use super::panel::Place;
use super::span::Span;
use crate::diagnosis::Comparison;

/// Titles of the three correlograms.
pub(crate) const TITLES: [&str; 3] = [
    "residual with itself: lag [s]",
    "changes with the acting input's: lag [s]",
    "changes with the measured input's: lag [s]",
];

/// Correlations at equal steps of the lag.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Correlogram<'a> {
    first_lag_s: f64,
    lag_step_s: f64,
    correlation: &'a [f64],
    /// Correlations of noise stay between this and its negative.
    pub(crate) band: f64,
}

impl<'a> Correlogram<'a> {
    /// Those of a model, in the order of [`TITLES`].
    pub(crate) fn all(comparison: &'a Comparison) -> [Option<Self>; 3] {
        let itself = comparison.whiteness.as_ref().map(|whiteness| Self {
            first_lag_s: whiteness.lag_step_s,
            lag_step_s: whiteness.lag_step_s,
            correlation: &whiteness.correlation,
            band: whiteness.band,
        });
        let of_input = comparison.input_correlation.as_ref().map(|all| {
            [&all.acting, &all.raw].map(|one| Self {
                first_lag_s: all.first_lag_s,
                lag_step_s: all.lag_step_s,
                correlation: &one.correlation,
                band: one.band,
            })
        });
        let [acting, raw] = of_input.map_or([None, None], |both| both.map(Some));
        [itself, acting, raw]
    }

    /// Lag in seconds, and correlation.
    pub(crate) fn curve(&self) -> Vec<Place> {
        let lag = |k: usize| self.first_lag_s + k as f64 * self.lag_step_s;
        self.correlation.iter().enumerate().map(|(k, r)| (lag(k), *r)).collect()
    }

    /// Ranges with room for all of `several`.
    pub(crate) fn spans(several: &[Self]) -> (Span, Span) {
        let last = |one: &Self| {
            one.first_lag_s + one.lag_step_s * one.correlation.len().saturating_sub(1) as f64
        };
        let lags = several.iter().flat_map(|one| [0.0, one.first_lag_s, last(one)]);
        let room = |one: &Self| [0.0, 2.0 * one.band, -2.0 * one.band];
        let values =
            several.iter().flat_map(|one| one.correlation.iter().copied().chain(room(one)));
        (Span::around(lags, 0.0), Span::around(values, 0.1))
    }
}
