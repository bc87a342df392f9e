//! Asymmetric friction: both the constant and the viscous part of it differ by direction.
//!
//! ```text
//! time_constant · v' + v = in − positive                      while v > 0
//! time_constant · v' + negative_viscous · v = in + negative   while v < 0
//! v = 0                                    while −negative ≤ in ≤ positive at rest
//! ```
//!
//! `v` is the speed in input units (the gain follows), so that the gain of the joint is that of
//! positive motion. In parts of mass and viscous friction, `M a + Fv± v + Fc± sign(v) = F`, these
//! are `time_constant = M / Fv+` and `negative_viscous = Fv− / Fv+`. A screw or a seal that is worn
//! on one side, or oil that leaves by another way than it came.
//!
//! A [direction gain](super::DirectionGain) before a [Coulomb friction](super::CoulombFriction)
//! is not the same: it changes the force of a direction, and with it what the constant part and the
//! inertia take of it, while here a joint that coasts against its input is braked by the friction of
//! the direction in which it moves.
//!
//! It contains [`CoulombFriction`](super::CoulombFriction), as the case `negative_viscous = 1`, and
//! is looked for only where that is found.
//!
//! # References
//! Janot, A., Gautier, M., and Brunot, M., 2019, Data Set and Reference Models of EMPS, Workshop on
//! Nonlinear System Identification Benchmarks (a drive whose friction is asymmetric);
//! Armstrong-Hélouvry, B., Dupont, P., and Canudas de Wit, C., 1994, A survey of models,
//! analysis tools and compensation methods for the control of machines with friction,
//! Automatica 30.

use super::coulomb_friction::{GAPS, NEGATIVE, POSITIVE, TIME_CONSTANT};
use super::decay::LAG_DECAY;
use super::sliding::{self, SLIDING_MEMORY};
use super::{Dimension, Effect, Equations, Moment, Parameter, RecordRange, Spec, Stage};

/// See the [module](self).
#[derive(Clone, Copy, Debug)]
pub struct AsymmetricFriction;

static SPEC: Spec = Spec::new(
    "asymmetric_friction",
    Stage::Dynamics,
    "friction whose constant and viscous part differ by direction",
)
.equation(
    "time_constant dv/dt + v = in - positive where v > 0, time_constant dv/dt + \
               negative_viscous v = in + negative where v < 0; v = 0 while -negative <= in <= \
               positive",
)
.source(
    "Janot, Gautier and Brunot, 2019, Data Set and Reference Models of EMPS; \
             Armstrong-Hélouvry, Dupont and Canudas de Wit, 1994, A survey of models, analysis \
             tools and compensation methods for the control of machines with friction, \
             Automatica 30",
)
.parameters(&[
    POSITIVE,
    NEGATIVE,
    TIME_CONSTANT,
    Parameter::new(
        "negative_viscous",
        "viscous friction of negative motion over that of positive motion",
        Dimension::One,
    )
    .between(0.05, 20.0)
    .neutral(1.0),
])
.memory(SLIDING_MEMORY)
.confused_with(&["coulomb_friction", "direction_gain", "gravity_load"])
.absorbing(&["coulomb_friction", "actuator_lag"])
.refining("coulomb_friction")
.looking_like_both(&[["dead_band", "direction_gain"], ["coulomb_friction", "direction_gain"]])
.limiting_case("time_constant", &["dead_band", "direction_gain"])
.equations(
    Equations::new(&[
        "force = max(signal - positive, 0) + min(signal + negative, 0)
             moving = if(speed > 0, signal - positive, signal + negative)
             drive = if(speed == 0, force, moving)
             viscous = if(if(speed == 0, force, speed) < 0, negative_viscous, 1)
             from_rest = if(force < 0, negative_viscous, 1)
             is_braked = speed * drive < 0
             slowing = time_constant / viscous
             stop = if(is_braked, slowing * ln1p(-speed * viscous / if(is_braked, drive, 1)), dt)
             stops = stop < dt
             interval = if(stops, dt - stop, dt)
             lag = time_constant / if(stops, from_rest, viscous)\n",
        LAG_DECAY,
        "target = if(stops, force / from_rest, drive / viscous)
             deviation = if(stops, 0, speed) - target
             braking = if(stops, drive / viscous * stop + slowing * speed, 0)
             speed = if(time_constant <= 0, force / from_rest, target + deviation * left)
             moved = braking + interval * (target + deviation * mean)
             out = if(time_constant <= 0, force / from_rest, moved / dt)",
    ])
    .remembering(
        &["speed"],
        "force = max(signal - positive, 0) + min(signal + negative, 0)
             speed = force / if(force < 0, negative_viscous, 1)",
    ),
);

impl Effect for AsymmetricFriction {
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

    fn guesses(&self, record: &RecordRange<'_>) -> Vec<Vec<f64>> {
        let levels = record.thresholds(GAPS);
        let pair =
            |level: f64| [0.0, 0.1].map(|time_constant| vec![level, level, time_constant, 1.0]);
        levels.into_iter().flat_map(pair).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::super::CoulombFriction;
    use super::super::testing::{assert_close, moment, run};
    use super::*;

    #[test]
    fn with_the_same_viscous_friction_both_ways_it_is_coulomb_friction() {
        let inputs = [1.0, 0.1, -1.0, -0.1, 0.5];
        let plain = run(&CoulombFriction, &[0.3, 0.2, 0.05], &inputs);
        assert_close(&run(&AsymmetricFriction, &[0.3, 0.2, 0.05, 1.0], &inputs), &plain);
    }

    #[test]
    fn turns_with_the_friction_of_each_direction() {
        // T = 1 s, levels 1, input −2, v = 3(e − 1): the drive −3 brakes for 1 s, over a way of
        // 3(e − 1) − 3; then the force −1 moves it against twice the viscous friction: to −1/2,
        // with a time constant of 1/2 s, for 1 s a way of −(1 − (1 − e^−2)/2)/2.
        let mut memory = [0.0; SLIDING_MEMORY];
        memory[0] = 3.0 * (std::f64::consts::E - 1.0);
        let at = Moment { dt_s: 2.0, ..moment(-2.0) };
        let mean = AsymmetricFriction.step(&[1.0, 1.0, 1.0, 2.0], &mut memory, &at);
        let decayed = (-2.0_f64).exp();
        let way = 3.0 * (std::f64::consts::E - 2.0) - 0.5 * (1.0 - 0.5 * (1.0 - decayed));
        assert_close(&[2.0 * mean, memory[0]], &[way, -0.5 * (1.0 - decayed)]);
    }
}
