//! Effects on the speed of the joint: where it is, how warm, what pulls at it.

use serde::{Deserialize, Serialize};

use super::super::clock::Clock;
use super::super::error::{Allowed, Place, PlantError};
use super::part::Part;
use super::shapes::window;

/// A cylinder that turns the joint by a lever.
///
/// Pivot, foot of the cylinder and its head make a triangle; `ratio` is the lever's side
/// over the side to the foot. With `φ` the angle between both sides:
///
/// ```text
/// length² = 1 + ratio² - 2 ratio cos φ        (law of cosines)
/// arm     = d length / d φ = ratio sin φ / length
/// speed   = in arm(mount) / arm(φ),           φ = mount + leverage (y - reference)
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PositionGain {
    /// Side of the lever over the side to the foot of the cylinder.
    pub ratio: f64,
    /// `φ` at the angle `reference`, in degrees.
    pub mount: f64,
    /// How far the lever turns for a turn of the joint; 1 without a linkage between.
    pub leverage: f64,
    /// Angle at which the gain is that of the joint, in output units.
    #[serde(default)]
    pub reference: f64,
}

/// The gain goes with the temperature of the oil: `time_constant θ' = 1 - θ`.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ThermalDrift {
    /// Change of the gain once the oil is warm, as a part of the gain.
    pub change: f64,
    /// Time to 63 % of the change, in seconds.
    pub time_constant: f64,
}

/// A pump that is shared: the part of the gain that is lost while all other joints'
/// valves are as far open as they ever are.
///
/// The pressure follows the demand with a time constant of 20 ms.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SupplyDroop {
    /// The part lost.
    pub droop: f64,
}

/// The weight of the arm: less pressure is left for the valve upward, more downward, and
/// the arm creeps down.
///
/// ```text
/// out = in sqrt(1 - tanh(in / e) kappa cos(y - y0)) - creep cos(y - y0)
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct GravityLoad {
    /// Largest load pressure over the supply pressure.
    pub kappa: f64,
    /// Angle at which the arm lies level, in output units.
    #[serde(default)]
    pub y0: f64,
    /// Speed of the creep there, in output units per second.
    #[serde(default)]
    pub creep: f64,
}

/// Oil that passes the piston: the joint drifts toward an angle.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Leakage {
    /// Speed per distance, in 1/s.
    pub rate: f64,
    /// Angle toward which it drifts, in output units.
    #[serde(default)]
    pub y0: f64,
}

/// Not in the catalogue: a bearing that binds in a range of angles.
///
/// Its ends are rounded over a twentieth of it.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct StickySpot {
    /// Lower end, in output units.
    pub from: f64,
    /// Upper end, in output units.
    pub to: f64,
    /// Part of the speed that is left in it.
    pub share: f64,
}

/// Not in the catalogue: something pushes for a while, as a load that the arm carries.
///
/// It comes and goes within some 0.2 s.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Disturbance {
    /// When it begins, in seconds since the first sample.
    pub from_s: f64,
    /// When it ends.
    pub to_s: f64,
    /// Speed that it adds, in output units per second.
    pub speed: f64,
}

/// The lever never comes nearer to a dead point than this, in radians.
const NEAREST_DEAD_POINT: f64 = 0.15;

/// Time constant of the pump's pressure, in seconds.
const PUMP_S: f64 = 0.02;

/// Width of the rise of a disturbance, in seconds.
const DISTURBANCE_EDGE_S: f64 = 0.05;

/// Width of the ends of a sticky spot, as a part of it.
const SPOT_EDGE: f64 = 0.05;

impl PositionGain {
    pub(in super::super) fn factor(&self, angle: f64, radians: f64) -> f64 {
        let mount = self.mount.to_radians();
        let turned = mount + self.leverage * (angle - self.reference) * radians;
        let dead_point = std::f64::consts::PI - NEAREST_DEAD_POINT;
        self.arm(mount) / self.arm(turned.max(NEAREST_DEAD_POINT).min(dead_point))
    }

    fn arm(&self, phi: f64) -> f64 {
        let length = (1.0 + self.ratio * (self.ratio - 2.0 * phi.cos())).sqrt();
        self.ratio * phi.sin() / length
    }
}

impl ThermalDrift {
    pub(in super::super) fn factor(&self, warmth: f64) -> f64 {
        1.0 + self.change * warmth
    }

    pub(in super::super) fn rate(&self, warmth: f64) -> f64 {
        (1.0 - warmth) / self.time_constant
    }
}

