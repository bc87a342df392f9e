//! Effects on what the sensor shows of the angle.

use std::f64::consts::TAU;

use super::load::beyond;
use super::twin::Stage::Sensor;
use super::twin::{Twin, followed};
use crate::error::{FINITE, NOT_NEGATIVE, POSITIVE};

/// Play between the joint and its sensor, of the whole `width`: what is measured is dragged along
/// by a stiff spring once the play is used up.
pub(super) static BACKLASH: Twin = Twin {
    settle: followed,
    act: |&[width, ..], angle, at, &[measured, ..], rates| {
        rates[0] = beyond(angle - measured, -0.5 * width, 0.5 * width) / at.substep_s;
        measured
    },
    drawn: |draw| vec![15.0 * draw.strength],
    ..Twin::new("backlash", Sensor, &["width"], &[NOT_NEGATIVE])
};

/// Not in the catalogue: an angle sensor that is mounted out of centre.
///
/// ```text
/// shown = y + amplitude sin(2π (y - zero) / period)
/// ```
pub(super) static SENSOR_NONLINEARITY: Twin = Twin {
    optional: &[0.0],
    act: |&[amplitude, period, zero, ..], angle, _, _, _| {
        angle + amplitude * (TAU * (angle - zero) / period).sin()
    },
    drawn: |draw| {
        let (period, zero) = (draw.between(1, 30.0, 60.0), draw.between(0, -45.0, 45.0));
        vec![8.0 * draw.strength, period, zero]
    },
    ..Twin::new(
        "sensor_nonlinearity",
        Sensor,
        &["amplitude", "period", "zero"],
        &[FINITE, POSITIVE, FINITE],
    )
};
