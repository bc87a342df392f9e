//! Static curve of the valve: the flow as a monotone function of the command, by cubics between
//! knots.
//!
//! ```text
//! out(0) = 0,   out(reach/3) = inner · outer · reach,   out(2 reach/3) = outer · reach,
//! out(reach) = reach
//! ```
//!
//! and with parameters of its own, times `negative_factor`, for commands below zero. It has no law:
//! overlap, limits and progression of an unusual valve all show in its knots, and a model with it
//! follows the static curve whatever made it so. A search names it where no named effect explains
//! the curve. `reach` is the largest command of the record, and not fitted; beyond it the curve goes
//! on straight.
//!
//! The curve is a cubic between knots. With the secants `s` and `t` on its sides it has at a knot the
//! slope `2 min(s, t, (s + t)/4)`, and at an end, with the secant `s` of its own interval and `t` of
//! the next, `(3 s − t)/2` within 0 and `2 s`. So it is monotone, and follows a parabola exactly.
//!
//! # References
//! Jelali, M., and Kroll, A., 2003, Hydraulic Servo-systems: Modelling, Identification and Control
//! (measured flow curves of valves); Steffen, M., 1990, A simple method for monotonic interpolation in
//! one dimension, Astronomy and Astrophysics 239, 443-450.

use super::{Dimension, Effect, Equations, Moment, Parameter, RecordRange, Spec, Stage};

/// See the [module](self).
#[derive(Clone, Copy, Debug)]
pub struct ValveCurve;

