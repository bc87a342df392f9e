//! The numbers of a log as joints: its cells, its times, and the trials of each joint.

mod cells;
mod continuous;
mod joints;
mod repeated;
mod times;
mod unit_change;

pub(super) use cells::Log;
