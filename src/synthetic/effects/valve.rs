//! Effects on a held level of the input.
//!
//! Corners are rounded over an `edge`, a small part of the largest level.

use serde::{Deserialize, Serialize};

use super::super::clock::Clock;
use super::super::error::{Allowed, Place, PlantError};
use super::super::spec::JointSpec;
use super::{Part, ramp, rise, window};

/// Width of the corners, as a part of the largest level of the input.
const EDGE: f64 = 0.004;

/// Sharpness of a saturation with a hard corner: within 2 % of the limit.
const HARD: f64 = 40.0;

/// The valve is open a little at zero input.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct InputOffset {
    /// Opening at zero input, in input units.
    pub offset: f64,
}

/// The joint starts above one level and stops below a lower one.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Stiction {
    /// Level that is needed to start, in input units.
    pub start: f64,
    /// Level below which it stops, in input units.
    pub stop: f64,
}

/// No flow between two levels.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct DeadBand {
    /// Lower end, zero or below, in input units.
    pub lower: f64,
    /// Upper end, zero or above, in input units.
    pub upper: f64,
}

/// A flow that grows with a power of the opening.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FlowCurve {
    /// The power; 1 is a straight line.
    pub exponent: f64,
}

/// The joint is faster or slower where the input is negative.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct DirectionGain {
    /// Speed for a negative input over that for a positive one.
    pub negative_factor: f64,
}

/// The flow ends at a limit.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct InputSaturation {
    /// The limit, in input units.
    pub limit: f64,
    /// How sharp the knee is, 2 or more: at the limit `2^(-1/sharpness)` of it is
    /// passed. 40 where a file leaves it out.
    #[serde(default = "hard")]
    pub sharpness: f64,
}

fn hard() -> f64 {
    HARD
}

/// Not in the catalogue: a worn land passes less in a range of the input.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct InputNotch {
    /// Lower end of the range, in input units.
    pub from: f64,
    /// Upper end of the range, in input units.
    pub to: f64,
    /// Part that is passed in the range.
    pub share: f64,
}

/// The valve of a joint: from the delayed level to its opening, in input units.
///
/// With `e` the edge and `ramp` a rounded `max(x, 0)`, one after the other:
///
/// ```text
/// offset      u + offset
/// dead band   ramp(u - upper) - ramp(lower - u)
/// flow curve  u ((u² + e²) / (1 + e²))^((exponent - 1) / 2)
/// direction   u (1 + (negative_factor - 1) rise(-u))
/// notch       u (1 - (1 - share) window(u))
/// saturation  u (1 + abs(u / limit)^p)^(-1/p),   p: sharpness
/// ```
#[derive(Clone, Copy, Debug)]
pub(in super::super) struct Valve<'a> {
    joint: &'a JointSpec,
    edge: f64,
}

impl<'a> Valve<'a> {
    pub(in super::super) fn of(joint: &'a JointSpec) -> Self {
        Self { joint, edge: EDGE * joint.input.largest().max(f64::MIN_POSITIVE) }
    }

    /// Width of the rounded corners, in input units.
    pub(in super::super) fn edge(&self) -> f64 {
        self.edge
    }

    /// Opening at a held `level` of a valve that does not stick.
    pub(in super::super) fn opening(&self, level: f64) -> f64 {
        let (effect, edge) = (&self.joint.effect, self.edge);
        let mut u = level + effect.input_offset.map_or(0.0, |part| part.offset);
        u = effect.dead_band.map_or(u, |part| part.opening(u, edge));
        u = effect.flow_curve.map_or(u, |part| part.opening(u, edge));
        u = effect.direction_gain.map_or(u, |part| part.opening(u, edge));
        u = self.joint.outside.input_notch.map_or(u, |part| part.opening(u, edge));
        effect.input_saturation.map_or(u, |part| part.opening(u))
    }

