//! A joint that a hydraulic cylinder moves: valve, pump, oil, piston, linkage, mass.
//!
//! ```text
//! input → delay → spool → ports → pressures → piston → linkage → angle
//!                    pump ↗          ↑______________________|
//! ```
//!
//! Seven differential equations in SI units, written from physics: nothing here is an
//! equation of the models that are fitted, so that they can be judged by it. The
//! equations, their numbers and sources are in `docs/simulating.md`.

mod check;
mod linkage;
mod load;
mod machine;
mod oil;
mod spec;
mod valve;

pub(super) use machine::{Machine, State};
pub(super) use oil::Pressures;
pub use spec::{CylinderSpec, Part};
