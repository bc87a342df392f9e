//! The recording that stands before many: a table of all joints with the file that each is in,
//! and the most doubtful decisions of all of them. It is small, and there at once.

mod assembly;
mod doubtful;
mod recorded;
mod views;

pub(crate) use recorded::{IndexRecording, Volume};
