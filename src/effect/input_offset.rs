//! Null offset: the valve is not centred when the input is zero, or the input is coded with another
//! neutral, as the width of a pulse is.
//!
//! ```text
//! out = in + offset
//! ```
//!
//! The joint creeps at `gain · offset` when the input is zero, at every angle alike.
//! The offset lies before the dead band, which may hide it.
//!
//! # References
//! Merritt, H. E., 1967, Hydraulic Control Systems (null shift of a valve).

use super::{Dimension, Effect, Equations, Moment, Parameter, RecordRange, Spec, Stage};

/// See the [module](self).
#[derive(Clone, Copy, Debug)]
pub struct InputOffset;

static SPEC: Spec = Spec::new(
    "input_offset",
    Stage::Input,
    "null offset: the joint stands still at an input other than zero",
)
.equation("out = in + offset")
.source("Merritt, 1967, Hydraulic Control Systems")
.parameters(&[
    Parameter::new("offset", "what is added to the input", Dimension::Input).typical(0.02)
])
.confused_with(&["direction_gain", "leakage", "coulomb_friction", "gravity_load"])
.upstream_of(&[
    "dead_band",
    "stiction",
    "asymmetric_stiction",
    "input_saturation",
    "asymmetric_saturation",
    "flow_curve",
    "direction_gain",
    "valve_curve",
])
.steady()
.equations(Equations::new(&["out = signal + offset"]));

impl Effect for InputOffset {
    fn spec(&self) -> &'static Spec {
        &SPEC
    }

    fn step(&self, parameters: &[f64], _memory: &mut [f64], at: &Moment) -> f64 {
        let &[offset] = parameters else { return at.signal };
        at.signal + offset
    }

    /// About the one that takes a coded input to its neutral.
    fn bounds(&self, record: &RecordRange<'_>) -> Vec<(f64, f64)> {
        let own = SPEC.parameters.iter().map(|parameter| parameter.bounds(record));
        own.map(|(low, high)| (low - record.input_neutral, high - record.input_neutral)).collect()
    }

    fn guesses(&self, record: &RecordRange<'_>) -> Vec<Vec<f64>> {
        let own = SPEC.parameters.iter().map(|parameter| parameter.start(record));
        vec![own.map(|start| start - record.input_neutral).collect()]
    }
}

#[cfg(test)]
mod tests {
    use super::super::testing::{assert_close, run};
    use super::*;

    #[test]
    fn adds_the_offset() {
        assert_close(&run(&InputOffset, &[-0.25], &[0.0, 1.0, -2.0]), &[-0.25, 0.75, -2.25]);
    }
}
