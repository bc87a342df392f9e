//! All effects of a joint, as a plant file holds them.

use serde::{Deserialize, Serialize};

use super::super::clock::Clock;
use super::super::error::{Place, PlantError};
use super::names::{CATALOGUE, FINER, OUTSIDE};
use super::part::{names_in, part};
use super::{
    ActuatorLag, AsymmetricFriction, AsymmetricSaturation, Backlash, CoulombFriction, CreepMemory,
    DeadBand, DirectionGain, Disturbance, EndStop, FlowCurve, GravityLoad, InputNotch, InputOffset,
    InputSaturation, Leakage, OilColumn, PositionGain, RateLimit, Resonance, SensorNonlinearity,
    SpoolLag, StickySpot, Stiction, SupplyDroop, ThermalDrift, VariableDelay,
};

/// The effects of the catalogue: `[joint.effect.<name>]` in a plant file.
///
/// The input passes them in the order of the fields.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Effects {
    /// The delay depends on the step.
    pub variable_delay: Option<VariableDelay>,
    /// The spool lags.
    pub spool_lag: Option<SpoolLag>,
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
    /// The flow has a limit that differs by direction.
    pub asymmetric_saturation: Option<AsymmetricSaturation>,
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
    /// A mass with friction that differs by direction.
    pub asymmetric_friction: Option<AsymmetricFriction>,
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

impl Effects {
    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        *self == Self::default()
    }

    /// Names of those that are there.
    pub fn names(&self) -> Vec<&'static str> {
        names_in(self, &[&CATALOGUE[..], &FINER].concat())
    }

    /// The friction of the mass.
    pub(in super::super) fn friction(&self) -> Option<AsymmetricFriction> {
        self.asymmetric_friction.or_else(|| self.coulomb_friction.map(AsymmetricFriction::from))
    }

    /// Whether there is none but on the delay.
    pub(in super::super) fn only_delay(&self) -> bool {
        Self { variable_delay: None, ..*self }.is_empty()
    }

    pub(in super::super) fn check(&self, place: &Place, clock: &Clock) -> Result<(), PlantError> {
        let parts = [
            part(self.variable_delay.as_ref()),
            part(self.spool_lag.as_ref()),
            part(self.input_offset.as_ref()),
            part(self.stiction.as_ref()),
            part(self.dead_band.as_ref()),
            part(self.flow_curve.as_ref()),
            part(self.direction_gain.as_ref()),
            part(self.input_saturation.as_ref()),
            part(self.asymmetric_saturation.as_ref()),
            part(self.rate_limit.as_ref()),
            part(self.actuator_lag.as_ref()),
            part(self.resonance.as_ref()),
            part(self.oil_column.as_ref()),
            part(self.coulomb_friction.as_ref()),
            part(self.asymmetric_friction.as_ref()),
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

    /// Names of those that change the motion, which that of the sensor does not.
    pub(in super::super) fn hindering(&self) -> Vec<&'static str> {
        Self { sensor_nonlinearity: None, ..*self }.names()
    }

    /// What the sensor shows of `angle`.
    pub(in super::super) fn shown(&self, angle: f64) -> f64 {
        self.sensor_nonlinearity.map_or(angle, |sensor| sensor.shown(angle))
    }

    pub(in super::super) fn check(&self, place: &Place, clock: &Clock) -> Result<(), PlantError> {
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_hidden_has_a_name() {
        let both: Outside = toml::from_str(
            "disturbance = { from_s = 1, to_s = 2, speed = 3 }\n\
             sensor_nonlinearity = { amplitude = 2, period = 30 }",
        )
        .unwrap();
        assert_eq!(both.names(), ["disturbance", "sensor_nonlinearity"]);
        assert_eq!(both.hindering(), ["disturbance"]);
        assert!(Outside::default().names().is_empty() && Effects::default().names().is_empty());
    }
}
