//! Leakage: oil that passes the piston lets the joint drift toward an angle.
//!
//! ```text
//! out = in − rate · (y − y0)
//! ```
//!
//! `y0` is the angle at which the load is in balance; the load is taken as linear in the
//! angle about it. Where the drift hardly changes over the angles of the record, `y0` lies
//! far outside and only `rate · y0` is determined: an [offset](super::InputOffset).
//! Where the input stays far from zero, so does `y0`: the output would come to rest there with
//! an input of zero, which the record never had.
//!
//! # References
//! Merritt, H. E., 1967, Hydraulic Control Systems (leakage past the piston).

use super::{Dimension, Effect, Equations, Moment, Parameter, RecordRange, Spec, Stage};

/// See the [module](self).
#[derive(Clone, Copy, Debug)]
pub struct Leakage;

static SPEC: Spec = Spec::new("leakage", Stage::Load, "drifts toward an angle, whatever the input")
    .equation("out = in - rate (y - y0)")
    .source("Merritt, 1967, Hydraulic Control Systems")
    .parameters(&[
        Parameter::new("rate", "speed of the drift per distance", Dimension::PerSecond)
            .between(0.0, 100.0),
        Parameter::new("y0", "angle toward which it drifts", Dimension::Output),
    ])
    .confused_with(&["gravity_load", "input_offset"])
    .equations(Equations::new(&["out = signal - rate * (position - y0)"]));

impl Effect for Leakage {
    fn spec(&self) -> &'static Spec {
        &SPEC
    }

    fn step(&self, parameters: &[f64], _memory: &mut [f64], at: &Moment) -> f64 {
        let &[rate, y0] = parameters else { return at.signal };
        at.signal - rate * (at.position - y0)
    }

    /// A drift that is over within two samples is not seen.
    fn bounds(&self, record: &RecordRange<'_>) -> Vec<(f64, f64)> {
        /// Fastest drift of an angle by oil that passes the piston, 1/s: chosen.
        const LEAKING: f64 = 10.0;
        let seen = (0.5 / record.sample_period_s).max(LEAKING);
        let [rate, y0] = SPEC.parameters else { return Vec::new() };
        let (low, high) = rate.bounds(record);
        vec![(low, high.min(seen)), at_zero(y0.bounds(record), record)]
    }

    /// Toward either end of the record and toward its middle.
    fn guesses(&self, record: &RecordRange<'_>) -> Vec<Vec<f64>> {
        let speed = record.size(Dimension::OutputPerSecond);
        let rate = 0.05 * speed / record.output_span();
        let angles = [record.output_min, record.output_middle(), record.output_max];
        angles.into_iter().map(|y0| vec![rate, y0]).collect()
    }
}

/// The bounds of `y0`, wider where the input stays far from zero: the rest at an input of zero then
/// lies as many times the output's range beyond the record as zero lies beyond the input's.
fn at_zero((low, high): (f64, f64), record: &RecordRange<'_>) -> (f64, f64) {
    /// Farthest, in ranges of the output: chosen, beyond it an offset is the simpler model.
    const FARTHEST: f64 = 20.0;
    let half_span = 0.5 * record.input_span;
    let times = if half_span > 0.0 { record.input_abs_max / half_span } else { 1.0 };
    let times = times.clamp(1.0, FARTHEST);
    let beyond = (times - 1.0) * record.output_span();
    (low - beyond, high + beyond)
}

#[cfg(test)]
mod tests {
    use super::super::testing::{assert_close, moment};
    use super::*;

    #[test]
    fn drifts_toward_its_angle() {
        let speed =
            |position| Leakage.step(&[0.1, 20.0], &mut [], &Moment { position, ..moment(5.0) });
        assert_close(&[20.0, 40.0, 0.0].map(speed), &[5.0, 3.0, 7.0]);
    }

    #[test]
    fn comes_to_rest_far_outside_where_the_input_never_was_near_zero() {
        let (output_min, output_max) = (10.0, 20.0);
        let about_zero = RecordRange { output_min, output_max, ..RecordRange::default() };
        assert_eq!(Leakage.bounds(&about_zero)[1], (0.0, 30.0));
        let far = RecordRange { input_abs_max: 9.0, input_span: 2.0, ..about_zero };
        assert_eq!(Leakage.bounds(&far)[1], (-80.0, 110.0));
        let constant = RecordRange { input_abs_max: 9.0, input_span: 0.0, ..about_zero };
        assert_eq!(Leakage.bounds(&constant)[1], (0.0, 30.0));
    }
}
