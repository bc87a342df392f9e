//! The law that the delays of starts from rest follow.
//!
//! A start answers the later the less the valve opens, and the two directions move other volumes.
//! Of the laws
//!
//! ```text
//! τ = τ₀ [+ size · s (1 − exp(−|Δu| / s))] [+ falling · [Δu < 0]]
//! ```
//!
//! with the step `Δu` of the input, the one with the least Bayesian information criterion
//! `n ln(Σ e² / n) + k ln n` is taken; `s` counts as a parameter, and is one of a few. On the
//! measured strokes of an excavator's arm a law that saturates leaves as little (standard
//! deviation 0.087 s) as `a/|Δu|` (0.091 s), `a/Δu²` (0.089 s) and `a/(|Δu| − dead band)`
//! (0.089 s), and is in the catalogue.
//!
//! # References
//! G. Schwarz, "Estimating the dimension of a model", The Annals of Statistics 6 (1978).

use super::{Component, JointModel, Value};
use crate::effect::VariableDelay;
use crate::effect::variable_delay::{by_step, saturated};
use crate::numerics::Regression;

/// An accepted step of the input, and how late it acted.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Start {
    /// The input before it.
    pub(super) before: f64,
    /// What the input changed by.
    pub(super) rise: f64,
    pub(super) delay_s: f64,
}

impl Start {
    /// Whether it sets the joint in motion: it is far larger than the input was.
    pub(super) fn is_from_rest(&self) -> bool {
        /// The input before it, in parts of the step.
        const AT_REST: f64 = 0.1;
        self.before.abs() <= AT_REST * self.rise.abs()
    }
}

/// Starts that determine a law.
const FEWEST: usize = 8;

/// Starts of each direction from which the two may differ.
const FEWEST_EACH: usize = 3;

/// Sizes of steps that show a curve.
const FEWEST_SIZES: usize = 3;

/// Scales that are tried, in parts of the smallest step: a shorter one would say nothing of the
/// steps that there are, and much of smaller ones.
const SCALES: [f64; 4] = [0.5, 1.0, 2.0, 4.0];

/// The error of a delay that is measured without one, in seconds.
const LEAST_ERROR_S: f64 = 1e-3;

/// What a law depends on.
#[derive(Clone, Copy, Debug)]
struct Form {
    /// The scale of the size of the step, where it depends on that.
    size_scale: Option<f64>,
    by_direction: bool,
}

/// A law, fitted.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Law {
    /// `τ₀`, seconds.
    delay_s: f64,
    size: f64,
    size_scale: f64,
    falling_s: f64,
    parameters: usize,
    /// Bayesian information criterion.
    criterion: f64,
}

/// `model` with the law that the delays of `starts` follow, all of it fixed; none where there are
/// too few of them, or no law is better than their mean.
pub(super) fn with_law(mut model: JointModel, starts: &[Start]) -> Option<JointModel> {
    let best = best(starts)?;
    if best.parameters == 1 {
        return None;
    }
    model.delay = fixed(best.delay_s);
    let parameters = by_step(best.size, best.falling_s, best.size_scale);
    let component = Component::new(&VariableDelay, parameters.into_iter().map(fixed).collect())?;
    Some(model.with(component))
}

fn fixed(value: f64) -> Value {
    Value { fixed: true, ..Value::from(value) }
}

/// The law with the least criterion, which gives no start a negative delay, nor a step of no size.
fn best(starts: &[Start]) -> Option<Law> {
    if starts.len() < FEWEST {
        return None;
    }
    let falling = starts.iter().filter(|start| start.rise < 0.0).count();
    let differs = falling.min(starts.len() - falling) >= FEWEST_EACH;
    let mut sizes: Vec<f64> = starts.iter().map(|start| start.rise.abs()).collect();
    sizes.sort_by(f64::total_cmp);
    sizes.dedup_by(|a, b| (*a - *b).abs() <= 1e-6 * b.abs());
    let smallest = sizes.first().copied().filter(|size| *size > 0.0)?;
    let scales = SCALES.iter().filter(|_| sizes.len() >= FEWEST_SIZES);
    let scales: Vec<f64> = scales.map(|part| part * smallest).collect();
    let directions = [false, true].into_iter().filter(|by_direction| !by_direction || differs);
    let forms = directions.flat_map(|by_direction| {
        let sizes = std::iter::once(None).chain(scales.iter().copied().map(Some));
        sizes.map(move |size_scale| Form { size_scale, by_direction })
    });
    let fitted = forms.map(|form| fitted(starts, form));
    let is_possible =
        |law: &Law| law.delay_s >= 0.0 && starts.iter().all(|start| law.delay_s(start.rise) >= 0.0);
    fitted.filter(is_possible).min_by(|a, b| a.criterion.total_cmp(&b.criterion))
}

