//! Thermal drift: the gain changes over the record as the oil warms.
//!
//! ```text
//! out = in · max(1 + rate · T · (1 − exp(−t / T)), 0.05),   T = time_constant
//! ```
//!
//! The gain drifts at `rate` at the start of the record and settles `rate · T` from where
//! it began. Written with the rate, and not with the change in the end, the equation has a
//! plain limit for a record that is short against the time constant: a straight line,
//! `1 + rate · t`. In that limit the time constant cannot be determined.
//!
//! # References
//! Merritt, H. E., 1967, Hydraulic Control Systems (viscosity and temperature); the
//! exponential is that of a body that warms toward its surroundings.

use super::{Dimension, Effect, Equations, Moment, Parameter, RecordRange, Spec, Stage, UNLIMITED};

/// See the [module](self).
#[derive(Clone, Copy, Debug)]
pub struct ThermalDrift;

/// Time constant of a change of the oil's temperature, seconds, at least. Chosen: a third of the minute that
/// oil stays in a small reservoir.
const FASTEST_S: f64 = 20.0;

static SPEC: Spec =
    Spec::new("thermal_drift", Stage::Load, "the gain drifts over the record as the oil warms")
        .equation("out = in (1 + rate time_constant (1 - exp(-t / time_constant)))")
        .source("Merritt, 1967, Hydraulic Control Systems")
        .parameters(&[
            Parameter::new("rate", "relative drift of the gain at the start", Dimension::PerSecond)
                .between(-10.0, 10.0),
            Parameter::new("time_constant", "time to 63 % of the drift", Dimension::Seconds)
                .between(0.0, UNLIMITED)
                .plausible(FASTEST_S, f64::INFINITY)
                .neutral(UNLIMITED),
        ])
        .confused_with(&["supply_droop"])
        .equations(Equations::new(&["share = -expm1(-time / max(time_constant, 1e-300))
             out = signal * max(1 + rate * time_constant * share, 0.05)"]));

/// Smallest factor that is left of the gain.
const SMALLEST_FACTOR: f64 = 0.05;

/// Range of the time constant in a fit, in lengths of the record: from a drift that is
/// over at once to one that is straight to 1 part in 2000.
const FITTED_TIME_CONSTANT: (f64, f64) = (0.01, 1000.0);

/// Largest drift in a fit over the record's length, were it to go on at its first rate.
const FITTED_CHANGE: f64 = 20.0;

impl Effect for ThermalDrift {
    fn spec(&self) -> &'static Spec {
        &SPEC
    }

    fn depends_on_warmth(&self) -> bool {
        true
    }

    fn step(&self, parameters: &[f64], _memory: &mut [f64], at: &Moment) -> f64 {
        let &[rate, time_constant] = parameters else { return at.signal };
        let share = -(-at.time_s / time_constant.max(f64::MIN_POSITIVE)).exp_m1();
        at.signal * (1.0 + rate * time_constant * share).max(SMALLEST_FACTOR)
    }

    fn bounds(&self, record: &RecordRange<'_>) -> Vec<(f64, f64)> {
        let (_, length_s) = record.extent(Dimension::Seconds);
        let (low, high) = FITTED_TIME_CONSTANT;
        let rate = (FITTED_CHANGE / length_s).min(10.0);
        vec![(-rate, rate), (low * length_s, (high * length_s).min(UNLIMITED))]
    }

    fn guesses(&self, record: &RecordRange<'_>) -> Vec<Vec<f64>> {
        let (_, length_s) = record.extent(Dimension::Seconds);
        let rate = 0.3 / length_s;
        vec![vec![rate, 0.5 * length_s], vec![-rate, 0.5 * length_s]]
    }
}

#[cfg(test)]
mod tests {
    use super::super::testing::{assert_close, assert_close_to, moment};
    use super::*;

    fn drifted(parameters: [f64; 2], time_s: f64) -> f64 {
        ThermalDrift.step(&parameters, &mut [], &Moment { time_s, ..moment(10.0) })
    }

    #[test]
    fn settles_after_its_time_constant() {
        let e = (-1.0_f64).exp();
        let found = [0.0, 40.0, 4000.0].map(|time_s| drifted([0.005, 40.0], time_s));
        assert_close(&found, &[10.0, 10.0 + 2.0 * (1.0 - e), 12.0]);
    }

    #[test]
    fn is_a_straight_line_without_a_time_constant() {
        // Straight to t / 2T, which is 2.5e-11.
        assert_close_to(&[drifted([0.001, UNLIMITED], 50.0)], &[10.5], 1e-10);
        assert_close(&[drifted([-0.1, UNLIMITED], 50.0)], &[0.5]);
    }
}
