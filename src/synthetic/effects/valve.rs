//! Effects on a held level of the input.
//!
//! Corners are rounded over an `edge`, a small part of the largest level.

use serde::{Deserialize, Serialize};

use super::super::clock::Clock;
use super::super::error::{Allowed, Place, PlantError};
use super::part::Part;
use super::shapes::{ramp, rise, window};

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

/// The flow ends at another limit in each direction. It takes the place of an
/// [`InputSaturation`].
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct AsymmetricSaturation {
    /// The limit of the positive direction, in input units.
    pub limit: f64,
    /// That of the negative direction over it.
    pub negative_ratio: f64,
    /// As in [`InputSaturation`].
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

impl DeadBand {
    pub(super) fn opening(self, u: f64, edge: f64) -> f64 {
        ramp(u - self.upper, edge) - ramp(self.lower - u, edge)
    }
}

impl FlowCurve {
    pub(super) fn opening(self, u: f64, edge: f64) -> f64 {
        let square = edge * edge;
        u * ((u * u + square) / (1.0 + square)).powf(0.5 * (self.exponent - 1.0))
    }
}

impl DirectionGain {
    pub(super) fn opening(self, u: f64, edge: f64) -> f64 {
        u * (1.0 + (self.negative_factor - 1.0) * rise(-u, edge))
    }
}

impl InputNotch {
    pub(super) fn opening(self, u: f64, edge: f64) -> f64 {
        u * (1.0 - (1.0 - self.share) * window(u, self.from, self.to, edge))
    }
}

impl InputSaturation {
    pub(super) fn opening(self, u: f64) -> f64 {
        let (ratio, power) = (u.abs() / self.limit, self.sharpness);
        if ratio <= 1.0 {
            return u * (1.0 + ratio.powf(power)).powf(-1.0 / power);
        }
        // Multiplied out, so that no power overflows.
        (self.limit * (1.0 + ratio.powf(-power)).powf(-1.0 / power)).copysign(u)
    }
}

impl AsymmetricSaturation {
    pub(super) fn opening(self, u: f64) -> f64 {
        let ratio = if u < 0.0 { self.negative_ratio } else { 1.0 };
        InputSaturation { limit: ratio * self.limit, sharpness: self.sharpness }.opening(u)
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

impl Part for AsymmetricSaturation {
    fn check(&self, place: &Place, _clock: &Clock) -> Result<(), PlantError> {
        place.number("effect.asymmetric_saturation.limit", self.limit, Allowed::Positive)?;
        let key = "effect.asymmetric_saturation.negative_ratio";
        place.number(key, self.negative_ratio, Allowed::Positive)?;
        let (key, allowed) = ("effect.asymmetric_saturation.sharpness", "finite, 2 or more");
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
