//! How the residual is correlated with itself and with the input, lag by lag.

use super::panel::{Axis, Mark, Panel, Place, Shape};
use super::role::Role;
use super::span::Span;
use crate::diagnosis::Comparison;

/// What is correlated in the three correlograms.
const NAMES: [&str; 3] = [
    "residual with itself",
    "changes with the acting input's",
    "changes with the measured input's",
];

/// Why there is no correlation.
const NOT_KNOWN: &str = "not computed, since sample periods differ or samples are too few";

/// A panel for each of them: a curve and a band per model.
pub(crate) fn panels(models: &[(Role, &Comparison)]) -> [Panel; 3] {
    let of_each: Vec<_> = models.iter().map(|(role, one)| (*role, Correlogram::all(one))).collect();
    [0, 1, 2].map(|place| {
        let known = of_each.iter().filter_map(|(role, all)| Some((*role, all[place]?)));
        let known: Vec<(Role, Correlogram<'_>)> = known.collect();
        let (x, y) = Correlogram::spans(&known);
        let zero = vec![vec![(x.low, 0.0), (x.high, 0.0)], vec![(0.0, y.low), (0.0, y.high)]];
        let mut marks = vec![Mark::new(Role::Faint, Shape::Lines(zero, 0.8))];
        for (role, one) in &known {
            marks.push(Mark::new(*role, Shape::Band(-one.band, one.band)));
            marks.push(Mark::new(*role, Shape::Lines(vec![one.curve()], 1.3)));
        }
        if known.is_empty() {
            let words = vec![((x.low, f64::midpoint(y.low, y.high)), NOT_KNOWN.to_owned())];
            marks = vec![Mark::new(Role::Ink, Shape::Words(words))];
        }
        let (x, y) = (Axis::new(x, "lag [s]", 4.0), Axis::new(y, NAMES[place], 3.0));
        Panel { x, y, height: 190, marks }
    })
}

/// Correlations at equal steps of the lag.
#[derive(Clone, Copy, Debug)]
struct Correlogram<'a> {
    first_lag_s: f64,
    lag_step_s: f64,
    correlation: &'a [f64],
    /// Correlations of noise stay between this and its negative.
    band: f64,
}

impl<'a> Correlogram<'a> {
    /// Those of a model, in the order of [`NAMES`].
    fn all(comparison: &'a Comparison) -> [Option<Self>; 3] {
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
    fn curve(&self) -> Vec<Place> {
        let lag = |k: usize| self.first_lag_s + k as f64 * self.lag_step_s;
        self.correlation.iter().enumerate().map(|(k, r)| (lag(k), *r)).collect()
    }

    /// Ranges with room for all of `several`.
    fn spans(several: &[(Role, Self)]) -> (Span, Span) {
        let last = |one: &Self| {
            one.first_lag_s + one.lag_step_s * one.correlation.len().saturating_sub(1) as f64
        };
        let several = || several.iter().map(|(_, one)| one);
        let lags = several().flat_map(|one| [0.0, one.first_lag_s, last(one)]);
        let room = |one: &Self| [0.0, 2.0 * one.band, -2.0 * one.band];
        let values = several().flat_map(|one| one.correlation.iter().copied().chain(room(one)));
        (Span::around(lags, 0.0), Span::around(values, 0.1))
    }
}
