//! MATLAB 7.3 (`save -v7.3`): HDF5, with a class on every object.
//!
//! The crate hdf5-pure 0.47 follows hard links in circles and takes memory for what a dataset
//! says of its size, so both are checked before it is asked; [`open`] bounds what it reads for one object.

use std::path::Path;

use hdf5_pure::{AttrValue, Chunk, DType, Dataset, Error, Group};

use super::variable::{Content, Numbers, Variable, damaged};
use super::watched::{Reads, open};
use crate::experiment::error::ReadError;
use crate::experiment::memory::{Budget, TooLarge};

/// Structures may lie in structures, but not without end.
const DEEPEST: usize = 32;

/// Letters of a name at most; MATLAB allows 63. Names are repeated with each part of a structure.
const LONGEST_NAME: usize = 255;

/// Numbers that a structure, or the file itself, may hold beside one another: each is looked up among
/// all of them, and no log has so many signals.
const MOST_BESIDE: usize = 3000;

/// Bytes of a file for each object in it, at the least: where there are more, links lead in
/// circles.
const OBJECT_SIZE: u64 = 16;

/// Objects that a file of any size may have.
const FEW_OBJECTS: u64 = 256;

/// Bytes that a byte of a file may stand for: `gzip`, by which MATLAB packs, makes at most 1032
/// of one.
const LARGEST_RATIO: u64 = 1100;

/// Why a file is refused.
#[derive(Debug)]
enum Fault {
    /// What is wrong with it.
    Damaged(String),
    TooLarge(TooLarge),
}

impl From<Error> for Fault {
    fn from(error: Error) -> Self {
        Self::Damaged(error.to_string())
    }
}

impl From<TooLarge> for Fault {
    fn from(error: TooLarge) -> Self {
        Self::TooLarge(error)
    }
}

impl Fault {
    fn refuse(self, path: &Path) -> ReadError {
        match self {
            Self::Damaged(reason) => damaged(path, &reason),
            Self::TooLarge(error) => error.refuse(path),
        }
    }
}

/// A file whose variables are being listed.
struct Listing<'a> {
    /// Bytes of the file.
    size: u64,
    budget: &'a Budget,
    /// Objects that may still be looked at.
    objects: u64,
    /// What may still be read for one of them.
    reads: Reads,
    found: Vec<Variable>,
}

/// The variables of a file, their numbers still stored.
pub(super) fn variables(path: &Path, budget: &Budget) -> Result<Vec<Variable>, ReadError> {
    let list = || {
        let (file, reads) = open(path)?;
        let size = file.file_size();
        let objects = size / OBJECT_SIZE + FEW_OBJECTS;
        let mut listing = Listing { size, budget, objects, reads, found: Vec::new() };
        listing.reads.begin();
        listing.group(&file.root(), "", 0)?;
        listing.reads.end();
        Ok(listing.found)
    };
    list().map_err(|fault: Fault| fault.refuse(path))
}

/// The numbers of a column of a matrix that is stored, as it lies in the file.
pub(super) fn column(
    dataset: &Dataset,
    column: usize,
    path: &Path,
    budget: &Budget,
) -> Result<Vec<f64>, ReadError> {
    let io_error = |source| ReadError::Io { path: path.to_owned(), source };
    let size = path.metadata().map_err(io_error)?.len();
    let read = || {
        check_chunks(dataset, size)?;
        let shape = dataset.shape()?;
        let count = shape.iter().try_fold(1_u64, |count, length| count.checked_mul(*length));
        let bytes = count.and_then(|count| count.checked_mul(2 * size_of::<f64>() as u64));
        // A vector is one column, whichever way it lies.
        match *shape.as_slice() {
            [columns, rows] if columns > 1 && rows > 1 => {
                budget.take(bytes.map_or(u64::MAX, |bytes| bytes / columns))?;
                return Ok(dataset.read_f64_rows(column as u64, 1)?);
            }
            _ => {}
        }
        budget.take(bytes.unwrap_or(u64::MAX))?;
        Ok(dataset.read_f64()?)
    };
    read().map_err(|fault: Fault| fault.refuse(path))
}

/// Refuses chunks that lie outside of a file of `size` bytes: memory is taken for each before it
/// is read.
fn check_chunks(dataset: &Dataset, size: u64) -> Result<(), Fault> {
    if !dataset.is_chunked() {
        return Ok(());
    }
    let ends = |chunk: &Chunk| chunk.address.checked_add(chunk.storage_size);
    let lies_within = |chunk: &Chunk| ends(chunk).is_some_and(|end| end <= size);
    if dataset.chunks()?.iter().all(lies_within) {
        return Ok(());
    }
    Err(Fault::Damaged("a part of its numbers lies outside of the file".to_owned()))
}

