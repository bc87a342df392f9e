//! The numbers of a log as joints: its cells, its times, and the trials of each joint.

mod cells;
mod joints;
mod missing;
mod times;

pub(super) use self::cells::{Log, Mended};
pub(super) use self::times::repeats;
