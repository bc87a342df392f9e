//! The variables of a file, their shape as columns, and why a file is refused.

use std::fmt::Display;

use hdf5_pure::{Error, FormatError};

use crate::experiment::error::ReadError;
use crate::experiment::table::Header;

/// Why a file is refused.
pub(super) fn damaged(reason: impl Display) -> ReadError {
    let remedy = "save it again, with `save -v7` if it is of another version";
    ReadError::format("MATLAB", reason, remedy)
}

impl From<Error> for ReadError {
    fn from(error: Error) -> Self {
        match error {
            // What the source of the bytes says is said here, and needs no words of the library before it.
            Error::Format(FormatError::Source(reason)) => damaged(reason),
            error => damaged(error),
        }
    }
}

/// A variable, or a field of one.
pub(super) struct Variable {
    pub(super) name: String,
    /// Rows, columns, and so on.
    pub(super) dims: Vec<usize>,
    pub(super) content: Content,
}

pub(super) enum Content {
    /// Numbers, column after column.
    Numbers(Vec<f64>),
    /// Numbers that are still in the file.
    Stored(hdf5_pure::Dataset),
    /// One text per row.
    Texts(Vec<String>),
    /// What is none of these.
    Other(String),
}

/// An object of a `class` of MATLAB, whose bytes say nothing without it; and how its numbers are saved so
/// that they can be read.
pub(super) fn object(class: &str) -> Content {
    let remedy = match class {
        "timeseries" => "save its `.Time` and `.Data` as arrays",
        "Simulink.SimulationOutput" | "Simulink.SimulationData.Dataset" => {
            "save the `.Time` and `.Data` of each signal in it as arrays"
        }
        "timetable" | "table" => "save its times, and each of its variables, as arrays",
        "iddata" => "save its `.SamplingInstants`, `.InputData` and `.OutputData` as arrays",
        _ => "save its parts as arrays",
    };
    Content::Other(format!(
        "an object of the class `{class}`, which MATLAB alone can read ({remedy})"
    ))
}

impl Variable {
    /// Rows and columns; nothing where it is a number alone.
    pub(super) fn shape(&self) -> (usize, usize) {
        /// A log has fewer columns; a matrix that lies on its side has more.
        const MOST_COLUMNS: usize = 1000;
        match (&self.content, self.dims.as_slice()) {
            (Content::Texts(texts), _) if texts.len() > 1 => (texts.len(), 1),
            (Content::Texts(_) | Content::Other(_), _) => (0, 1),
            (_, [1, 1] | []) => (0, 0),
            (_, [1, length] | [length, 1] | [length]) => (*length, 1),
            (_, [rows, columns]) if *columns <= MOST_COLUMNS => (*rows, *columns),
            _ => (0, 1),
        }
    }

    /// What it is, where it is no column of numbers or of texts.
    pub(super) fn is_no_column(&self) -> Option<&str> {
        match &self.content {
            Content::Other(kind) => Some(kind),
            Content::Texts(texts) if texts.len() < 2 => Some("text"),
            _ if self.shape().0 == 0 => {
                Some("an array that has no row per sample (turn a matrix of rows on its side)")
            }
            _ => None,
        }
    }

    pub(super) fn header(&self, column: usize, columns: usize) -> Header {
        let name = match columns {
            1 => self.name.clone(),
            _ => format!("{}({})", self.name, column + 1),
        };
        Header::plain(&name, 0)
    }
}
