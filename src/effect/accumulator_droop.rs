//! Droop of an accumulator: the gain falls with what the joint itself has lately consumed.
//!
//! ```text
//! out = in · (1 + droop · w / h)^(−h),   w' = |in| − w / recovery_time,   h = 1.4 / 2
//! ```
//!
//! A pump that is smaller than the largest demand feeds an accumulator: its pressure falls with the
//! oil that was drawn, here as the way `w` that the joint went, and recovers with the time constant
//! of the pump. Its gas expands without heat, `p V^1.4` = const, since moves last seconds, and the flow
//! through the valve goes with the root of the pressure: hence the power. At the start of a record the
//! accumulator is full. One that recovers at once is a [curve of the flow](super::FlowCurve).
//!
//! # References
//! Merritt, H. E., 1967, Hydraulic Control Systems (hydraulic power supplies with accumulators; orifice
//! equation).

use super::decay::{DECAY, DECAY_MEMORY, Decay};
use super::{Dimension, Effect, Equations, Moment, Parameter, RecordRange, Spec, Stage, UNLIMITED};

/// See the [module](self).
#[derive(Clone, Copy, Debug)]
pub struct AccumulatorDroop;

static SPEC: Spec = Spec::new(
    "accumulator_droop",
    Stage::Load,
    "accumulator: the gain falls with what the joint has lately consumed",
)
.equation("out = in (1 + droop w / 0.7)^-0.7, dw/dt = abs(in) - w / recovery_time")
.source("Merritt, 1967, Hydraulic Control Systems")
.parameters(&[
    Parameter::new(
        "droop",
        "part of the speed lost per way lately gone, near full charge",
        Dimension::PerOutput,
    )
    .between(0.0, UNLIMITED),
    Parameter::new("recovery_time", "time to recover 63 %", Dimension::Seconds)
        .between(0.0, UNLIMITED)
        .neutral(1.0),
])
.memory(1 + DECAY_MEMORY)
.confused_with(&["thermal_drift", "creep", "input_saturation"])
.limiting_case("recovery_time", &["flow_curve"])
.equations(
    Equations::new(&[
        "interval = dt\ntime_constant = recovery_time\n",
        DECAY,
        "steady = abs(signal) * recovery_time
             deviation = way - steady
             during = steady + deviation * mean
             way = steady + deviation * left
             out = signal * (1 + droop * during / 0.7)^-0.7",
    ])
    .remembering(&["way"], ""),
);

/// Half the adiabatic exponent of nitrogen: pressure goes with the whole, flow with its root.
const POWER: f64 = 0.7;

impl Effect for AccumulatorDroop {
    fn spec(&self) -> &'static Spec {
        &SPEC
    }

    /// What was consumed depends on the input, not on where the joint is.
    fn depends_on_angle(&self) -> bool {
        false
    }

    /// The memory is the way `w`, and the decay that was computed last.
    fn step(&self, parameters: &[f64], memory: &mut [f64], at: &Moment) -> f64 {
        let (&[droop, recovery_time], [way, known @ ..]) = (parameters, memory) else {
            return at.signal;
        };
        let decay = Decay::recall(known, at.dt_s, recovery_time);
        let steady = at.signal.abs() * recovery_time;
        let deviation = *way - steady;
        let during = steady + deviation * decay.mean;
        *way = steady + deviation * decay.left;
        at.signal * (1.0 + droop * during / POWER).powf(-POWER)
    }

    /// Up to where the longest move at the largest speed would use it up.
    fn bounds(&self, record: &RecordRange<'_>) -> Vec<(f64, f64)> {
        let longest = record.duration_s.max(1.0);
        let droop = 10.0 / record.size(Dimension::OutputPerSecond);
        vec![(0.0, droop), (10.0 * record.sample_period_s, longest)]
    }

    fn guesses(&self, record: &RecordRange<'_>) -> Vec<Vec<f64>> {
        let speed = record.size(Dimension::OutputPerSecond);
        let of = |recovery_s: f64| vec![0.3 / (speed * recovery_s), recovery_s];
        let slow = 100.0 * record.sample_period_s;
        vec![of(2.0 * slow), of(10.0 * slow)]
    }
}

#[cfg(test)]
mod tests {
    use super::super::testing::{assert_close, moment};
    use super::*;

    #[test]
    fn slows_down_as_it_goes_and_recovers_at_rest() {
        let mut memory = [0.0; 5];
        let mut pass = |signal: f64, dt_s: f64| {
            AccumulatorDroop.step(&[0.01, 5.0], &mut memory, &Moment { dt_s, ..moment(signal) })
        };
        let e = (-1.0_f64).exp();
        // 10 per second for 5 s: w = 50 (1 − e), on average 50 e.
        assert_close(&[pass(10.0, 5.0)], &[10.0 * (1.0 + 0.5 * e / 0.7).powf(-0.7)]);
        pass(0.0, 5.0);
        let before = 50.0 * (1.0 - e) * e;
        assert_close(&[pass(-10.0, 0.0)], &[-10.0 * (1.0 + 0.01 * before / 0.7).powf(-0.7)]);
    }
}
