//! Droop of an accumulator: the gain falls with what the joint itself has lately consumed.
//!
//! ```text
//! out = in · √p,   p = (1 + droop · w / 0.7)^(−1.4),   w' = |out| − (1 − p) / (2 · droop · recovery_time)
//! ```
//!
//! A pump that is smaller than the largest demand feeds an accumulator: its pressure `p`, in parts of
//! that at full charge, falls with the oil that was drawn, here as the way `w` that the joint went. Its
//! gas expands without heat, `p V^1.4` = const, since moves last seconds, and the flow through the valve
//! goes with the root of the pressure. The flow of the pump is proportional to the missing pressure `1 −
//! p`, and near full charge it is `w / recovery_time`. At the start of a record the accumulator is full.
//! One that recovers at once is a [curve of the flow](super::FlowCurve).
//!
//! # References
//! Merritt, H. E., 1967, Hydraulic Control Systems (pumps that hold a pressure; accumulators; orifice
//! equation).

use super::{Dimension, Effect, Equations, Moment, Parameter, RecordRange, Spec, Stage, UNLIMITED};

/// See the [module](self).
#[derive(Clone, Copy, Debug)]
pub struct AccumulatorDroop;

static SPEC: Spec = Spec::new(
    "accumulator_droop",
    Stage::Load,
    "accumulator: the gain falls with the joint's own recent consumption of oil",
)
.equation(
    "out = in sqrt(p), p = (1 + droop w / 0.7)^-1.4, dw/dt = abs(out) - (1 - p) / (2 droop recovery_time)",
)
.source("Merritt, 1967, Hydraulic Control Systems")
.parameters(&[
    Parameter::new(
        "droop",
        "part of the speed lost per unit of recent travel, near full charge",
        Dimension::PerOutput,
    )
    .between(0.0, UNLIMITED),
    Parameter::new("recovery_time", "time to recover 63 % near full charge", Dimension::Seconds)
        .between(0.0, UNLIMITED)
        .neutral(1.0),
])
.memory(1)
.confused_with(&["thermal_drift", "creep", "input_saturation"])
.limiting_case("recovery_time", &["flow_curve"])
.equations(
    Equations::new(&["pressure = (1 + droop * way / 0.7)^-1.4
             lack = 2 * droop * way
             part = if(lack < 1e-9, 1, (1 - pressure) / lack)
             filled = way + dt * abs(signal) * sqrt(pressure)
             next = if(recovery_time > 0, filled / (1 + dt * part / recovery_time), 0)
             during = (way + next) / 2
             way = next
             out = signal * (1 + droop * during / 0.7)^-0.7"])
    .remembering(&["way"], ""),
);

/// Half the adiabatic exponent of nitrogen: pressure goes with the whole, flow with its root.
const POWER: f64 = 0.7;

/// The part of the pressure below which its fall is linear in the way, to rounding.
const NOTHING: f64 = 1e-9;

impl Effect for AccumulatorDroop {
    fn spec(&self) -> &'static Spec {
        &SPEC
    }

    /// What was consumed depends on the input, not on where the joint is.
    fn depends_on_angle(&self) -> bool {
        false
    }

    /// The memory is the way `w`. Over an interval the flow to the joint is that of the charge at its start,
    /// and the flow of the pump that of the charge at its end.
    fn step(&self, parameters: &[f64], memory: &mut [f64], at: &Moment) -> f64 {
        let (&[droop, recovery_time], [way]) = (parameters, memory) else { return at.signal };
        let passed = |way: f64| (1.0 + droop * way / POWER).powf(-POWER);
        let root = passed(*way);
        let lack = 2.0 * droop * *way;
        let part = if lack < NOTHING { 1.0 } else { (1.0 - root * root) / lack };
        let filled = *way + at.dt_s * at.signal.abs() * root;
        let next =
            if recovery_time > 0.0 { filled / (1.0 + at.dt_s * part / recovery_time) } else { 0.0 };
        let during = 0.5 * (*way + next);
        *way = next;
        at.signal * passed(during)
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
    use super::super::testing::moment;
    use super::*;

    /// By Euler's method in steps that are short enough.
    fn expected(droop: f64, recovery_time: f64, signal: impl Fn(f64) -> f64, end: f64) -> f64 {
        const STEP: f64 = 1e-5;
        let (mut way, mut time, mut out) = (0.0_f64, 0.0, 0.0);
        while time < end {
            let pressure = (1.0 + droop * way / 0.7_f64).powf(-1.4);
            out = signal(time) * pressure.sqrt();
            way += STEP * (f64::abs(out) - (1.0 - pressure) / (2.0 * droop * recovery_time));
            time += STEP;
        }
        out
    }

    #[test]
    fn slows_down_as_it_goes_and_recovers_at_rest() {
        let signal = |time: f64| match time {
            t if t < 5.0 => 10.0,
            t if t < 8.0 => 0.0,
            _ => -10.0,
        };
        let mut memory = [0.0; 1];
        let mut pass = |k: i32| {
            let at = Moment { dt_s: 0.01, ..moment(signal(0.01 * (f64::from(k) + 0.5))) };
            AccumulatorDroop.step(&[0.02, 5.0], &mut memory, &at)
        };
        let outs: Vec<f64> = (0..820).map(&mut pass).collect();
        for (k, end) in [(499, 5.0), (800, 8.01), (819, 8.2)] {
            let expected = expected(0.02, 5.0, signal, end);
            assert!((outs[k] / expected - 1.0).abs() < 2e-3, "{} is not {expected}", outs[k]);
        }
        assert!(
            outs[499] < 7.0 && outs[800].abs() > outs[499] + 0.5,
            "{} {}",
            outs[499],
            outs[800]
        );
    }
}
