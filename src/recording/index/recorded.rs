//! What a recording of many joints' files is made of.

use crate::recording::recorded::Recording;

/// A file with some of the joints.
#[derive(Clone, Debug)]
pub(crate) struct Volume {
    /// Its name without folder.
    pub(crate) file: String,
    /// How many joints are in it: those behind the joints of the files before it.
    pub(crate) joints: usize,
}

/// All joints, and the files that they are in.
#[derive(Clone, Copy, Debug)]
pub(crate) struct IndexRecording<'a> {
    /// All of it, as if it were in one file.
    pub(crate) all: &'a Recording<'a>,
    /// The files in the order of the joints.
    pub(crate) volumes: &'a [Volume],
}

impl IndexRecording<'_> {
    /// The name of the file that the joint at `index` is in.
    pub(super) fn file_of(&self, index: usize) -> &str {
        let mut behind = 0;
        let volume = self.volumes.iter().find(|volume| {
            behind += volume.joints;
            index < behind
        });
        volume.map_or("", |volume| &volume.file)
    }
}
