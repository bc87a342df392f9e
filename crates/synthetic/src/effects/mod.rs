//! What a plant can hide beyond the integrator: its own formulas, in physical terms.
//!
//! Each effect is one `Twin` in the file of its stage: its numbers and what they may be, its
//! equation, and how large it is drawn; and one row in `registry.rs`. Nothing here is shared with
//! the effects that are fitted: corners are rounded, and what moves is a differential equation.

mod delay;
mod dynamics;
mod hidden;
mod load;
mod registry;
mod sensor;
mod shapes;
mod twin;
mod valve;

pub(crate) use dynamics::{LAG, RINGING};
pub use hidden::Hidden;
pub(crate) use hidden::{Instance, catalogue, numbers, outside};
pub use registry::{CATALOGUE, FINER, OUTSIDE};
pub(crate) use registry::{families, find};
pub(crate) use twin::{At, Draw, LARGEST_LEVEL, Stage, States, Twin};

#[cfg(test)]
pub(crate) use registry::REGISTRY;
