//! Effects on the angle and on what the sensor shows of it.

use std::f64::consts::TAU;

use serde::{Deserialize, Serialize};

use super::super::clock::Clock;
use super::super::error::{Allowed, Place, PlantError};
use super::part::Part;

/// Stops that the joint runs into, as stiff springs: it gives by its speed times one
/// time step.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct EndStop {
    /// The lower stop, in output units, if there is one.
    pub low: Option<f64>,
    /// The upper stop, in output units, if there is one.
    pub high: Option<f64>,
}

/// Play between the joint and its sensor: what is measured is dragged along by a stiff
/// spring once the play is used up.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Backlash {
    /// Whole width of the play, in output units.
    pub width: f64,
}

/// Not in the catalogue: an angle sensor that is mounted out of centre.
///
/// ```text
/// shown = y + amplitude sin(2π (y - zero) / period)
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SensorNonlinearity {
    /// Largest error, in output units.
    pub amplitude: f64,
    /// Angle after which it repeats, in output units.
    pub period: f64,
    /// An angle without error, in output units.
    #[serde(default)]
    pub zero: f64,
}

/// How far `x` is beyond `low` or `high`.
fn beyond(x: f64, low: f64, high: f64) -> f64 {
    (x - high).max(0.0) + (x - low).min(0.0)
}

impl EndStop {
    /// Speed at which the stops push the joint back.
    pub(in super::super) fn push(&self, angle: f64, substep_s: f64) -> f64 {
        let low = self.low.unwrap_or(f64::NEG_INFINITY);
        let high = self.high.unwrap_or(f64::INFINITY);
        -beyond(angle, low, high) / substep_s
    }
}

impl Backlash {
    /// Speed of the measured side.
    pub(in super::super) fn rate(self, angle: f64, measured: f64, substep_s: f64) -> f64 {
        beyond(angle - measured, -0.5 * self.width, 0.5 * self.width) / substep_s
    }
}

impl SensorNonlinearity {
    pub(super) fn shown(&self, angle: f64) -> f64 {
        angle + self.amplitude * (TAU * (angle - self.zero) / self.period).sin()
    }
}

impl Part for EndStop {
    fn check(&self, place: &Place, _clock: &Clock) -> Result<(), PlantError> {
        for (key, stop) in [("effect.end_stop.low", self.low), ("effect.end_stop.high", self.high)]
        {
            place.number(key, stop.unwrap_or(0.0), Allowed::Finite)?;
        }
        match (self.low, self.high) {
            (Some(low), Some(high)) => {
                place.range(["effect.end_stop.low", "effect.end_stop.high"], [low, high])
            }
            _ => Ok(()),
        }
    }
}

impl Part for Backlash {
    fn check(&self, place: &Place, _clock: &Clock) -> Result<(), PlantError> {
        place.number("effect.backlash.width", self.width, Allowed::NotNegative)
    }
}

impl Part for SensorNonlinearity {
    fn check(&self, place: &Place, _clock: &Clock) -> Result<(), PlantError> {
        let key = "outside.sensor_nonlinearity.amplitude";
        place.number(key, self.amplitude, Allowed::Finite)?;
        place.number("outside.sensor_nonlinearity.period", self.period, Allowed::Positive)?;
        place.number("outside.sensor_nonlinearity.zero", self.zero, Allowed::Finite)
    }
}
