//! Results as a Rerun recording: the only folder that names `rerun`.
//!
//! What a reader of the file may rely on is in `docs/recording.md`. In short: each
//! joint has its signals, its decisions and a drawing of every segment; four timelines
//! (`decision`, `segment`, `sample`, `time`) move through all of them together. A fifth one,
//! `revision`, runs along a model that grows. In a recording of a sweep `setting` goes through
//! the settings.
//!
//! Inside, from what others are made of to what is made of them:
//! - `paths` says where everything lies, `layout` where samples, trials and decisions lie on
//!   the timelines; `chunk` makes columns of rows with reproducible ids, `panels` drawings of them
//!   on a `canvas`.
//! - `assembly` and `sweep` are two kinds of recording. One part of the content each are `headline`,
//!   `decisions`, `verdict`, `segment_view`, `difference`, `overview`, `delay_state`, `model`,
//!   `residual`, `revision` and `about`, which `assembly` puts together.
//! - `views` says which view shows what: a tree that `blueprint` writes. What lies below the root of
//!   a drawing is in its view.
//! - `content` is what all kinds are to `write`, which brings them into a file or a stream,
//!   and to `live`, which shows them to a viewer while they grow.

mod about;
mod assembly;
mod blueprint;
mod canvas;
mod chunk;
mod content;
mod decisions;
mod delay_state;
mod difference;
mod error;
mod headline;
mod layout;
mod live;
mod markdown;
mod model;
mod overview;
mod palette;
mod panels;
mod paths;
mod residual;
mod revision;
mod segment_view;
mod sweep;
mod verdict;
mod views;
mod write;

pub use crate::report::{Detail, Recording, SweepRecording};
pub use error::RecordError;
pub(crate) use live::Live;
pub use write::log_recording;
pub use write::write_recording;
pub use write::write_sweep;
