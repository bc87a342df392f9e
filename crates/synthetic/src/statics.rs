//! From a held input level to a steady speed.

use crate::effects::{At, Instance, Stage};
use crate::spec::JointSpec;

/// Effects of the valve, then dead band, saturation and gain, in this order.
///
/// ```text
///   speed            ________  gain × limit
///     |             /
///     |            /
///     |___________/___________ level
///        lower | upper
/// ```
#[derive(Clone, Debug)]
pub(crate) struct Valve {
    /// Effects of the valve, and the one that sets the direction, as the signal passes them.
    effects: Vec<Instance>,
    at: At,
    dead_band: [f64; 2],
    limit: f64,
    gain: f64,
    /// What the largest level opens.
    full: f64,
}

impl Valve {
    /// The valve of one joint. What it does not have has no effect.
    pub(crate) fn of(joint: &JointSpec) -> Self {
        let largest = joint.input.largest();
        let edge = (joint.valve_edge * largest).max(f64::MIN_POSITIVE);
        let counts =
            |one: &Instance| one.twin.stage == Stage::Valve || one.twin.direction.is_some();
        let mut valve = Self {
            effects: joint.effects().filter(counts).collect(),
            at: At { edge, speed_edge: joint.gain.abs() * edge, ..At::default() },
            dead_band: joint.dead_band.unwrap_or([0.0; 2]),
            limit: joint.saturation.unwrap_or(f64::INFINITY),
            gain: joint.gain,
            full: 0.0,
        };
        valve.full = valve.opening(largest).abs().max(valve.opening(-largest).abs());
        valve
    }

    /// The widths of its rounded corners.
    pub(crate) fn edges(&self) -> At {
        self.at
    }

    /// Steady speed at a held `level`, in output units per second, of a valve that does
    /// not stick and a joint without load.
    pub(crate) fn speed(&self, level: f64) -> f64 {
        self.gain * self.opening(level)
    }

    /// Opening at a held `level`, in input units, of a valve that does not stick.
    ///
    /// ```text
    /// clamp(dead_band(effects(level)), -limit, limit)
    /// ```
    pub(crate) fn opening(&self, level: f64) -> f64 {
        let effects = self.effects.iter().filter(|one| one.twin.stage == Stage::Valve);
        let level = effects.fold(level, |level, one| one.pass(level, &self.at));
        let [lower, upper] = self.dead_band;
        let shifted = (level - upper).max(0.0) + (level - lower).min(0.0);
        shifted.clamp(-self.limit, self.limit)
    }

    /// Direction of motion at `level`, 0 at rest, where it was `before`.
    pub(crate) fn direction(&self, level: f64, before: f64) -> f64 {
        let mut level = level;
        for one in &self.effects {
            if let Some(direction) = one.direction(level, before) {
                return direction;
            }
            level = one.pass(level, &self.at);
        }
        1.0
    }

    /// How far `opening` is of what the largest level opens.
    pub(crate) fn share(&self, opening: f64) -> f64 {
        if self.full > 0.0 { (opening.abs() / self.full).min(1.0) } else { 0.0 }
    }
}
