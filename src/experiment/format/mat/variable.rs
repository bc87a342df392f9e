//! The variables of a file, and their shape as columns.

use std::path::Path;

use crate::experiment::error::ReadError;
use crate::experiment::table::Header;

/// A variable, or a field of one.
pub(super) struct Variable {
    pub(super) name: String,
    /// Rows, columns, and so on.
    pub(super) dims: Vec<usize>,
    pub(super) content: Content,
}

pub(super) enum Content {
    Numbers(Numbers),
    /// One text per row.
    Texts(Vec<String>),
    /// An object of this class of MATLAB, whose bytes say nothing without it.
    Object(String),
    /// What is none of these.
    Other(&'static str),
}

/// How the numbers in an object of a `class` are saved so that they can be read.
pub(super) fn as_arrays(class: &str) -> &'static str {
    match class {
        "timeseries" => "save its `.Time` and `.Data` as arrays",
        "Simulink.SimulationOutput" | "Simulink.SimulationData.Dataset" => {
            "save the `.Time` and `.Data` of each signal in it as arrays"
        }
        "timetable" | "table" => {
            "save its row times or its column of times, and each of its variables, as arrays"
        }
        "iddata" => "save its `.SamplingInstants`, `.InputData` and `.OutputData` as arrays",
        _ => "save its parts as arrays",
    }
}

/// Numbers, column after column.
pub(super) enum Numbers {
    Read(Vec<f64>),
    Stored(hdf5_pure::Dataset),
}

impl Variable {
    /// Rows and columns; nothing where it is a number alone.
    pub(super) fn shape(&self) -> (usize, usize) {
        /// A log has fewer columns; a matrix that lies on its side has more.
        const MOST_COLUMNS: usize = 1000;
        match (&self.content, self.dims.as_slice()) {
            (Content::Texts(texts), _) => (texts.len(), 1),
            (Content::Object(_) | Content::Other(_), _) => (0, 1),
            (_, [1, 1] | []) => (0, 0),
            (_, [1, length] | [length, 1] | [length]) => (*length, 1),
            (_, [rows, columns]) if *columns <= MOST_COLUMNS => (*rows, *columns),
            _ => (0, 1),
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

pub(super) fn damaged(path: &Path, reason: &impl ToString) -> ReadError {
    ReadError::Format {
        path: path.to_owned(),
        format: "MATLAB",
        reason: reason.to_string(),
        remedy: "save it again, with `save -v7` if it is of another version",
    }
}
