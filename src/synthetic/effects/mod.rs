//! What a plant can hide beyond the integrator: its own formulas, in physical terms.
//!
//! [`Effects`] are those that the catalogue of effects knows, under the same names;
//! [`Outside`] are those that it does not. Nothing here is shared with the effects that
//! are fitted: corners are rounded, and what moves is a differential equation.

mod actuator;
mod load;
mod play;
mod timing;
mod valve;

use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};

use super::clock::Clock;
use super::error::{Place, PlantError};

pub(super) use actuator::MEMORIES;
pub use actuator::{ActuatorLag, CoulombFriction, CreepMemory, OilColumn, RateLimit, Resonance};
pub use load::{
    Disturbance, GravityLoad, Leakage, PositionGain, StickySpot, SupplyDroop, ThermalDrift,
};
pub use play::{Backlash, EndStop, SensorNonlinearity};
pub(super) use timing::Change;
pub use timing::VariableDelay;
pub(super) use valve::Valve;
pub use valve::{
    DeadBand, DirectionGain, FlowCurve, InputNotch, InputOffset, InputSaturation, Stiction,
};

/// The effects of the catalogue: `[joint.effect.<name>]` in a plant file.
///
/// The input passes them in the order of the fields.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Effects {
    /// The delay depends on the step.
    pub variable_delay: Option<VariableDelay>,
    /// The valve is not centred.
    pub input_offset: Option<InputOffset>,
    /// It starts above one level and stops below a lower one.
    pub stiction: Option<Stiction>,
    /// The lands of the valve overlap.
    pub dead_band: Option<DeadBand>,
    /// The flow is no straight line.
    pub flow_curve: Option<FlowCurve>,
    /// One direction is faster.
    pub direction_gain: Option<DirectionGain>,
    /// The flow has a limit.
    pub input_saturation: Option<InputSaturation>,
    /// The spool has a largest speed.
    pub rate_limit: Option<RateLimit>,
    /// The speed lags.
    pub actuator_lag: Option<ActuatorLag>,
    /// The oil is a spring.
    pub resonance: Option<Resonance>,
    /// A spring that follows the angle, and that the valve damps.
    pub oil_column: Option<OilColumn>,
    /// A mass with friction.
    pub coulomb_friction: Option<CoulombFriction>,
    /// A linkage between cylinder and joint.
    pub position_gain: Option<PositionGain>,
    /// The oil warms.
    pub thermal_drift: Option<ThermalDrift>,
    /// The pump is shared.
    pub supply_droop: Option<SupplyDroop>,
    /// The arm has a weight.
    pub gravity_load: Option<GravityLoad>,
    /// Oil passes the piston.
    pub leakage: Option<Leakage>,
    /// The joint cannot go on.
    pub end_stop: Option<EndStop>,
    /// There is play before the sensor.
    pub backlash: Option<Backlash>,
}

/// Effects that are not in the catalogue: `[joint.outside.<name>]` in a plant file.
///
/// A model that only knows the catalogue can not explain them.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Outside {
    /// The valve passes less in a range of the input.
    pub input_notch: Option<InputNotch>,
    /// The speed creeps on for long after each step.
    pub creep_memory: Option<CreepMemory>,
    /// The joint is slow in a range of angles.
    pub sticky_spot: Option<StickySpot>,
    /// Something pushes for a while.
    pub disturbance: Option<Disturbance>,
    /// The sensor of the angle runs out of true.
    pub sensor_nonlinearity: Option<SensorNonlinearity>,
}

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
pub const FINER: [&str; 1] = ["oil_column"];

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

/// `group` with the effect `name` of these numbers in the place of what it had.
pub(super) fn with_part<T: Serialize + DeserializeOwned>(
    group: &T,
    name: &'static str,
    numbers: &[(String, f64)],
) -> Result<T, PlantError> {
    let mut table = toml::Table::try_from(group).unwrap_or_default();
    let part = numbers.iter().map(|(key, number)| (key.clone(), (*number).into()));
    table.insert(name.to_owned(), toml::Value::Table(part.collect()));
    let group = table.try_into();
    group.map_err(|cause| PlantError::Numbers { name, cause: Box::new(cause) })
}