/// The law of this form, by least squares.
fn fitted(starts: &[Start], Form { size_scale: scale, by_direction }: Form) -> Law {
    let of = |value: &dyn Fn(&Start) -> f64| vec![starts.iter().map(value).collect::<Vec<f64>>()];
    let mut columns = vec![of(&|_| 1.0)];
    columns.extend(scale.map(|scale| of(&|start| saturated(start.rise.abs(), scale))));
    columns.extend(by_direction.then(|| of(&|start| f64::from(u8::from(start.rise < 0.0)))));
    let delays = of(&|start| start.delay_s);
    let regression = Regression::of(&delays, &columns.iter().collect::<Vec<_>>());
    let mut coefficients = regression.coefficients.iter().copied();
    let count = starts.len() as f64;
    let parameters = columns.len() + usize::from(scale.is_some());
    let variance = (regression.error / count).max(LEAST_ERROR_S.powi(2));
    Law {
        delay_s: coefficients.next().unwrap_or(0.0),
        size: scale.and_then(|_| coefficients.next()).unwrap_or(0.0),
        size_scale: scale.unwrap_or(1.0),
        falling_s: coefficients.next().unwrap_or(0.0),
        parameters,
        criterion: count * variance.ln() + parameters as f64 * count.ln(),
    }
}

impl Law {
    /// The delay of a step by `rise`.
    fn delay_s(&self, rise: f64) -> f64 {
        let falling = if rise < 0.0 { self.falling_s } else { 0.0 };
        self.delay_s + self.size * saturated(rise.abs(), self.size_scale) + falling
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn starts(delay_s: impl Fn(f64) -> f64) -> Vec<Start> {
        let rises = [-10.0, -8.0, -6.0, -5.0, -4.0, 4.0, 5.0, 6.0, 8.0, 10.0];
        // Alternately a little too late and too early, as no law is.
        let off = |k: usize| if k.is_multiple_of(2) { 0.004 } else { -0.004 };
        let start = |(k, rise): (usize, &f64)| Start {
            before: 0.0,
            rise: *rise,
            delay_s: delay_s(*rise) + off(k),
        };
        rises.iter().enumerate().map(start).collect()
    }

    fn delay_s(model: &JointModel, rise: f64) -> f64 {
        let change =
            crate::effect::InputChange { before: 0.0, after: rise, held_s: 3.0, time_s: 9.0 };
        model.delay_s(&change)
    }

    #[test]
    fn delays_that_follow_nothing_have_no_law() {
        let model = JointModel::integrator(1.0, 0.2);
        assert!(with_law(model.clone(), &starts(|_| 0.3)).is_none());
        assert!(with_law(model, &starts(|rise| 0.01 * rise.abs())[..5]).is_none());
    }

    #[test]
    fn delays_that_fall_with_the_input_and_by_direction_are_given_back() {
        let law = |rise: f64| 0.2 + 1.2 / rise.abs() + if rise < 0.0 { 0.07 } else { 0.0 };
        let model = with_law(JointModel::integrator(1.0, 0.2), &starts(law)).unwrap();
        for rise in [-10.0, -4.0, 4.0, 6.0, 10.0] {
            let found = delay_s(&model, rise);
            assert!((found - law(rise)).abs() < 0.015, "{rise}: {found}, not {}", law(rise));
        }
        let component = &model.components()[0];
        assert!(component.parameters().iter().all(|parameter| parameter.fixed));
    }

    #[test]
    fn a_law_that_ends_below_zero_is_none() {
        // As measured of a slow logger: the smallest steps seem to act at once.
        let law = |rise: f64| if rise.abs() < 4.5 { 0.004 } else { 0.2 };
        let best = best(&starts(law)).unwrap();
        assert!(best.delay_s >= 0.0, "{best:?}");
    }

    #[test]
    fn no_start_has_a_negative_delay() {
        let best = best(&starts(|rise| 0.05 * (rise.abs() - 4.0).max(0.0).sqrt())).unwrap();
        assert!([4.0, 10.0, -4.0, -10.0].into_iter().all(|rise| best.delay_s(rise) >= 0.0));
    }
}
