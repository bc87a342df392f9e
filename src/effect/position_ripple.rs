//! Ripple: the gain rises and falls with the angle, as of the pistons of a hydraulic motor or the
//! teeth of a gear.
//!
//! ```text
//! out = in · max(1 + amplitude · sin(2π y / period + phase), 0.05)
//! ```
//!
//! A radial piston motor of `n` pistons has a period of `1/n` turn or less. `phase` means nothing
//! while `amplitude` is 0, and is an angle on a circle.
//!
//! # References
//! Ivantysyn, J., and Ivantysynova, M., 2001, Hydrostatic Pumps and Motors (flow ripple of piston
//! machines).

use std::f64::consts::{FRAC_PI_2, TAU};

use super::{Dimension, Effect, Equations, Moment, Parameter, RecordRange, Spec, Stage};

/// See the [module](self).
#[derive(Clone, Copy, Debug)]
pub struct PositionRipple;

static SPEC: Spec = Spec::new(
    "position_ripple",
    Stage::Load,
    "the gain ripples with the angle, as with a piston motor or a gear",
)
.equation("out = in (1 + amplitude sin(2 pi y / period + phase))")
.source("Ivantysyn and Ivantysynova, 2001, Hydrostatic Pumps and Motors")
.parameters(&[
    Parameter::new("amplitude", "part by which the gain rises and falls", Dimension::One)
        .between(0.0, 0.95)
        .typical(0.1),
    Parameter::new("period", "angle from one crest to the next", Dimension::Output)
        .between(1e-9, super::UNLIMITED)
        .plausible(0.0, LONGEST)
        .neutral(1.0),
    Parameter::new("phase", "phase at the angle 0, rad", Dimension::One).between(-TAU, TAU),
])
.confused_with(&["position_gain", "gravity_load"])
.equations(Equations::new(&["ripple = amplitude * sin(2 * pi * position / period + phase)
             out = signal * max(1 + ripple, 0.05)"]));

/// The longest period that is plausible, in parts of the span of the output: one that the record shows
/// twice. What does not repeat is a linkage.
const LONGEST: f64 = 0.5;

/// Smallest factor that is left of the gain.
const SMALLEST_FACTOR: f64 = 0.05;

impl Effect for PositionRipple {
    fn spec(&self) -> &'static Spec {
        &SPEC
    }

    fn step(&self, parameters: &[f64], _memory: &mut [f64], at: &Moment) -> f64 {
        let &[amplitude, period, phase] = parameters else { return at.signal };
        let ripple = amplitude * (TAU * at.position / period + phase).sin();
        at.signal * (1.0 + ripple).max(SMALLEST_FACTOR)
    }

    /// Periods that the record shows once or more: beyond those that are plausible, so that a descent which
    /// wants a longer one is seen to.
    fn bounds(&self, record: &RecordRange<'_>) -> Vec<(f64, f64)> {
        let span = record.output_span();
        vec![(0.0, 0.95), (1e-3 * span, span), (-TAU, TAU)]
    }

    /// At the period at which the record ripples most.
    fn guesses(&self, record: &RecordRange<'_>) -> Vec<Vec<f64>> {
        let period = record.ripple_period.unwrap_or(0.1 * record.output_span());
        let quarters = [0.0, FRAC_PI_2, 2.0 * FRAC_PI_2, -FRAC_PI_2];
        quarters.map(|phase| vec![0.1, period, phase]).to_vec()
    }
}

#[cfg(test)]
mod tests {
    use super::super::testing::{assert_close, moment};
    use super::*;

    #[test]
    fn repeats_with_its_period() {
        let gain = |position| {
            let at = Moment { position, ..moment(10.0) };
            PositionRipple.step(&[0.2, 8.0, 0.0], &mut [], &at)
        };
        assert_close(&[0.0, 2.0, 6.0, 10.0, -6.0].map(gain), &[10.0, 12.0, 8.0, 12.0, 12.0]);
    }
}