impl Listing<'_> {
    /// Adds what lies in a group, which is a structure; by name, so that the order is certain.
    fn group(&mut self, group: &Group, prefix: &str, depth: usize) -> Result<(), Fault> {
        let mut datasets = group.datasets()?;
        datasets.sort();
        if datasets.len() > MOST_BESIDE {
            return Err(Fault::Damaged(format!(
                "{} variables lie beside one another, and {MOST_BESIDE} of such a file are read at most",
                datasets.len()
            )));
        }
        let mut groups: Vec<(String, Group)> = group.iter_groups()?.collect();
        groups.sort_by(|a, b| a.0.cmp(&b.0));
        self.count(prefix, datasets.iter().chain(groups.iter().map(|(name, _)| name)))?;
        for name in datasets {
            self.reads.begin();
            let found = self.variable(format!("{prefix}{name}"), group.dataset(&name)?)?;
            self.found.push(found);
        }
        // A name with a number sign is MATLAB's own: what cells refer to.
        groups.retain(|(name, _)| !name.starts_with('#'));
        for (name, group) in groups.iter().filter(|_| depth < DEEPEST) {
            self.reads.begin();
            self.group(group, &format!("{prefix}{name}."), depth + 1)?;
        }
        Ok(())
    }

    /// Counts objects by their names, so that there is an end to them.
    fn count<'n>(
        &mut self,
        prefix: &str,
        names: impl Iterator<Item = &'n String>,
    ) -> Result<(), Fault> {
        for name in names {
            if name.len() > LONGEST_NAME {
                return Err(Fault::Damaged("a name is too long".to_owned()));
            }
            let circle = || Fault::Damaged("its groups lie in one another in a circle".to_owned());
            self.objects = self.objects.checked_sub(1).ok_or_else(circle)?;
            self.budget.take_values(1, size_of::<Variable>() + prefix.len() + name.len())?;
        }
        Ok(())
    }

    fn variable(&self, name: String, dataset: Dataset) -> Result<Variable, Fault> {
        let shape = dataset.shape()?;
        self.check_size(&name, &dataset, &shape)?;
        let attributes = dataset.attrs()?;
        let class = match attributes.get("MATLAB_class") {
            Some(AttrValue::AsciiString(class) | AttrValue::String(class)) => class.as_str(),
            _ => "",
        };
        // HDF5 counts the longest stride first, MATLAB the shortest.
        let mut dims = Vec::new();
        for length in shape.iter().rev() {
            dims.push(usize::try_from(*length).unwrap_or(usize::MAX));
        }
        let class = if attributes.contains_key("MATLAB_empty") { NOTHING } else { class };
        Ok(Variable { name, dims, content: content(class, dataset) })
    }

    /// Refuses a dataset that says it is larger than this file can hold.
    fn check_size(&self, name: &str, dataset: &Dataset, shape: &[u64]) -> Result<(), Fault> {
        let most = self.size.saturating_mul(LARGEST_RATIO);
        let element = dataset.element_size()?;
        let bytes =
            |shape: &[u64]| shape.iter().try_fold(element, |bytes, n| bytes.checked_mul(*n));
        let chunk = dataset.chunk_shape()?.unwrap_or_default();
        for what in [shape, &chunk] {
            if bytes(what).is_none_or(|bytes| bytes > most) {
                return Err(Fault::Damaged(format!(
                    "`{name}` says that it is larger than a file of {} bytes can be",
                    self.size
                )));
            }
        }
        Ok(())
    }
}

/// Stands for the class of an array without elements.
const NOTHING: &str = "nothing";

fn content(class: &str, dataset: Dataset) -> Content {
    match dataset.dtype() {
        Ok(DType::Compound(_)) => return Content::Other("complex numbers"),
        Ok(DType::String | DType::VariableLengthString) => return Content::Other("text"),
        _ => {}
    }
    match class {
        "char" => Content::Other("text"),
        "cell" => Content::Other("a cell array, which is read of files saved with `save -v7` only"),
        "struct" => Content::Other(
            "an array of structures, which is read of files saved with `save -v7` only",
        ),
        "double" | "single" | "logical" | "int8" | "int16" | "int32" | "int64" | "uint8"
        | "uint16" | "uint32" | "uint64" | "" => Content::Numbers(Numbers::Stored(dataset)),
        NOTHING => Content::Other("nothing"),
        class => Content::Object(class.to_owned()),
    }
}
