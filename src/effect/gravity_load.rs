//! Gravity: the weight of the arm raises the pressure one way and lowers it the other.
//!
//! ```text
//! g = cos(y − y0)
//! out = in · √(1 − sign(in) · kappa · g) − creep · g
//! ```
//!
//! The flow through an open valve goes with the root of the pressure left for it; `kappa`
//! is the largest load pressure over the supply pressure. `creep` is the speed at which
//! the weight lowers the joint past a closed valve. At the angle `y0` (in output units, an
//! arm that lies level) gravity acts in full against positive motion.
//!
//! `y0` is an angle on a circle: `kappa` and `creep` with their signs turned, and `y0` half
//! a turn on, are the same. It means nothing while both are 0. The load is quasi-static:
//! without the force of acceleration, and without the linkage between cylinder and joint.
//!
//! # References
//! Merritt, H. E., 1967, Hydraulic Control Systems (orifice equation, valve with a load);
//! Jelali, M., and Kroll, A., 2003, Hydraulic Servo-systems.

use super::{Dimension, Effect, Equations, Moment, Parameter, RecordRange, Spec, Stage, UNLIMITED};

/// See the [module](self).
#[derive(Clone, Copy, Debug)]
pub struct GravityLoad;

static SPEC: Spec = Spec::new(
    "gravity_load",
    Stage::Load,
    "weight of the arm: slower up, faster down, and creep, by the angle",
)
.equation("out = in sqrt(1 - sign(in) kappa cos(y - y0)) - creep cos(y - y0)")
.source(
    "Merritt, 1967, Hydraulic Control Systems; Jelali and Kroll, 2003, Hydraulic \
     Servo-systems",
)
.parameters(&[
    Parameter::new("kappa", "largest load pressure over supply pressure", Dimension::One)
        .between(-0.95, 0.95)
        .typical(0.3),
    Parameter::new("y0", "angle at which gravity acts in full", Dimension::Output),
    Parameter::new("creep", "speed at which the weight lowers it", Dimension::OutputPerSecond)
        .plausible(-MOST_CREEP, MOST_CREEP),
])
.confused_with(&["leakage", "direction_gain", "position_gain", "input_offset"])
.looking_like_both(&[["direction_gain", "input_offset"]])
.equations(Equations::new(&["gravity = cos((position - y0) * radians)
             load = kappa * gravity * sign(signal)
             out = signal * sqrt(1 - load) - creep * gravity"]));

/// The load pressure over the supply pressure below which there is no load to speak of. Chosen: it changes
/// the speed by half a percent.
const LEAST_LOAD: f64 = 0.01;

/// The largest creep that is plausible, in parts of the largest speed. Chosen: a valve that lets the weight
/// lower the arm half as fast as it drives it does not hold it.
const MOST_CREEP: f64 = 0.5;

impl Effect for GravityLoad {
    fn spec(&self) -> &'static Spec {
        &SPEC
    }

    fn step(&self, parameters: &[f64], _memory: &mut [f64], at: &Moment) -> f64 {
        let &[kappa, y0, creep] = parameters else { return at.signal };
        let gravity = ((at.position - y0) * at.radians_per_output_unit).cos();
        let load = (kappa * gravity).copysign(kappa * gravity * at.signal);
        at.signal * (1.0 - load).sqrt() - creep * gravity
    }

    /// Whether there is a load: without one nothing lowers the joint either, and what looks like a creep
    /// is something else that depends on the angle.
    fn shows_its_form(&self, parameters: &[f64], _record: &RecordRange<'_>) -> bool {
        parameters.first().is_none_or(|kappa| kappa.abs() >= LEAST_LOAD)
    }

    fn bounds(&self, record: &RecordRange<'_>) -> Vec<(f64, f64)> {
        let turn = record.turn().min(UNLIMITED);
        let speed = record.size(Dimension::OutputPerSecond).min(UNLIMITED);
        vec![(-0.95, 0.95), (-turn, turn), (-speed, speed)]
    }

    /// Four quarters of the circle, as two signs times two angles.
    fn guesses(&self, record: &RecordRange<'_>) -> Vec<Vec<f64>> {
        let quarter = record.turn() / 4.0;
        let start = |y0: f64| [0.3, -0.3].map(|kappa| vec![kappa, y0, 0.0]);
        [0.0, quarter].into_iter().flat_map(start).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::super::testing::{assert_close, moment};
    use super::*;

    fn loaded(signal: f64, position: f64, creep: f64) -> f64 {
        let at = Moment { position, ..moment(signal) };
        GravityLoad.step(&[0.36, 30.0, creep], &mut [], &at)
    }

    #[test]
    fn slows_what_lifts_and_speeds_what_lowers() {
        // √(1 − 0.36) = 0.8, and √(1 + 0.36) the other way.
        let faster = 10.0 * 1.36_f64.sqrt();
        let speeds = |angle| [loaded(10.0, angle, 0.0), loaded(-10.0, angle, 0.0)];
        assert_close(&speeds(30.0), &[8.0, -faster]);
        assert_close(&speeds(210.0), &[faster, -8.0]);
        assert_close(&speeds(120.0), &[10.0, -10.0]);
    }

    #[test]
    fn a_creep_without_a_load_is_no_weight() {
        let is_seen =
            |kappa| GravityLoad.shows_its_form(&[kappa, 30.0, 3.8], &RecordRange::default());
        assert!(is_seen(-0.05) && !is_seen(0.0006));
    }

    #[test]
    fn creeps_by_the_cosine_of_the_angle() {
        let speeds = [30.0, 90.0, 120.0, 210.0].map(|angle| loaded(0.0, angle, 2.0));
        assert_close(&speeds, &[-2.0, -1.0, 0.0, 2.0]);
    }
}
