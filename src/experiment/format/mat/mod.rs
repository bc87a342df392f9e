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

use std::fmt::Display;

pub(super) use columns::open;

use crate::experiment::error::ReadError;

/// Why a file is refused.
fn damaged(reason: impl Display) -> ReadError {
    let remedy = "save it again, with `save -v7` if it is of another version";
    ReadError::format("MATLAB", reason, remedy)
}

impl From<hdf5_pure::Error> for ReadError {
    fn from(error: hdf5_pure::Error) -> Self {
        damaged(error)
    }
}
