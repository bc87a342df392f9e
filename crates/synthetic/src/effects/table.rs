//! All effects that a plant can hide, and their names.

use super::super::error::PlantError;
use super::twin::Twin;
use super::{delay, dynamics, load, sensor, valve};

/// In the order in which the signal passes them.
static TWINS: [&Twin; 27] = [
    &delay::VARIABLE_DELAY,
    &dynamics::SPOOL_LAG,
    &valve::INPUT_OFFSET,
    &dynamics::STICTION,
    &valve::DEAD_BAND,
    &valve::FLOW_CURVE,
    &valve::DIRECTION_GAIN,
    &valve::INPUT_NOTCH,
    &valve::INPUT_SATURATION,
    &valve::ASYMMETRIC_SATURATION,
    &dynamics::RATE_LIMIT,
    &dynamics::ACTUATOR_LAG,
    &dynamics::RESONANCE,
    &dynamics::OIL_COLUMN,
    &dynamics::COULOMB_FRICTION,
    &dynamics::ASYMMETRIC_FRICTION,
    &dynamics::CREEP_MEMORY,
    &load::POSITION_GAIN,
    &load::STICKY_SPOT,
    &load::THERMAL_DRIFT,
    &load::SUPPLY_DROOP,
    &load::GRAVITY_LOAD,
    &load::LEAKAGE,
    &load::DISTURBANCE,
    &load::END_STOP,
    &sensor::BACKLASH,
    &sensor::SENSOR_NONLINEARITY,
];

/// Names of the effects of the catalogue, but for [`FINER`].
pub const CATALOGUE: [&str; 18] = [
    "input_offset",
    "dead_band",
    "stiction",
    "input_saturation",
    "flow_curve",
    "direction_gain",
    "rate_limit",
    "variable_delay",
    "actuator_lag",
    "resonance",
    "coulomb_friction",
    "gravity_load",
    "position_gain",
    "thermal_drift",
    "supply_droop",
    "leakage",
    "end_stop",
    "backlash",
];

/// Names of its effects that are finer forms of others.
pub const FINER: [&str; 4] =
    ["oil_column", "asymmetric_friction", "asymmetric_saturation", "spool_lag"];

/// Names of the effects outside it.
pub const OUTSIDE: [&str; 5] =
    ["input_notch", "creep_memory", "sticky_spot", "disturbance", "sensor_nonlinearity"];

/// All effects, in the order in which the signal passes them.
pub(crate) fn in_order() -> impl Iterator<Item = &'static Twin> {
    TWINS.iter().copied()
}

/// The effect that `text` names.
///
/// # Errors
/// [`PlantError::Unknown`].
pub(crate) fn find(text: &str) -> Result<&'static Twin, PlantError> {
    /// Likeness, from 0 to 1, above which a name is proposed.
    const ALIKE: f64 = 0.8;
    let known = || CATALOGUE.into_iter().chain(OUTSIDE).chain(FINER);
    in_order().find(|twin| twin.name == text).ok_or_else(|| {
        let likeness = |name: &&str| strsim::jaro_winkler(name, text);
        let nearest = known().max_by(|a, b| likeness(a).total_cmp(&likeness(b)));
        PlantError::Unknown {
            name: text.to_owned(),
            nearest: nearest.filter(|name| likeness(name) > ALIKE),
            known: known().collect::<Vec<_>>().join(", "),
        }
    })
}
