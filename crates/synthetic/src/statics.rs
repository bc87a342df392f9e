//! From a held input level to a steady speed.

use super::effects::{At, Instance, Stage, States};
use super::spec::JointSpec;

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
pub(super) struct Valve {
    effects: Vec<Instance>,
    at: At,
    dead_band: [f64; 2],
    limit: f64,
    gain: f64,
    offset: f64,
    /// Levels that are needed to start, and to go on.
    stiction: Option<(f64, f64)>,
    /// What the largest level opens.
    full: f64,
}

impl Valve {
    /// The valve of one joint. What it does not have has no effect.
    pub(super) fn of(joint: &JointSpec) -> Self {
        let numbers = |name: &str| joint.effect.get(name).map(<[f64]>::to_vec);
        let largest = joint.input.largest();
        let edge = (joint.valve_edge * largest).max(f64::MIN_POSITIVE);
        let effects = joint.effects().filter(|one| one.twin.stage == Stage::Valve);
        let mut valve = Self {
            effects: effects.collect(),
            at: At { edge, speed_edge: joint.gain.abs() * edge, ..At::default() },
            dead_band: joint.dead_band.unwrap_or([0.0; 2]),
            limit: joint.saturation.unwrap_or(f64::INFINITY),
            gain: joint.gain,
            offset: numbers("input_offset").map_or(0.0, |numbers| numbers[0]),
            stiction: numbers("stiction").map(|numbers| (numbers[0], numbers[1])),
            full: 0.0,
        };
        valve.full = valve.opening(largest).abs().max(valve.opening(-largest).abs());
        valve
    }

    /// The widths of its rounded corners.
    pub(super) fn edges(&self) -> At {
        self.at
    }

    /// Steady speed at a held `level`, in output units per second, of a valve that does
    /// not stick and a joint without load.
    pub(super) fn speed(&self, level: f64) -> f64 {
        self.gain * self.opening(level)
    }

    /// Opening at a held `level`, in input units, of a valve that does not stick.
    ///
    /// ```text
    /// clamp(dead_band(effects(level)), -limit, limit)
    /// ```
    pub(super) fn opening(&self, level: f64) -> f64 {
        let effects = self.effects.iter();
        let level = effects.fold(level, |u, effect| {
            effect.act(u, &self.at, &States::default(), &mut States::default())
        });
        let [lower, upper] = self.dead_band;
        let shifted = (level - upper).max(0.0) + (level - lower).min(0.0);
        shifted.clamp(-self.limit, self.limit)
    }

    /// Direction of motion at `level`, 0 at rest, where it was `before`.
    pub(super) fn direction(&self, level: f64, before: f64) -> f64 {
        let u = level + self.offset;
        let Some((start, stop)) = self.stiction else { return u.signum() };
        let needed = if u * before > 0.0 { stop } else { start };
        if u.abs() > needed { u.signum() } else { 0.0 }
    }

    /// How far `opening` is of what the largest level opens.
    pub(super) fn share(&self, opening: f64) -> f64 {
        if self.full > 0.0 { (opening.abs() / self.full).min(1.0) } else { 0.0 }
    }
}
