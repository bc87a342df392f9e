//! End stops: the hardware lets the joint go no further.
//!
//! ```text
//! out = min(max(in, low), high)
//! ```
//!
//! ```text
#![doc = include_str!("drawing/end_stop.txt")]
//! ```
//!
//! It acts on the state: a joint that has run into a stop leaves it as soon as the input
//! turns. The stops are rigid, without bounce. They are neutral at ∓1e12, which stands
//! for none; a fit looks for them near the angles of the record, where a stop that the
//! joint never reaches has no effect either.
//!
//! # References
//! Jelali, M., and Kroll, A., 2003, Hydraulic Servo-systems (stroke of the cylinder).

use super::{Dimension, Effect, Equations, Moment, Parameter, RecordRange, Spec, Stage, UNLIMITED};

/// See the [module](self).
#[derive(Clone, Copy, Debug)]
pub struct EndStop;

static SPEC: Spec = Spec::new("end_stop", Stage::Output, "hardware limits of the angle")
    .equation("low <= y <= high")
    .source("Jelali and Kroll, 2003, Hydraulic Servo-systems")
    .drawing(include_str!("drawing/end_stop.txt"))
    .parameters(&[
        Parameter::new("low", "lowest angle", Dimension::Output).neutral(-UNLIMITED),
        Parameter::new("high", "highest angle", Dimension::Output).neutral(UNLIMITED),
    ])
    .confused_with(&["input_saturation"])
    .acting_on_state()
    .equations(Equations::new(&["out = min(max(signal, low), high)"]));

impl Effect for EndStop {
    fn spec(&self) -> &'static Spec {
        &SPEC
    }

    fn step(&self, parameters: &[f64], _memory: &mut [f64], at: &Moment) -> f64 {
        let &[low, high] = parameters else { return at.signal };
        at.signal.max(low).min(high)
    }

    fn fault(&self, parameters: &[f64]) -> Option<&'static str> {
        let &[low, high] = parameters else { return None };
        (low > high).then_some("has its `low` above its `high`")
    }

    /// Each stop on its side of the middle, as far out as one more span.
    fn bounds(&self, record: &RecordRange<'_>) -> Vec<(f64, f64)> {
        let (lowest, highest) = record.extent(Dimension::Output);
        let middle = record.output_middle();
        vec![(lowest, middle), (middle, highest)]
    }

    fn guesses(&self, record: &RecordRange<'_>) -> Vec<Vec<f64>> {
        vec![vec![record.output_min, record.output_max]]
    }
}

#[cfg(test)]
mod tests {
    use super::super::testing::{assert_close, run};
    use super::*;

    #[test]
    fn nothing_passes_the_stops() {
        assert_close(&run(&EndStop, &[-10.0, 30.0], &[-11.0, 5.0, 31.0]), &[-10.0, 5.0, 30.0]);
    }
}
