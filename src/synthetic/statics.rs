//! From a held input level to a steady speed.

use super::effects::Valve;
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
#[derive(Clone, Copy, Debug)]
pub(super) struct StaticChain<'a> {
    valve: Option<Valve<'a>>,
    dead_band: [f64; 2],
    limit: f64,
    gain: f64,
}

impl<'a> StaticChain<'a> {
    /// The chain of one joint. What it does not have has no effect.
    pub(super) fn of(joint: &'a JointSpec) -> Self {
        let valve = (!joint.is_plain()).then(|| joint.valve());
        let dead_band = joint.dead_band.unwrap_or([0.0; 2]);
        let limit = joint.saturation.unwrap_or(f64::INFINITY);
        Self { valve, dead_band, limit, gain: joint.gain }
    }

    /// Steady speed at a held `level`, in output units per second, of a valve that does
    /// not stick and a joint without load.
    pub(super) fn speed(&self, level: f64) -> f64 {
        self.gain * self.opening(level)
    }

    /// Opening of the valve at a held `level`, in input units.
    ///
    /// ```text
    /// clamp(dead_band(valve(level)), -limit, limit)
    /// ```
    pub(super) fn opening(&self, level: f64) -> f64 {
        let level = self.valve.map_or(level, |valve| valve.opening(level));
        let [lower, upper] = self.dead_band;
        let shifted = (level - upper).max(0.0) + (level - lower).min(0.0);
        shifted.clamp(-self.limit, self.limit)
    }
}
