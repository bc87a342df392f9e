//! Asymmetric saturation: the flow ends at a limit of its own in each direction.
//!
//! ```text
//! limit(in) = limit            where in ≥ 0
//!             negative_limit   where in < 0
//! ```
//!
//! and below and about it as [`InputSaturation`](super::InputSaturation), which it contains as the
//! case of equal limits. The two sides of a cylinder have other areas and loads, and a valve other
//! notches for each: the pump's flow or the valve's area ends the speed of each direction by itself,
//! and a [gain by direction](super::DirectionGain) alone would tie the limits to the gains. Of a
//! limit that only one direction reaches, the other one is not determined.
//!
//! # References
//! Jelali, M., and Kroll, A., 2003, Hydraulic Servo-systems: Modelling, Identification and Control
//! (flow saturation, single-rod cylinders).

use super::input_saturation::{FITTED_LIMIT, SOFTNESS, levels_off, limited};
use super::{Dimension, Effect, Equations, Moment, Parameter, RecordRange, Spec, Stage, UNLIMITED};

/// See the [module](self).
#[derive(Clone, Copy, Debug)]
pub struct AsymmetricSaturation;

static SPEC: Spec = Spec::new(
    "asymmetric_saturation",
    Stage::Input,
    "flow limits that differ by direction",
)
.equation(
    "abs(out) = min(abs(in), limit) where in >= 0, min(abs(in), negative_limit) where in < 0, \
               each rounded within its limit (1 -+ softness)",
)
.source("Jelali and Kroll, 2003, Hydraulic Servo-systems")
.parameters(&[
    Parameter::new("limit", "largest positive input that passes", Dimension::Input)
        .between(0.0, UNLIMITED)
        .neutral(UNLIMITED),
    SOFTNESS,
    Parameter::new(
        "negative_limit",
        "size of the largest negative input that passes",
        Dimension::Input,
    )
    .between(0.0, UNLIMITED)
    .neutral(UNLIMITED),
])
.confused_with(&["input_saturation", "direction_gain"])
.absorbing(&["input_saturation"])
.refining("input_saturation")
.looking_like_both(&[["input_saturation", "direction_gain"]])
.steady()
.equations(Equations::new(&[
    "here = if(signal < 0, negative_limit, limit)
             size = abs(signal)
             into_knee = size - here * (1 - softness)
             width = 2 * softness * here
             rounded = size - into_knee * (into_knee / (2 * width))
             out = if(into_knee <= 0, signal, sign(signal) * if(into_knee < width, rounded, here))",
]));

impl Effect for AsymmetricSaturation {
    fn spec(&self) -> &'static Spec {
        &SPEC
    }

    fn step(&self, parameters: &[f64], _memory: &mut [f64], at: &Moment) -> f64 {
        let &[limit, softness, negative_limit] = parameters else { return at.signal };
        let limit = if at.signal < 0.0 { negative_limit } else { limit };
        limited(at.signal, limit, softness)
    }

    fn shows_its_form(&self, parameters: &[f64], record: &RecordRange<'_>) -> bool {
        let &[limit, softness, negative_limit] = parameters else { return true };
        levels_off(limit.min(negative_limit), softness, record)
    }

    fn bounds(&self, record: &RecordRange<'_>) -> Vec<(f64, f64)> {
        let (low, high) = FITTED_LIMIT;
        let largest = record.size(Dimension::Input);
        let limits = (low * largest, high * largest);
        vec![limits, (0.0, 1.0), limits]
    }

    fn guesses(&self, record: &RecordRange<'_>) -> Vec<Vec<f64>> {
        let largest = record.size(Dimension::Input);
        let guess = |part: f64| {
            let limit = part * largest;
            [0.7, 1.0, 1.4].map(|ratio| vec![limit, 0.1, ratio * limit])
        };
        [0.4, 0.65, 0.9].into_iter().flat_map(guess).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::super::InputSaturation;
    use super::super::testing::{assert_close, run};
    use super::*;

    #[test]
    fn each_direction_has_its_limit() {
        let inputs = [-3.0, -1.1, -1.0, 2.0, 9.0];
        let outputs = run(&AsymmetricSaturation, &[2.0, 0.0, 1.0], &inputs);
        assert_close(&outputs, &[-1.0, -1.0, -1.0, 2.0, 2.0]);
    }

    #[test]
    fn with_the_same_limit_both_ways_it_is_a_saturation() {
        let inputs = [-4.0, -1.9, -1.0, 1.9, 3.0];
        let plain = run(&InputSaturation, &[2.0, 0.5], &inputs);
        assert_close(&run(&AsymmetricSaturation, &[2.0, 0.5, 2.0], &inputs), &plain);
    }
}
