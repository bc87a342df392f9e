//! Coulomb friction: a constant force against the motion, and rest while it suffices.
//!
//! ```text
//! time_constant · v' + v = in − positive   while v > 0
//! time_constant · v' + v = in + negative   while v < 0
//! v = 0                                    while −negative ≤ in ≤ positive at rest
//! ```
//!
//! ```text
#![doc = include_str!("drawing/coulomb_friction.txt")]
//! ```
//!
//! `v` is the speed in input units (the gain follows), `in` the driving force in units of
//! the input that makes it. With `time_constant = 0` there is no inertia, and what is
//! left is exactly a [dead band](super::DeadBand) from `−negative` to `positive`: only
//! inertia separates the two, since a joint that coasts is braked to a stop, and does
//! not fade out. Viscous friction is the same both ways here; where it is not, see
//! [`AsymmetricFriction`](super::AsymmetricFriction).
//!
//! The inertia is therefore part of this effect, and it contains
//! [`ActuatorLag`](super::ActuatorLag): a friction before a separate lag would have to
//! guess when the lag's speed passes zero, and would be wrong by up to
//! `gain · positive · dt` in the angle at each stop. Here the time of the stop is found in
//! closed form (`sliding.rs`).
//!
//! A spool that lags before its overlap makes a joint start late and stop early, too: a
//! [dead band](super::DeadBand) with a [`SpoolLag`](super::SpoolLag) is distinguished from a friction with
//! inertia by how it starts.
//!
//! The direction of motion is that of the effect's own speed. Loads that follow it in the
//! model, such as leakage, do not move the joint against its friction. Breakaway above
//! the sliding level is [stiction](super::Stiction), and not in here.
//!
//! # References
//! Armstrong-Hélouvry, B., Dupont, P., and Canudas de Wit, C., 1994, A survey of models,
//! analysis tools and compensation methods for the control of machines with friction,
//! Automatica 30; Åström, K. J., and Canudas de Wit, C., 2008, Revisiting the `LuGre`
//! friction model, IEEE Control Systems Magazine 28.

use super::band::is_seen;
use super::decay::DECAY;
use super::sliding::{self, SLIDING_MEMORY};
use super::{Dimension, Effect, Equations, Moment, Parameter, RecordRange, Spec, Stage, UNLIMITED};

/// See the [module](self).
#[derive(Clone, Copy, Debug)]
pub struct CoulombFriction;

static SPEC: Spec = Spec::new(
    "coulomb_friction",
    Stage::Dynamics,
    "a constant force against the motion, which may differ by direction",
)
.equation(
    "time_constant dv/dt + v = in - positive where v > 0, in + negative where v < 0; \
               v = 0 while -negative <= in <= positive",
)
.source(
    "Armstrong-Hélouvry, Dupont and Canudas de Wit, 1994, A survey of models, analysis \
             tools and compensation methods for the control of machines with friction, \
             Automatica 30; Åström and Canudas de Wit, 2008, Revisiting the LuGre friction model",
)
.drawing(include_str!("drawing/coulomb_friction.txt"))
.parameters(&[POSITIVE, NEGATIVE, TIME_CONSTANT])
.memory(SLIDING_MEMORY)
.confused_with(&["dead_band", "stiction", "input_offset", "flow_curve"])
.absorbing(&["actuator_lag"])
.limiting_case("time_constant", &["dead_band"])
.looking_like_both(&[["dead_band", "spool_lag"], ["dead_band", "actuator_lag"]])
.equations(
    Equations::new(&[
        "force = max(signal - positive, 0) + min(signal + negative, 0)
             moving = if(speed > 0, signal - positive, signal + negative)
             drive = if(speed == 0, force, moving)
             is_braked = speed * drive < 0
             stop = if(is_braked, time_constant * ln1p(-speed / if(is_braked, drive, 1)), dt)
             stops = stop < dt
             interval = if(stops, dt - stop, dt)\n",
        DECAY,
        "target = if(stops, force, drive)
             deviation = if(stops, 0, speed) - target
             braking = if(stops, drive * stop + time_constant * speed, 0)
             speed = if(time_constant <= 0, force, target + deviation * left)
             moved = braking + interval * (target + deviation * mean)
             out = if(time_constant <= 0, force, moved / dt)",
    ])
    .remembering(&["speed"], "speed = max(signal - positive, 0) + min(signal + negative, 0)"),
);

