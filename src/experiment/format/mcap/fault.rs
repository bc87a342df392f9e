//! What is wrong with a file.

use std::path::Path;

use crate::experiment::error::ReadError;
use crate::experiment::memory::TooLarge;

/// Why a file is refused.
#[derive(Debug)]
pub(super) enum Fault {
    /// What is wrong with it, and what to do about it.
    Damaged { reason: String, remedy: &'static str },
    /// It takes too much memory.
    TooLarge(TooLarge),
}

impl Fault {
    pub(super) fn new(reason: String, remedy: &'static str) -> Self {
        Self::Damaged { reason, remedy }
    }

    /// This fault, and what may be the reason for it.
    pub(super) fn also(self, more: Option<&str>) -> Self {
        match (self, more) {
            (Self::Damaged { reason, remedy }, Some(more)) => {
                Self::Damaged { reason: format!("{reason}: {more}"), remedy }
            }
            (fault, _) => fault,
        }
    }

    pub(super) fn refuse(self, path: &Path) -> ReadError {
        match self {
            Self::Damaged { reason, remedy } => {
                ReadError::Format { path: path.to_owned(), format: "MCAP", reason, remedy }
            }
            Self::TooLarge(error) => error.refuse(path),
        }
    }
}

impl From<TooLarge> for Fault {
    fn from(error: TooLarge) -> Self {
        Self::TooLarge(error)
    }
}