impl SupplyDroop {
    pub(in super::super) fn factor(self, demand: f64) -> f64 {
        1.0 - self.droop * demand
    }

    pub(in super::super) fn rate(others: f64, demand: f64, substep_s: f64) -> f64 {
        (others - demand) / PUMP_S.max(2.0 * substep_s)
    }
}

impl GravityLoad {
    /// Speed at `angle` for a commanded one, whose sign is rounded over some `edge`.
    pub(in super::super) fn speed(&self, command: f64, angle: f64, radians: f64, edge: f64) -> f64 {
        let lies = ((angle - self.y0) * radians).cos();
        let left = 1.0 - (command / edge).tanh() * self.kappa * lies;
        command * left.sqrt() - self.creep * lies
    }
}

impl Leakage {
    pub(in super::super) fn drift(&self, angle: f64) -> f64 {
        self.rate * (self.y0 - angle)
    }
}

impl StickySpot {
    pub(in super::super) fn factor(&self, angle: f64) -> f64 {
        let inside = window(angle, self.from, self.to, SPOT_EDGE * (self.to - self.from));
        1.0 - (1.0 - self.share) * inside
    }
}

impl Disturbance {
    pub(in super::super) fn push(&self, time_s: f64) -> f64 {
        self.speed * window(time_s, self.from_s, self.to_s, DISTURBANCE_EDGE_S)
    }
}

impl Part for PositionGain {
    fn check(&self, place: &Place, _clock: &Clock) -> Result<(), PlantError> {
        let (key, allowed) = ("effect.position_gain.ratio", "above 0, below 1");
        place.require(key, self.ratio, allowed, |ratio| *ratio > 0.0 && *ratio < 1.0)?;
        let (key, allowed) = ("effect.position_gain.mount", "10 to 170 degrees");
        place.require(key, self.mount, allowed, |mount| (10.0..=170.0).contains(mount))?;
        place.number("effect.position_gain.leverage", self.leverage, Allowed::Finite)?;
        place.number("effect.position_gain.reference", self.reference, Allowed::Finite)
    }
}

impl Part for ThermalDrift {
    fn check(&self, place: &Place, clock: &Clock) -> Result<(), PlantError> {
        let (key, allowed) = ("effect.thermal_drift.change", "finite, above -1");
        place.require(key, self.change, allowed, |x| x.is_finite() && *x > -1.0)?;
        let (key, allowed) = ("effect.thermal_drift.time_constant", "finite, a sample or more");
        place.require(key, self.time_constant, allowed, |t| {
            t.is_finite() && *t >= clock.period().seconds()
        })
    }
}

impl Part for SupplyDroop {
    fn check(&self, place: &Place, _clock: &Clock) -> Result<(), PlantError> {
        place.number("effect.supply_droop.droop", self.droop, Allowed::BelowOne)
    }
}

impl Part for GravityLoad {
    fn check(&self, place: &Place, _clock: &Clock) -> Result<(), PlantError> {
        let (key, allowed) = ("effect.gravity_load.kappa", "above -1, below 1");
        place.require(key, self.kappa, allowed, |kappa| kappa.abs() < 1.0)?;
        place.number("effect.gravity_load.y0", self.y0, Allowed::Finite)?;
        place.number("effect.gravity_load.creep", self.creep, Allowed::Finite)
    }
}

impl Part for Leakage {
    fn check(&self, place: &Place, clock: &Clock) -> Result<(), PlantError> {
        let (key, allowed) = ("effect.leakage.rate", "0 or more, below one in a sample");
        place.require(key, self.rate, allowed, |rate| {
            *rate >= 0.0 && rate * clock.period().seconds() < 1.0
        })?;
        place.number("effect.leakage.y0", self.y0, Allowed::Finite)
    }
}

impl Part for StickySpot {
    fn check(&self, place: &Place, _clock: &Clock) -> Result<(), PlantError> {
        let range = [self.from, self.to];
        place.range(["outside.sticky_spot.from", "outside.sticky_spot.to"], range)?;
        place.number("outside.sticky_spot.share", self.share, Allowed::Share)
    }
}

impl Part for Disturbance {
    fn check(&self, place: &Place, _clock: &Clock) -> Result<(), PlantError> {
        let range = [self.from_s, self.to_s];
        place.range(["outside.disturbance.from_s", "outside.disturbance.to_s"], range)?;
        place.number("outside.disturbance.speed", self.speed, Allowed::Finite)
    }
}