/// Parameters that the asymmetric form has, too.
pub(super) const POSITIVE: Parameter =
    Parameter::new("positive", "level against positive motion", Dimension::Input)
        .between(0.0, UNLIMITED);
pub(super) const NEGATIVE: Parameter =
    Parameter::new("negative", "level against negative motion", Dimension::Input)
        .between(0.0, UNLIMITED);
pub(super) const TIME_CONSTANT: Parameter =
    Parameter::new("time_constant", "inertia: time to 63 % of a change", Dimension::Seconds)
        .between(0.0, UNLIMITED);

/// Gaps between input levels in which a fit starts.
pub(super) const GAPS: usize = 3;

impl Effect for CoulombFriction {
    fn spec(&self) -> &'static Spec {
        &SPEC
    }

    /// The memory is the speed in input units, and the decay that was computed last.
    fn step(&self, parameters: &[f64], memory: &mut [f64], at: &Moment) -> f64 {
        sliding::step(parameters, memory, at)
    }

    fn settle(&self, parameters: &[f64], memory: &mut [f64], at: &Moment) {
        sliding::settle(parameters, memory, at);
    }

    fn shows_its_form(&self, parameters: &[f64], record: &RecordRange<'_>) -> bool {
        let &[positive, negative, _] = parameters else { return true };
        is_seen(-negative, positive, record)
    }

    fn guesses(&self, record: &RecordRange<'_>) -> Vec<Vec<f64>> {
        let levels = record.thresholds(GAPS);
        let pair = |level: f64| [0.0, 0.1].map(|time_constant| vec![level, level, time_constant]);
        levels.into_iter().flat_map(pair).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::super::testing::{assert_close, moment, run};
    use super::*;

    #[test]
    fn without_friction_it_is_a_lag() {
        let inputs = [1.0, 1.0, -2.0, -2.0, 0.0];
        let lag = run(&super::super::ActuatorLag, &[0.03], &inputs);
        assert_close(&run(&CoulombFriction, &[0.0, 0.0, 0.03], &inputs), &lag);
    }

    #[test]
    fn coasts_to_a_stop_and_rests() {
        // T = 1 s, level 1, from v = e − 1 without input: v = e^(1 − t) − 1, so it stops
        // after 1 s, having gone T v(0) − level · 1 s = e − 2.
        let mut memory = [0.0; 5];
        memory[0] = std::f64::consts::E - 1.0;
        let at = Moment { dt_s: 4.0, ..moment(0.0) };
        let mean = CoulombFriction.step(&[1.0, 1.0, 1.0], &mut memory, &at);
        assert_close(&[4.0 * mean, memory[0]], &[std::f64::consts::E - 2.0, 0.0]);
        assert_close(&[CoulombFriction.step(&[1.0, 1.0, 1.0], &mut memory, &at)], &[0.0]);
    }

    #[test]
    fn turns_within_an_interval() {
        // T = 1 s, levels 1, input −2, v = 3(e − 1): the drive −3 brakes for 1 s, over a
        // way of 3(e − 1) − 3; then the force is −1, for 1 s a way of −(1 − (1 − 1/e)).
        let mut memory = [0.0; 5];
        memory[0] = 3.0 * (std::f64::consts::E - 1.0);
        let at = Moment { dt_s: 2.0, ..moment(-2.0) };
        let mean = CoulombFriction.step(&[1.0, 1.0, 1.0], &mut memory, &at);
        let e = (-1.0_f64).exp();
        let way = 3.0 * (std::f64::consts::E - 2.0) - e;
        assert_close(&[2.0 * mean, memory[0]], &[way, e - 1.0]);
    }

    #[test]
    fn the_smallest_inertia_is_almost_none() {
        let inputs = [1.0, 0.1, -1.0, -0.1, 0.5];
        let none = run(&CoulombFriction, &[0.3, 0.2, 0.0], &inputs);
        assert_close(&run(&CoulombFriction, &[0.3, 0.2, 1e-16], &inputs), &none);
    }
}
