//! Results as a Rerun recording: the only folder that names `rerun`.
//!
//! What a reader of the file may rely on is told in `docs/recording.md`. In short: each
//! joint has its signals, its decisions and a drawing of every segment; four timelines
//! (`decision`, `segment`, `sample`, `time`) move through all of them together.
//!
//! Inside, `layout` says where samples, trials and decisions lie on the timelines, `chunk`
//! makes columns of rows with reproducible ids, `signals`, `decisions`, `verdict`,
//! `segment_view`, `overview` and `about` are one part of the content each, `blueprint`
//! says which view shows what, and `write` brings it into a file or a stream.

mod about;
mod blueprint;
mod canvas;
mod chunk;
mod decisions;
mod entity;
mod error;
mod layout;
mod message;
mod overview;
mod palette;
mod segment_view;
mod signals;
mod verdict;
mod write;

use crate::delay::Settings;
use crate::experiment::Source;
use crate::report::EstimatedJoint;

pub use error::RecordError;
pub use layout::Detail;
pub use write::{log_estimate, write_estimate};

/// Everything that a recording of delays holds.
#[derive(Clone, Copy, Debug)]
pub struct EstimateRecording<'a> {
    /// The joints, in the order of their tabs.
    pub joints: &'a [EstimatedJoint<'a>],
    /// The settings of the algorithm.
    pub settings: &'a Settings,
    /// The files that were read.
    pub sources: &'a [Source],
    /// How many candidates are recorded.
    pub detail: Detail,
}
