//! A placebo: an effect that means nothing, to calibrate the others against.
//!
//! ```text
//! out = in · (1 + amplitude · sin(2π t / 17.3 s + 0.7))
//! ```
//!
//! No joint has it. Fitted to any record it lowers the error a little, as one more
//! parameter does; an effect that helps no more than this one explains nothing. It is not
//! in the catalogue.

use std::f64::consts::TAU;

use super::{Dimension, Effect, Moment, Parameter, Spec, Stage};

/// See the [module](self).
#[derive(Clone, Copy, Debug)]
pub struct Placebo;

/// Seconds; odd, so that no machine keeps time with it.
const PERIOD_S: f64 = 17.3;

/// Radians at the start of the record.
const PHASE: f64 = 0.7;

static SPEC: Spec = Spec::new(
    "placebo",
    Stage::Load,
    "means nothing: a slow swing of the gain, to compare real effects with",
)
.equation("out = in (1 + amplitude sin(2 pi t / 17.3 s + 0.7))")
.source("none: made up")
.parameters(&[
    Parameter::new("amplitude", "relative swing of the gain", Dimension::One).between(-0.9, 0.9)
]);

impl Effect for Placebo {
    fn spec(&self) -> &'static Spec {
        &SPEC
    }

    fn step(&self, parameters: &[f64], _memory: &mut [f64], at: &Moment) -> f64 {
        let &[amplitude] = parameters else { return at.signal };
        at.signal * (1.0 + amplitude * (TAU / PERIOD_S * at.time_s + PHASE).sin())
    }
}

#[cfg(test)]
mod tests {
    use super::super::testing::{assert_close, moment};
    use super::*;

    #[test]
    fn swings_with_its_period() {
        let speed = |time_s| Placebo.step(&[0.5], &mut [], &Moment { time_s, ..moment(2.0) });
        let first = 2.0 + 0.7_f64.sin();
        assert_close(&[speed(0.0), speed(17.3), speed(8.65)], &[first, first, 4.0 - first]);
    }
}