static SPEC: Spec = Spec::new(
    "valve_curve",
    Stage::Input,
    "static curve of the valve without a law, by monotone cubics between knots",
)
.equation(
    "out = 0, inner outer reach, outer reach, reach at in = 0, 1/3, 2/3, 1 of reach, monotone \
     cubics between; for in < 0 with negative_inner, negative_outer, times negative_factor",
)
.source(
    "Jelali and Kroll, 2003, Hydraulic Servo-systems; Steffen, 1990, A simple method for monotonic \
     interpolation in one dimension",
)
.parameters(&[
    share("inner", "flow at a third of reach over that at two thirds", 0.5),
    share("outer", "flow at two thirds of reach over that at reach", 2.0 / 3.0),
    share("negative_inner", "the same as inner for negative commands", 0.5),
    share("negative_outer", "the same as outer for negative commands", 2.0 / 3.0),
    Parameter::new("negative_factor", "flow at -reach over that at reach", Dimension::One)
        .between(0.05, 20.0)
        .neutral(1.0),
    Parameter::new("reach", "largest command of the record", Dimension::Input)
        .between(0.0, super::UNLIMITED)
        .not_fitted(),
])
.confused_with(&[
    "dead_band",
    "input_saturation",
    "asymmetric_saturation",
    "flow_curve",
    "direction_gain",
])
.absorbing(&[
    "dead_band",
    "input_saturation",
    "asymmetric_saturation",
    "flow_curve",
    "direction_gain",
])
.free_form()
.steady()
.equations(Equations::new(&["near = if(signal < 0, negative_inner, inner)
             far = if(signal < 0, negative_outer, outer)
             factor = if(signal < 0, negative_factor, 1)
             size = if(reach > 0, 3 * abs(signal) / reach, 0)
             low = near * far
             second = far - low
             third = 1 - far
             at_zero = min(max(1.5 * low - 0.5 * second, 0), 2 * low)
             at_near = 2 * min(min(low, second), 0.25 * (low + second))
             at_far = 2 * min(min(second, third), 0.25 * (second + third))
             at_end = min(max(1.5 * third - 0.5 * second, 0), 2 * third)
             along = if(size < 1, size, if(size < 2, size - 1, size - 2))
             base = if(size < 1, 0, if(size < 2, low, far))
             rise = if(size < 1, low, if(size < 2, second, third))
             left = if(size < 1, at_zero, if(size < 2, at_near, at_far))
             right = if(size < 1, at_near, if(size < 2, at_far, at_end))
             bend = 3 * rise - 2 * left - right
             twist = left + right - 2 * rise
             cubic = base + along * (left + along * (bend + along * twist))
             part = if(size > 3, 1 + (size - 3) * at_end, cubic)
             out = if(reach > 0, sign(signal) * factor * reach * part, signal)"]));

const fn share(name: &'static str, meaning: &'static str, neutral: f64) -> Parameter {
    Parameter::new(name, meaning, Dimension::One).between(0.0, 1.0).neutral(neutral)
}

impl Effect for ValveCurve {
    fn spec(&self) -> &'static Spec {
        &SPEC
    }

    fn step(&self, parameters: &[f64], _memory: &mut [f64], at: &Moment) -> f64 {
        let &[inner, outer, negative_inner, negative_outer, negative_factor, reach] = parameters
        else {
            return at.signal;
        };
        if reach <= 0.0 {
            return at.signal;
        }
        let (near, far, factor) = if at.signal < 0.0 {
            (negative_inner, negative_outer, negative_factor)
        } else {
            (inner, outer, 1.0)
        };
        let part = along([near * far, far], 3.0 * at.signal.abs() / reach);
        (factor * reach * part).copysign(at.signal)
    }

    /// A valve with an overlap, and one with a limit.
    fn guesses(&self, record: &RecordRange<'_>) -> Vec<Vec<f64>> {
        let reach = record.size(Dimension::Input);
        let symmetric = |inner, outer| vec![inner, outer, inner, outer, 1.0, reach];
        vec![symmetric(0.3, 0.5), symmetric(0.6, 0.9)]
    }
}

/// The monotone cubics through (0, 0), (1, `near`), (2, `far`) and (3, 1), at `size`.
fn along([near, far]: [f64; 2], size: f64) -> f64 {
    let middle = |s: f64, t: f64| 2.0 * s.min(t).min(0.25 * (s + t));
    let end = |s: f64, t: f64| (1.5 * s - 0.5 * t).max(0.0).min(2.0 * s);
    let secants @ [first, second, third] = [near, far - near, 1.0 - far];
    let slopes =
        [end(first, second), middle(first, second), middle(second, third), end(third, second)];
    if size > 3.0 {
        return 1.0 + (size - 3.0) * slopes[3];
    }
    let (index, t) = match size {
        ..1.0 => (0, size),
        ..2.0 => (1, size - 1.0),
        _ => (2, size - 2.0),
    };
    let (rise, left, right) = (secants[index], slopes[index], slopes[index + 1]);
    let (bend, twist) = (3.0 * rise - 2.0 * left - right, left + right - 2.0 * rise);
    [0.0, near, far][index] + t * (left + t * (bend + t * twist))
}

#[cfg(test)]
mod tests {
    use super::super::testing::{assert_close, run};
    use super::*;

    #[test]
    fn it_goes_through_its_knots() {
        let parameters = [0.25, 0.8, 0.5, 0.4, 0.5, 3.0];
        let inputs = [0.0, 1.0, 2.0, 3.0, -1.0, -2.0, -3.0];
        let outputs = [0.0, 0.6, 2.4, 3.0, -0.3, -0.6, -1.5];
        assert_close(&run(&ValveCurve, &parameters, &inputs), &outputs);
    }

    #[test]
    fn it_follows_a_parabola_and_is_monotone_whatever_its_knots() {
        let law = |u: f64| (u + 0.7 * u * u) / (1.0 + 0.7);
        let (near, far) = (law(1.0 / 3.0), law(2.0 / 3.0));
        for k in 0..=30 {
            let u = f64::from(k) / 30.0;
            assert!((along([near, far], 3.0 * u) - law(u)).abs() < 1e-12, "{u}");
        }
        for (near, far) in [(0.0, 0.1), (0.05, 1.0), (0.5, 0.5), (0.9, 0.95)] {
            let values: Vec<f64> =
                (0..400).map(|k| along([near, far], 0.01 * f64::from(k))).collect();
            let rises = |pair: &[f64]| pair[1] >= pair[0] - 1e-12;
            assert!(values.windows(2).all(rises), "{near} {far}");
        }
    }
}
