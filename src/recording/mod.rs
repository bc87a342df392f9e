//! Results as a Rerun recording: the only folder that names `rerun`.
//!
//! What a reader of the file may rely on is told in `docs/recording.md`. In short: each
//! joint has its signals, its decisions and a drawing of every segment; four timelines
//! (`decision`, `segment`, `sample`, `time`) move through all of them together. A fifth one,
//! `revision`, runs along a model that grows. In a recording of a sweep `setting` goes through
//! the settings.
//!
//! Inside, `layout` says where samples, trials and decisions lie on the timelines, `chunk`
//! makes columns of rows with reproducible ids, `signals`, `decisions`, `verdict`,
//! `segment_view`, `beside`, `overview`, `delay_state`, `model`, `revision` and `about` are one part of
//! the content each, `sweep` and `preview` are recordings of other kinds, `content` what all are to
//! `write`, which brings them into a file or a stream, and to `live`, which shows them to a
//! viewer while they grow; `blueprint` says which view shows what.

mod about;
mod beside;
mod blueprint;
mod canvas;
mod chunk;
mod content;
mod correlogram;
mod decisions;
mod delay_state;
mod entity;
mod error;
mod error_share;
mod layout;
mod live;
mod message;
mod model;
mod overview;
mod palette;
mod preview;
mod revision;
mod rows;
mod scatter;
mod segment_view;
mod sheet;
mod signals;
mod sweep;
mod verdict;
mod write;

use crate::delay::Settings;
use crate::experiment::{Joint, ReadOptions, Source};
use crate::report::{ComparedJoint, EstimatedJoint, ImprovedJoint};

pub use beside::Beside;
pub use error::RecordError;
pub use layout::Detail;
pub use live::Live;
pub use preview::PreviewRecording;
pub use sweep::SweepRecording;
pub use write::{log_recording, write_preview, write_recording, write_sweep};

/// Everything that a recording holds.
#[derive(Clone, Copy, Debug)]
pub struct Recording<'a> {
    /// The joints, in the order of their tabs.
    pub joints: &'a [EstimatedJoint<'a>],
    /// The settings of the algorithm.
    pub settings: &'a Settings,
    /// The files that were read.
    pub sources: &'a [Source],
    /// How they were read.
    pub reading: &'a ReadOptions,
    /// How many candidates are recorded.
    pub detail: Detail,
    /// Models beside the measurement; those of a joint that is not recorded are left out.
    pub models: &'a [ComparedJoint<'a>],
    /// What other methods found, drawn beside the first one's decisions.
    pub also: &'a [Beside<'a>],
    /// Models as they grew, on a timeline of their own; at most one per joint.
    pub revisions: &'a [ImprovedJoint<'a>],
}

impl<'a> Recording<'a> {
    /// The revisions of the model of `joint`.
    fn revisions_of(&self, joint: &Joint) -> Option<&'a ImprovedJoint<'a>> {
        let of_joint = |improved: &&ImprovedJoint<'_>| {
            improved.finding.compared.joint.name == joint.name && !improved.revisions.is_empty()
        };
        self.revisions.iter().find(of_joint)
    }
}
