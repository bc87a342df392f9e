//! What is wrong with a file.

use std::path::Path;

use mcap::McapError;

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

/// What to do about a file that is damaged.
const RECOVER: &str = "`mcap recover FILE` saves what is whole";

impl Fault {
    pub(super) fn new(reason: String, remedy: &'static str) -> Self {
        Self::Damaged { reason, remedy }
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

impl From<McapError> for Fault {
    fn from(error: McapError) -> Self {
        let remedy = match error {
            McapError::UnsupportedCompression(_) => {
                "write it with the compression zstd, lz4 or none: `mcap compress FILE`"
            }
            _ => RECOVER,
        };
        Self::new(error.to_string(), remedy)
    }
}
