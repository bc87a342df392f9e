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
mod rig;
mod spec;
mod valve;

#[cfg(test)]
mod physics;

use super::clock::Clock;
use super::drive::Driver;
use super::error::PlantError;
use super::spec::JointSpec;
use super::together::Driven;

use machine::Machine;
use rig::Rig;

pub use spec::{CylinderSpec, Part};

/// Pascal in a bar.
const PASCAL_PER_BAR: f64 = 1e5;

/// Cubic metres in a litre.
const LITRE: f64 = 1e-3;

/// Cubic metres per second in a litre per minute.
const LITRE_PER_MINUTE: f64 = LITRE / 60.0;

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
) -> Result<Driven, PlantError> {
    let mut driver = Driver::new(joint, index, seed, clock);
    let mut rig = Rig::new(joint, cylinder, clock);
    let mut angles = Vec::new();
    for sample in 1..=clock.samples() {
        rig.run(clock.time_s(sample), driver.drive())?;
        angles.push(joint.outside.shown(rig.angle()));
        if driver.due() == Some(sample) {
            driver.act(sample, &rig)?;
        }
    }
    let speed_changes = rig.speed_changes(driver.drive());
    Ok(Driven { drive: driver.into_drive(), speed_changes, angles })
}
