//! Dead band of the valve: its lands overlap the ports, so that it opens late.
//!
//! ```text
//! out = in − upper   where in > upper
//! out = 0            where lower ≤ in ≤ upper,   lower ≤ 0 ≤ upper
//! out = in − lower   where in < lower
//! ```
//!
//! ```text
#![doc = include_str!("drawing/dead_band.txt")]
//! ```
//!
//! Its output has a corner at each end of the band. An input held at few levels shows
//! the ends only through the speeds at the levels outside.
//!
//! A limit of the flow acts after the overlap, one of the command before it. The two differ where
//! the band is not symmetric, so that a search tries both.
//!
//! # References
//! Tao, G., and Kokotović, P. V., 1996, Adaptive Control of Systems with Actuator and
//! Sensor Nonlinearities; Merritt, H. E., 1967, Hydraulic Control Systems (overlapped
//! valves).

use super::band::{is_seen, shifted};
use super::{
    CoulombFriction, Dimension, Effect, Equations, Moment, Parameter, RecordRange, Spec, Stage,
    UNLIMITED,
};

/// See the [module](self).
#[derive(Clone, Copy, Debug)]
pub struct DeadBand;

static SPEC: Spec = Spec::new(
    "dead_band",
    Stage::Input,
    "valve overlap: no flow in a band about zero, shifted outside",
)
.equation("out = max(in - upper, 0) + min(in - lower, 0)")
.source(
    "Tao and Kokotović, 1996, Adaptive Control of Systems with Actuator and Sensor \
             Nonlinearities; Merritt, 1967, Hydraulic Control Systems",
)
.drawing(include_str!("drawing/dead_band.txt"))
.parameters(&[
    Parameter::new("lower", "lower end of the band", Dimension::Input).between(-UNLIMITED, 0.0),
    Parameter::new("upper", "upper end of the band", Dimension::Input).between(0.0, UNLIMITED),
])
.confused_with(&["stiction", "flow_curve", "coulomb_friction"])
.upstream_of(&["input_saturation", "asymmetric_saturation", "flow_curve"])
.steady()
.equations(Equations::new(&["out = max(signal - upper, 0) + min(signal - lower, 0)"]));

/// Gaps between input levels in which a fit starts.
const GAPS: usize = 4;

impl Effect for DeadBand {
    fn spec(&self) -> &'static Spec {
        &SPEC
    }

    fn step(&self, parameters: &[f64], _memory: &mut [f64], at: &Moment) -> f64 {
        let &[lower, upper] = parameters else { return at.signal };
        shifted(at.signal, lower, upper)
    }

    fn shows_its_form(&self, parameters: &[f64], record: &RecordRange<'_>) -> bool {
        let &[lower, upper] = parameters else { return true };
        is_seen(lower, upper, record)
    }

    fn guesses(&self, record: &RecordRange<'_>) -> Vec<Vec<f64>> {
        record.thresholds(GAPS).into_iter().map(|end| vec![-end, end]).collect()
    }

    /// A friction without inertia is a dead band between its levels.
    fn in_place_of(&self, other: &Spec, values: &[f64]) -> Option<Vec<f64>> {
        match *values {
            [positive, negative, ..] if other.id == CoulombFriction.spec().id => {
                Some(vec![-negative, positive])
            }
            _ => None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::testing::{assert_close, run};
    use super::*;

    #[test]
    fn is_zero_inside_the_band_and_shifted_outside() {
        let inputs = [-1.0, -0.2, -0.1, 0.0, 0.3, 0.5, 2.0];
        let outputs = [-0.8, 0.0, 0.0, 0.0, 0.0, 0.2, 1.7];
        assert_close(&run(&DeadBand, &[-0.2, 0.3], &inputs), &outputs);
    }

    #[test]
    fn it_does_what_a_friction_without_inertia_did_in_whose_place_it_is_tried() {
        let (inputs, friction) = ([1.0, 0.3, -0.1, -1.0], [0.3, 0.2, 0.0]);
        let spec = CoulombFriction.spec();
        let Some(band) = DeadBand.in_place_of(spec, &friction) else { panic!("no values") };
        assert_close(&run(&DeadBand, &band, &inputs), &run(&CoulombFriction, &friction, &inputs));
        assert_eq!(DeadBand.in_place_of(DeadBand.spec(), &band), None);
    }

    #[test]
    fn it_shows_where_levels_lie_within_the_band() {
        let levels = [0.0, 0.1, 0.2, 0.5, 1.0];
        let record = RecordRange { input_levels: &levels, ..RecordRange::default() };
        assert!(DeadBand.shows_its_form(&[-0.1, 0.3], &record));
        assert!(!DeadBand.shows_its_form(&[-0.1, 0.2], &record), "at one level alone");
    }

    #[test]
    fn a_fit_starts_once_in_each_gap_between_levels() {
        let levels = [0.5, 1.0];
        let record =
            RecordRange { input_levels: &levels, input_abs_max: 1.0, ..RecordRange::default() };
        assert_eq!(DeadBand.starts(&record), [[-0.25, 0.25], [-0.75, 0.75]]);
    }
}
