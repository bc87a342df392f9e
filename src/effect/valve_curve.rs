//! Static curve of the valve: the flow as a monotone function of the command, by straight lines
//! between knots.
//!
//! ```text
//! out(0) = 0,   out(reach/3) = inner · outer · reach,   out(2 reach/3) = outer · reach,
//! out(reach) = reach
//! ```
//!
//! and with parameters of its own, times `negative_factor`, for commands below zero. It has no law:
//! overlap, limits and progression of an unusual valve all show in its knots, and a model with it
//! follows the static curve whatever made it so. A search names it where no named effect explains
//! the curve. `reach` is the largest command of the record, and not fitted; beyond it the outer line
//! goes on.
//!
//! # References
//! Jelali, M., and Kroll, A., 2003, Hydraulic Servo-systems: Modelling, Identification and Control
//! (measured flow curves of valves); Hastie, T., Tibshirani, R., and Friedman, J., 2009, The Elements
//! of Statistical Learning, section 5.2 (piecewise linear functions).

use super::{Dimension, Effect, Equations, Moment, Parameter, RecordRange, Spec, Stage};

/// See the [module](self).
#[derive(Clone, Copy, Debug)]
pub struct ValveCurve;

static SPEC: Spec = Spec::new(
    "valve_curve",
    Stage::Input,
    "static curve of the valve without a law, by straight lines between knots",
)
.equation(
    "out = 0, inner outer reach, outer reach, reach at in = 0, 1/3, 2/3, 1 of reach, straight \
     between; for in < 0 with negative_inner, negative_outer, times negative_factor",
)
.source(
    "Jelali and Kroll, 2003, Hydraulic Servo-systems; Hastie, Tibshirani and Friedman, 2009, The \
     Elements of Statistical Learning",
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
.free_form();

const fn share(name: &'static str, meaning: &'static str, neutral: f64) -> Parameter {
    Parameter::new(name, meaning, Dimension::One).between(0.0, 1.0).neutral(neutral)
}

impl Effect for ValveCurve {
    fn spec(&self) -> &'static Spec {
        &SPEC
    }

    fn is_steady(&self) -> bool {
        true
    }

    fn equations(&self) -> Option<Equations> {
        Some(Equations::new(
            "near = if(signal < 0, negative_inner, inner)
             far = if(signal < 0, negative_outer, outer)
             factor = if(signal < 0, negative_factor, 1)
             size = if(reach > 0, 3 * abs(signal) / reach, 0)
             first = size * near * far
             second = far * (near + (size - 1) * (1 - near))
             third = far + (size - 2) * (1 - far)
             part = if(size < 1, first, if(size < 2, second, third))
             out = if(reach > 0, sign(signal) * factor * reach * part, signal)",
        ))
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
        let size = 3.0 * at.signal.abs() / reach;
        let part = if size < 1.0 {
            size * near * far
        } else if size < 2.0 {
            far * (near + (size - 1.0) * (1.0 - near))
        } else {
            far + (size - 2.0) * (1.0 - far)
        };
        (factor * reach * part).copysign(at.signal)
    }

    /// A valve with an overlap, and one with a limit.
    fn guesses(&self, record: &RecordRange<'_>) -> Vec<Vec<f64>> {
        let reach = record.size(Dimension::Input);
        let symmetric = |inner, outer| vec![inner, outer, inner, outer, 1.0, reach];
        vec![symmetric(0.3, 0.5), symmetric(0.6, 0.9)]
    }
}

#[cfg(test)]
mod tests {
    use super::super::testing::{assert_close, run};
    use super::*;

    #[test]
    fn it_goes_through_its_knots() {
        let parameters = [0.25, 0.8, 0.5, 0.4, 0.5, 3.0];
        let inputs = [0.0, 1.0, 1.5, 2.0, 3.0, 4.0, -1.0, -2.0, -3.0];
        let outputs = [0.0, 0.6, 1.5, 2.4, 3.0, 3.6, -0.3, -0.6, -1.5];
        assert_close(&run(&ValveCurve, &parameters, &inputs), &outputs);
    }
}
