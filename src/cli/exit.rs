//! How completely a command was done.

/// What became of a command that ran to its end.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Completion {
    /// Everything was done.
    Whole,
    /// Some joints or files failed; the rest is in the output.
    Partial,
}

impl Completion {
    /// Whole where nothing failed.
    pub(crate) fn without(failures: &[String]) -> Self {
        if failures.is_empty() { Self::Whole } else { Self::Partial }
    }
}