/// Which of `known` are in `group`.
fn names_in(group: &impl Serialize, known: &[&'static str]) -> Vec<&'static str> {
    let table = toml::Table::try_from(group).unwrap_or_default();
    known.iter().copied().filter(|name| table.contains_key(*name)).collect()
}

/// An effect whose numbers can be checked.
trait Part {
    /// Refuses numbers that mean nothing.
    fn check(&self, place: &Place, clock: &Clock) -> Result<(), PlantError>;
}

fn part<T: Part>(part: Option<&T>) -> Option<&dyn Part> {
    part.map(|part| part as &dyn Part)
}

impl Effects {
    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        *self == Self::default()
    }

    /// Names of those that are there.
    pub fn names(&self) -> Vec<&'static str> {
        names_in(self, &[&CATALOGUE[..], &FINER].concat())
    }

    /// Whether there is none but on the delay.
    pub(super) fn only_delay(&self) -> bool {
        Self { variable_delay: None, ..*self }.is_empty()
    }

    pub(super) fn check(&self, place: &Place, clock: &Clock) -> Result<(), PlantError> {
        let parts = [
            part(self.variable_delay.as_ref()),
            part(self.input_offset.as_ref()),
            part(self.stiction.as_ref()),
            part(self.dead_band.as_ref()),
            part(self.flow_curve.as_ref()),
            part(self.direction_gain.as_ref()),
            part(self.input_saturation.as_ref()),
            part(self.rate_limit.as_ref()),
            part(self.actuator_lag.as_ref()),
            part(self.resonance.as_ref()),
            part(self.oil_column.as_ref()),
            part(self.coulomb_friction.as_ref()),
            part(self.position_gain.as_ref()),
            part(self.thermal_drift.as_ref()),
            part(self.supply_droop.as_ref()),
            part(self.gravity_load.as_ref()),
            part(self.leakage.as_ref()),
            part(self.end_stop.as_ref()),
            part(self.backlash.as_ref()),
        ];
        parts.into_iter().flatten().try_for_each(|part| part.check(place, clock))
    }
}

impl Outside {
    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        *self == Self::default()
    }

    /// Names of those that are there.
    pub fn names(&self) -> Vec<&'static str> {
        names_in(self, &OUTSIDE)
    }

    /// The same without that of the sensor, which does not change the motion.
    pub(super) fn hindering(&self) -> Vec<&'static str> {
        Self { sensor_nonlinearity: None, ..*self }.names()
    }

    /// What the sensor shows of `angle`.
    pub(super) fn shown(&self, angle: f64) -> f64 {
        self.sensor_nonlinearity.map_or(angle, |sensor| sensor.shown(angle))
    }

    pub(super) fn check(&self, place: &Place, clock: &Clock) -> Result<(), PlantError> {
        let parts = [
            part(self.input_notch.as_ref()),
            part(self.creep_memory.as_ref()),
            part(self.sticky_spot.as_ref()),
            part(self.disturbance.as_ref()),
            part(self.sensor_nonlinearity.as_ref()),
        ];
        parts.into_iter().flatten().try_for_each(|part| part.check(place, clock))
    }
}

/// 0 below, 1 above, rounded over some `width` about zero.
fn rise(x: f64, width: f64) -> f64 {
    0.5 * (1.0 + (0.5 * x / width).tanh())
}

/// `max(x, 0)` with a corner that is rounded over some `width`.
fn ramp(x: f64, width: f64) -> f64 {
    x.max(0.0) + width * (-x.abs() / width).exp().ln_1p()
}

/// 1 between `from` and `to`, 0 outside, each end rounded over some `width`.
fn window(x: f64, from: f64, to: f64, width: f64) -> f64 {
    rise(x - from, width) * rise(to - x, width)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_hidden_is_told_by_name() {
        let both: Outside = toml::from_str(
            "disturbance = { from_s = 1, to_s = 2, speed = 3 }\n\
             sensor_nonlinearity = { amplitude = 2, period = 30 }",
        )
        .unwrap();
        assert_eq!(both.names(), ["disturbance", "sensor_nonlinearity"]);
        assert_eq!(both.hindering(), ["disturbance"]);
        assert!(Outside::default().names().is_empty() && Effects::default().names().is_empty());
    }

    #[test]
    fn rounded_shapes_are_sharp_ten_widths_away() {
        for (x, slope, step) in [(-1.0, 0.0, 0.0), (1.0, 1.0, 1.0)] {
            assert!((ramp(x, 0.1) - slope).abs() < 1e-4);
            assert!((rise(x, 0.1) - step).abs() < 1e-4);
        }
        assert!((ramp(0.0, 0.1) - 0.1 * 2_f64.ln()).abs() < 1e-12);
        assert!((window(0.0, -1.0, 1.0, 0.1) - 1.0).abs() < 1e-3);
        assert!(window(2.0, -1.0, 1.0, 0.1) < 1e-4);
    }
}
