//! A joint that a hydraulic cylinder moves: valve, pump, oil, piston, linkage, mass.
//!
//! ```text
//! input → delay → spool → ports → pressures → piston → linkage → angle
//!                    pump ↗          ↑______________________|
//! ```
//!
//! Seven differential equations in SI units, written from physics: nothing here is an
//! equation of the models that are fitted, so that they can be judged by it. The
//! equations, their numbers and sources are in `docs/cylinder.md`.

mod linkage;
mod load;
mod machine;
mod oil;
mod operator;
mod rig;
mod spec;
mod valve;

#[cfg(test)]
mod physics;

use super::clock::Clock;
use super::drive::Step;
use super::error::PlantError;
use super::random::{Purpose, stream};
use super::spec::JointSpec;

use machine::Machine;
use operator::Operator;

pub use spec::{CylinderSpec, Part};

/// Pascal in a bar.
const PASCAL_PER_BAR: f64 = 1e5;

/// Cubic metres in a litre.
const LITRE: f64 = 1e-3;

/// Cubic metres per second in a litre per minute.
const LITRE_PER_MINUTE: f64 = LITRE / 60.0;

/// What a cylinder was told, and what it did.
#[derive(Debug)]
pub(super) struct Ride {
    /// The steps of the input.
    pub(super) steps: Vec<Step>,
    /// Angle at each sample, in output units.
    pub(super) angles: Vec<f64>,
    /// Change of speed that each step caused, in output units per second; none for one that was overtaken.
    pub(super) speed_changes: Vec<Option<f64>>,
}

/// Drives `joint`, which has the number `index`, by its `cylinder`.
///
/// # Errors
/// [`PlantError::Range`], [`PlantError::ListedDelays`] and [`PlantError::Runaway`].
pub(super) fn ride(
    joint: &JointSpec,
    cylinder: &CylinderSpec,
    index: usize,
    seed: u64,
    clock: Clock,
) -> Result<Ride, PlantError> {
    let mut input = stream(seed, index, Purpose::Input);
    Operator::new(joint, cylinder, index, seed, clock).ride(&mut input)
}
