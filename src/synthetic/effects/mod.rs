//! What a plant can hide beyond the integrator: its own formulas, in physical terms.
//!
//! [`Effects`] are those that the catalogue of effects knows, under the same names;
//! [`Outside`] are those that it does not. Nothing here is shared with the effects that
//! are fitted: corners are rounded, and what moves is a differential equation.

mod actuator;
mod groups;
mod load;
mod names;
mod opening;
mod part;
mod play;
mod shapes;
mod timing;
mod valve;

pub(super) use actuator::MEMORIES;
pub use actuator::{
    ActuatorLag, AsymmetricFriction, CoulombFriction, CreepMemory, OilColumn, RateLimit, Resonance,
    SpoolLag,
};
pub use groups::{Effects, Outside};
pub use load::{
    Disturbance, GravityLoad, Leakage, PositionGain, StickySpot, SupplyDroop, ThermalDrift,
};
pub use names::{CATALOGUE, FINER, OUTSIDE, name};
pub(super) use opening::Valve;
pub(super) use part::with_part;
pub use play::{Backlash, EndStop, SensorNonlinearity};
pub(super) use timing::Change;
pub use timing::VariableDelay;
pub use valve::{
    AsymmetricSaturation, DeadBand, DirectionGain, FlowCurve, InputNotch, InputOffset,
    InputSaturation, Stiction,
};
