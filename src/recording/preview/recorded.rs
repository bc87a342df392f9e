//! What a preview is made of.

use std::path::Path;

use crate::experiment::{ReadOptions, Source};
use crate::report::DesignedJoint;

/// Everything that a preview holds.
#[derive(Clone, Copy, Debug)]
pub struct PreviewRecording<'a> {
    /// The inputs, in the order of their tabs.
    pub joints: &'a [DesignedJoint],
    /// The logs from which the joints are known.
    pub sources: &'a [Source],
    /// How they were read.
    pub reading: &'a ReadOptions,
    /// The model file, where one was given.
    pub model: Option<&'a Path>,
}
