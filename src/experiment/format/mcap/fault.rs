//! What is wrong with a file.

use std::path::Path;

use crate::experiment::error::ReadError;

/// What is wrong with a file, and what to do about it.
#[derive(Debug)]
pub(super) struct Fault {
    pub(super) reason: String,
    pub(super) remedy: &'static str,
}

impl Fault {
    pub(super) fn refuse(self, path: &Path) -> ReadError {
        let (reason, remedy) = (self.reason, self.remedy);
        ReadError::Format { path: path.to_owned(), format: "MCAP", reason, remedy }
    }
}
