//! MATLAB 7.3 (`save -v7.3`): HDF5, with a class on every object.

use std::path::Path;

use hdf5_pure::{AttrValue, Dataset, Error, File, Group};

use super::variable::{Content, Numbers, Variable, damaged};
use crate::experiment::error::ReadError;

/// Structures may lie in structures, but not without end.
const DEEPEST: usize = 32;

/// The variables of a file, their numbers still stored.
pub(super) fn variables(path: &Path) -> Result<Vec<Variable>, ReadError> {
    let mut found = Vec::new();
    File::open_streaming(path)
        .and_then(|file| group(&file.root(), "", 0, &mut found))
        .map_err(|error| damaged(path, &error))?;
    Ok(found)
}

/// Adds what lies in a group, which is a structure; by name, so that the order is certain.
fn group(
    group_: &Group,
    prefix: &str,
    depth: usize,
    found: &mut Vec<Variable>,
) -> Result<(), Error> {
    let mut datasets = group_.datasets()?;
    datasets.sort();
    for name in datasets {
        found.push(variable(format!("{prefix}{name}"), group_.dataset(&name)?)?);
    }
    let mut groups = group_.groups()?;
    groups.sort();
    // A name with a number sign is MATLAB's own: what cells refer to.
    groups.retain(|name| !name.starts_with('#'));
    for name in groups.iter().filter(|_| depth < DEEPEST) {
        group(&group_.group(name)?, &format!("{prefix}{name}."), depth + 1, found)?;
    }
    Ok(())
}

fn variable(name: String, dataset: Dataset) -> Result<Variable, Error> {
    let attributes = dataset.attrs()?;
    let class = match attributes.get("MATLAB_class") {
        Some(AttrValue::AsciiString(class) | AttrValue::String(class)) => class.as_str(),
        _ => "",
    };
    // HDF5 counts the longest stride first, MATLAB the shortest.
    let mut dims = Vec::new();
    for length in dataset.shape()?.iter().rev() {
        dims.push(usize::try_from(*length).unwrap_or(usize::MAX));
    }
    let empty = attributes.contains_key("MATLAB_empty");
    let content = match class {
        "char" => Content::Other("text"),
        "cell" => Content::Other("a cell array, which is read of files saved with `save -v7` only"),
        "struct" => Content::Other(
            "an array of structures, which is read of files saved with `save -v7` only",
        ),
        "double" | "single" | "logical" | "int8" | "int16" | "int32" | "int64" | "uint8"
        | "uint16" | "uint32" | "uint64" | ""
            if !empty =>
        {
            Content::Numbers(Numbers::Stored(dataset))
        }
        _ => Content::Other("an object of MATLAB, or nothing"),
    };
    Ok(Variable { name, dims, content })
}
