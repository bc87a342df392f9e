//! MATLAB: the variables of a `.mat` file as columns.
//!
//! | variable | columns |
//! |---|---|
//! | vector `u` | `u` |
//! | matrix `y` with a row per sample | `y(1)`, `y(2)`, … |
//! | field of a structure | `boom.input`; of an array of them `out.signals(2).values` |
//!
//! What is no column of numbers or of text keeps its name, so that messages can say what it
//! is. Numbers alone (1 × 1) are parameters, and no columns.

mod columns;
mod v5;
mod v73;
mod variable;
mod watched;

use std::path::Path;

pub(super) use columns::open;

use crate::experiment::error::ReadError;
use crate::experiment::memory::TooLarge;

/// Why a file is refused.
#[derive(Debug)]
enum Fault {
    /// What is wrong with it.
    Damaged(String),
    TooLarge(TooLarge),
}

impl Fault {
    fn refuse(self, path: &Path) -> ReadError {
        match self {
            Self::Damaged(reason) => ReadError::Format {
                path: path.to_owned(),
                format: "MATLAB",
                reason,
                remedy: "save it again, with `save -v7` if it is of another version",
            },
            Self::TooLarge(error) => error.refuse(path),
        }
    }

    /// Says in what part of the file it is.
    fn within(self, place: &str) -> Self {
        match self {
            Self::Damaged(reason) => Self::Damaged(format!("{place}: {reason}")),
            Self::TooLarge(_) => self,
        }
    }
}

impl From<std::io::Error> for Fault {
    fn from(error: std::io::Error) -> Self {
        Self::Damaged(error.to_string())
    }
}

impl From<hdf5_pure::Error> for Fault {
    fn from(error: hdf5_pure::Error) -> Self {
        Self::Damaged(error.to_string())
    }
}

impl From<TooLarge> for Fault {
    fn from(error: TooLarge) -> Self {
        Self::TooLarge(error)
    }
}
