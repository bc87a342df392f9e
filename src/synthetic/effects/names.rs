//! The names of the effects that a plant can hide.

use super::super::error::PlantError;

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

/// The name of the effect that `text` names.
///
/// # Errors
/// [`PlantError::Unknown`].
pub fn name(text: &str) -> Result<&'static str, PlantError> {
    let known = || CATALOGUE.into_iter().chain(OUTSIDE).chain(FINER);
    known().find(|name| *name == text).ok_or_else(|| {
        let likeness = |name: &&str| strsim::jaro_winkler(name, text);
        let nearest = known().max_by(|a, b| likeness(a).total_cmp(&likeness(b)));
        PlantError::Unknown {
            name: text.to_owned(),
            nearest: nearest.filter(|name| likeness(name) > ALIKE),
            known: known().collect::<Vec<_>>().join(", "),
        }
    })
}

/// Likeness, from 0 to 1, above which a name is proposed.
const ALIKE: f64 = 0.8;
