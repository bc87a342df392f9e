//! What goes into a file or to a viewer, whatever it is about.

use rerun::ApplicationId;
use rerun::log::{Chunk, LogMsg};

use super::blueprint::Ladder;
use super::error::RecordError;
use crate::experiment::{Joint, Source};

/// Who takes the chunks as they are made.
pub(super) type Take<'t> = &'t mut dyn FnMut(&Chunk) -> Result<(), RecordError>;

/// A recording of some kind.
pub(super) trait Content {
    /// Its name in the viewer.
    fn name(&self) -> String;

    /// The same for the same content: see [`hashed`].
    fn id(&self) -> String;

    /// Namespaces that its chunks need, beside the first one.
    fn namespaces(&self) -> u64;

    /// Makes the chunks joint by joint, so that only one joint's are in memory.
    fn for_each_chunk(&self, part: Part<'_>, take: Take<'_>) -> Result<(), RecordError>;

    /// The messages of its blueprint.
    fn views(
        &self,
        ladder: Ladder,
        application: &ApplicationId,
        id: &str,
    ) -> Result<Vec<LogMsg>, RecordError>;

    /// What decides which views there are.
    fn views_in_words(&self, ladder: Ladder) -> String;
}

/// Which of a recording's chunks are made, and which ids they have.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Part<'n> {
    /// Namespaces that are taken, beside the first one.
    pub(super) used: u64,
    /// All joints and what is about them all, or one joint.
    pub(super) joint: Option<&'n str>,
}

impl Part<'_> {
    pub(super) fn has(self, joint: &Joint) -> bool {
        self.joint.is_none_or(|name| joint.name == name)
    }
}

/// The names of the files that were read.
pub(super) fn name_of(sources: &[Source]) -> String {
    let names = sources.iter().filter_map(|source| source.path.file_stem());
    names.map(|name| name.to_string_lossy()).collect::<Vec<_>>().join(", ")
}

/// An id that is the same for the same logs, read in the same way, the same version and
/// what else `settings` hands over.
pub(super) fn hashed<'a>(
    sources: &[Source],
    joints: impl Iterator<Item = &'a Joint>,
    settings: impl FnOnce(&mut dyn FnMut(&str)),
) -> String {
    use sha2::{Digest as _, Sha256};
    let mut hash = Sha256::new();
    let mut part = |text: &str| {
        hash.update(text);
        hash.update([0]);
    };
    for source in sources {
        part(&source.sha256);
    }
    for joint in joints {
        part(&joint.name);
        for trial in &joint.trials {
            let (start, period) = (trial.time_s(1), trial.period());
            part(&format!("{} {} {start} {period}", trial.label(), trial.len()));
        }
    }
    settings(&mut part);
    part(env!("CARGO_PKG_VERSION"));
    let digest = base16ct::lower::encode_string(&hash.finalize());
    digest.chars().take(32).collect()
}
