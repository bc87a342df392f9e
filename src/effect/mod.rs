//! The catalogue of physical effects of hydraulic robot joints.
//!
//! The nominal joint integrates, `y' = gain · u(t − delay)`; an effect is what makes a
//! real one differ. Each is one file with its equation, its source and a unit struct
//! that implements [`Effect`]; [`REGISTRY`] holds them all. Whoever lists, ranks or
//! tests effects goes through the registry and knows none of them by name.
//!
//! An effect keeps no state of its own. It is a function of its parameters, of the
//! [`Moment`] and of a few numbers of memory that the caller owns, so that one effect
//! can serve many simulations at once. At its neutral parameters it changes nothing:
//! models with and without it nest.
//!
//! Within one simulated interval the delayed input is constant. It runs through the
//! stages in the order of [`Stage`].
//!
//! What is not here: the joint that the effects act on, its simulation and its fit.

pub mod accumulator_droop;
pub mod actuator_lag;
pub mod asymmetric_friction;
pub mod asymmetric_saturation;
pub mod asymmetric_stiction;
pub mod backlash;
mod band;
pub mod contract;
pub mod coulomb_friction;
pub mod creep;
pub mod dead_band;
mod decay;
mod definition;
mod dimension;
pub mod direction_gain;
pub mod end_stop;
mod equations;
pub mod expression;
pub mod flow_curve;
pub mod gravity_load;
pub mod input_offset;
pub mod input_quantization;
pub mod input_saturation;
mod interface;
mod interned;
pub mod leakage;
mod moment;
pub mod oil_column;
mod parameter;
pub mod position_gain;
pub mod position_ripple;
pub mod rate_limit;
mod record;
mod registry;
pub mod resonance;
mod signal_gain;
mod sliding;
mod spec;
pub mod spool_lag;
pub mod spool_rate_limit;
mod stage;
pub mod stiction;
pub mod supply_droop;
mod swing;
#[cfg(test)]
mod testing;
pub mod thermal_drift;
pub mod valve_curve;
pub mod valve_hysteresis;
pub mod variable_delay;
mod within_trials;

pub use accumulator_droop::AccumulatorDroop;
pub use actuator_lag::ActuatorLag;
pub use asymmetric_friction::AsymmetricFriction;
pub use asymmetric_saturation::AsymmetricSaturation;
pub use asymmetric_stiction::AsymmetricStiction;
pub use backlash::Backlash;
pub use coulomb_friction::CoulombFriction;
pub use creep::Creep;
pub use dead_band::DeadBand;
pub use definition::{Definition, OwnParameter, OwnState};
pub use dimension::Dimension;
pub use direction_gain::DirectionGain;
pub use end_stop::EndStop;
pub use equations::Equations;
pub use flow_curve::FlowCurve;
pub use gravity_load::GravityLoad;
pub use input_offset::InputOffset;
pub use input_quantization::InputQuantization;
pub use input_saturation::InputSaturation;
pub use interface::{Effect, WithinTrials};
pub use leakage::Leakage;
pub use moment::{InputChange, Moment};
pub use oil_column::OilColumn;
pub(crate) use parameter::is_unlimited;
pub use parameter::{Parameter, UNLIMITED};
pub use position_gain::PositionGain;
pub use position_ripple::PositionRipple;
pub use rate_limit::RateLimit;
pub use record::{RecordRange, SignalRange};
pub(crate) use registry::find_among;
pub use registry::{REGISTRY, UnknownEffect, by_id, find};
pub use resonance::Resonance;
pub use signal_gain::signal_gain;
pub use spec::{LimitingCase, Pace, Spec, Start};
pub use spool_lag::SpoolLag;
pub use spool_rate_limit::SpoolRateLimit;
pub use stage::Stage;
pub use stiction::Stiction;
pub use supply_droop::SupplyDroop;
pub use thermal_drift::ThermalDrift;
pub use valve_curve::ValveCurve;
pub use valve_hysteresis::ValveHysteresis;
pub use variable_delay::VariableDelay;
pub use within_trials::{OF_CONDITIONS, TrialGain, within_trials};