    /// Direction of motion at `level`, 0 at rest, where it was `before`.
    pub(in super::super) fn direction(&self, level: f64, before: f64) -> f64 {
        let u = level + self.joint.effect.input_offset.map_or(0.0, |part| part.offset);
        let Some(Stiction { start, stop }) = self.joint.effect.stiction else {
            return u.signum();
        };
        let needed = if u * before > 0.0 { stop } else { start };
        if u.abs() > needed { u.signum() } else { 0.0 }
    }
}

impl DeadBand {
    fn opening(self, u: f64, edge: f64) -> f64 {
        ramp(u - self.upper, edge) - ramp(self.lower - u, edge)
    }
}

impl FlowCurve {
    fn opening(self, u: f64, edge: f64) -> f64 {
        let square = edge * edge;
        u * ((u * u + square) / (1.0 + square)).powf(0.5 * (self.exponent - 1.0))
    }
}

impl DirectionGain {
    fn opening(self, u: f64, edge: f64) -> f64 {
        u * (1.0 + (self.negative_factor - 1.0) * rise(-u, edge))
    }
}

impl InputNotch {
    fn opening(self, u: f64, edge: f64) -> f64 {
        u * (1.0 - (1.0 - self.share) * window(u, self.from, self.to, edge))
    }
}

impl InputSaturation {
    fn opening(self, u: f64) -> f64 {
        let (ratio, power) = (u.abs() / self.limit, self.sharpness);
        if ratio <= 1.0 {
            return u * (1.0 + ratio.powf(power)).powf(-1.0 / power);
        }
        // The same with what could overflow taken out.
        (self.limit * (1.0 + ratio.powf(-power)).powf(-1.0 / power)).copysign(u)
    }
}

impl Part for InputOffset {
    fn check(&self, place: &Place, _clock: &Clock) -> Result<(), PlantError> {
        place.number("effect.input_offset.offset", self.offset, Allowed::Finite)
    }
}

impl Part for Stiction {
    fn check(&self, place: &Place, _clock: &Clock) -> Result<(), PlantError> {
        place.number("effect.stiction.start", self.start, Allowed::NotNegative)?;
        place.number("effect.stiction.stop", self.stop, Allowed::NotNegative)?;
        let allowed = "not above `effect.stiction.start`";
        place.require("effect.stiction.stop", self.stop, allowed, |stop| *stop <= self.start)
    }
}

impl Part for DeadBand {
    fn check(&self, place: &Place, _clock: &Clock) -> Result<(), PlantError> {
        place.number("effect.dead_band.lower", self.lower, Allowed::NotPositive)?;
        place.number("effect.dead_band.upper", self.upper, Allowed::NotNegative)
    }
}

impl Part for FlowCurve {
    fn check(&self, place: &Place, _clock: &Clock) -> Result<(), PlantError> {
        place.number("effect.flow_curve.exponent", self.exponent, Allowed::Positive)
    }
}

impl Part for DirectionGain {
    fn check(&self, place: &Place, _clock: &Clock) -> Result<(), PlantError> {
        let key = "effect.direction_gain.negative_factor";
        place.number(key, self.negative_factor, Allowed::Positive)
    }
}

impl Part for InputSaturation {
    fn check(&self, place: &Place, _clock: &Clock) -> Result<(), PlantError> {
        place.number("effect.input_saturation.limit", self.limit, Allowed::Positive)?;
        let (key, allowed) = ("effect.input_saturation.sharpness", "finite, 2 or more");
        place.require(key, self.sharpness, allowed, |p| p.is_finite() && *p >= 2.0)
    }
}

impl Part for InputNotch {
    fn check(&self, place: &Place, _clock: &Clock) -> Result<(), PlantError> {
        let range = [self.from, self.to];
        place.range(["outside.input_notch.from", "outside.input_notch.to"], range)?;
        place.number("outside.input_notch.share", self.share, Allowed::Share)
    }
}
