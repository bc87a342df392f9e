//! What a plant can hide beyond the integrator: its own formulas, in physical terms.
//!
//! Each effect is one row, in the file of its stage: its numbers and what they may be, its
//! equation, and how large it is drawn. Nothing here is shared with the effects that are
//! fitted: corners are rounded, and what moves is a differential equation.

mod delay;
mod dynamics;
mod hidden;
mod load;
mod sensor;
mod shapes;
mod table;
mod twin;
mod valve;

pub(super) use delay::{extra_s, longest_s};
pub(super) use dynamics::{LAG, RINGING};
pub use hidden::Hidden;
pub(super) use hidden::{Instance, catalogue, numbers, outside};
pub use table::{CATALOGUE, FINER, OUTSIDE};
pub(super) use table::{find, in_order};
pub(super) use twin::{At, Draw, LARGEST_LEVEL, Stage, States, Twin};
