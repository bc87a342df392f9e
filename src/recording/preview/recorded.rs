//! What a preview is made of.

use std::path::Path;

use crate::experiment::{ReadOptions, Source};
use crate::report::DesignedJoint;

/// Everything that a preview holds.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PreviewRecording<'a> {
    /// The inputs, in the order of their tabs.
    pub(crate) joints: &'a [DesignedJoint],
    /// The logs from which the joints are known.
    pub(crate) sources: &'a [Source],
    /// How they were read.
    pub(crate) reading: &'a ReadOptions,
    /// The model file, where one was given.
    pub(crate) model: Option<&'a Path>,
}
