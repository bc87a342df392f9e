//! MATLAB 7.3 (`save -v7.3`): HDF5, with a class on every object.
//!
//! The crate hdf5-pure 0.47 follows hard links in circles and takes memory for what a dataset
//! says of its size, so both are checked before it is asked. It follows the parts of an object's header that
//! name further parts, to a depth of 32 and without an end to their number: where each names the next one
//! twice, a few kilobytes are billions of parts. So often is a file read to list its objects, and no more.

use std::fs;
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

use hdf5_pure::{
    AttrValue, Chunk, DType, Dataset, Error, File, FormatError, Group, ReadSeekSource, Source,
};

use super::variable::{Content, Variable, damaged, object};
use crate::experiment::error::ReadError;
use crate::experiment::memory::Budget;
use crate::experiment::names::shown;
use crate::experiment::table::LONGEST_NAME;

/// Structures may lie in structures, but not without end.
const DEEPEST: usize = 32;

/// Numbers that a structure, or the file itself, may hold beside one another: each is looked up among
/// all of them, and no log has so many signals.
const MOST_BESIDE: usize = 3000;

/// Bytes that a byte of a file may stand for: `gzip`, by which MATLAB packs, makes at most 1032
/// of one.
const LARGEST_RATIO: u64 = 1100;

fn fault<T>(text: String) -> Result<T, ReadError> {
    Err(damaged(text))
}

/// A file whose variables are being listed.
struct Listing<'a> {
    /// Bytes of the file.
    size: u64,
    budget: &'a Budget,
    found: Vec<Variable>,
    /// The structure that is being listed; empty for the file itself.
    inside: String,
}

/// The variables of a file, their numbers still stored.
pub(super) fn variables(path: &Path, budget: &Budget) -> Result<Vec<Variable>, ReadError> {
    let (file, reads) = open(path)?;
    let (size, found, inside) = (file.file_size(), Vec::new(), String::new());
    let mut listing = Listing { size, budget, found, inside };
    let listed = listing.group(&file.root(), "", 0);
    listed.map_err(|fault| match listing.inside.trim_end_matches('.') {
        "" => fault,
        inside => fault.within(&format!("structure `{}`", shown(inside))),
    })?;
    // All objects are known: their numbers lie where they were said to.
    reads.store(u64::MAX, Ordering::Relaxed);
    Ok(listing.found)
}

/// The numbers of a column of a matrix that is stored, as it lies in the file of `size` bytes.
pub(super) fn column(dataset: &Dataset, column: usize, size: u64) -> Result<Vec<f64>, ReadError> {
    // Memory is taken for each chunk before it is read.
    let ends = |chunk: &Chunk| chunk.address.checked_add(chunk.storage_size);
    let lies_within = |chunk: &Chunk| ends(chunk).is_some_and(|end| end <= size);
    if dataset.is_chunked() && !dataset.chunks()?.iter().all(lies_within) {
        return fault("a part of its numbers lies outside of the file".to_owned());
    }
    // A vector is one column, whichever way it lies.
    Ok(match *dataset.shape()?.as_slice() {
        [columns, rows] if columns > 1 && rows > 1 => dataset.read_f64_rows(column as u64, 1)?,
        _ => dataset.read_f64()?,
    })
}

fn product(first: u64, others: &[u64]) -> Option<u64> {
    others.iter().try_fold(first, |product, length| product.checked_mul(*length))
}

impl Listing<'_> {
    /// Adds what lies in a group, which is a structure; by name, so that the order is certain.
    fn group(&mut self, group: &Group, prefix: &str, depth: usize) -> Result<(), ReadError> {
        prefix.clone_into(&mut self.inside);
        let mut datasets = group.datasets()?;
        datasets.sort();
        let count = datasets.len();
        if count > MOST_BESIDE {
            return fault(format!(
                "{count} variables are in one group, and at most {MOST_BESIDE} are read"
            ));
        }
        let mut groups: Vec<(String, Group)> = group.iter_groups()?.collect();
        groups.sort_by(|a, b| a.0.cmp(&b.0));
        for name in datasets.iter().chain(groups.iter().map(|(name, _)| name)) {
            if prefix.len() + name.len() > LONGEST_NAME {
                return fault("a name is too long".to_owned());
            }
            self.budget.take_values(1, size_of::<Variable>() + prefix.len() + name.len())?;
        }
        for name in datasets {
            let found = self.variable(format!("{prefix}{name}"), group.dataset(&name)?)?;
            self.found.push(found);
        }
        // A name with a number sign is MATLAB's own: what cells refer to.
        groups.retain(|(name, _)| !name.starts_with('#'));
        for (name, group) in groups.iter().filter(|_| depth < DEEPEST) {
            self.group(group, &format!("{prefix}{name}."), depth + 1)?;
        }
        Ok(())
    }

    fn variable(&self, name: String, dataset: Dataset) -> Result<Variable, ReadError> {
        let shape = dataset.shape()?;
        let chunk = dataset.chunk_shape()?.unwrap_or_default();
        let (element, most) = (dataset.element_size()?, self.size.saturating_mul(LARGEST_RATIO));
        if [&shape, &chunk].iter().any(|of| product(element, of).is_none_or(|size| size > most)) {
            let size = self.size;
            return fault(format!(
                "the size stated for `{name}` is larger than a file of {size} bytes can hold"
            ));
        }
        let attributes = dataset.attrs()?;
        let class = match attributes.get("MATLAB_class") {
            Some(AttrValue::AsciiString(class) | AttrValue::String(class)) => class.as_str(),
            _ => "",
        };
        let class = if attributes.contains_key("MATLAB_empty") { NOTHING } else { class };
        // HDF5 counts the longest stride first, MATLAB the shortest.
        let dims = shape.iter().rev().map(|n| usize::try_from(*n).unwrap_or(usize::MAX));
        Ok(Variable { name, dims: dims.collect(), content: content(class, dataset) })
    }
}

/// Stands for the class of an array without elements.
const NOTHING: &str = "nothing";

fn content(class: &str, dataset: Dataset) -> Content {
    let kind = match (dataset.dtype(), class) {
        (Ok(DType::Compound(_)), _) => "complex numbers",
        (Ok(DType::String | DType::VariableLengthString), _) | (_, "char") => "text",
        (_, "cell") => "a cell array, which is read of files saved with `save -v7` only",
        (_, "struct") => {
            "an array of structures, which is read of files saved with `save -v7` only"
        }
        (_, NOTHING) => NOTHING,
        (
            _,
            "double" | "single" | "logical" | "int8" | "int16" | "int32" | "int64" | "uint8"
            | "uint16" | "uint32" | "uint64" | "",
        ) => return Content::Stored(dataset),
        (_, class) => return object(class),
    };
    Content::Other(kind.to_owned())
}

/// Reads to list the objects of a file of any size.
const FEW_READS: u64 = 20_000;

/// Bytes of a file for each of these reads, at the least: a group has an entry, a name and a header for each
/// object in it, and an object its attributes, each a read or more (chosen: some hundred for an object).
const READ_SIZE: u64 = 4;

/// A file, and how often it may still be read.
struct Watched {
    file: ReadSeekSource<fs::File>,
    left: Arc<AtomicU64>,
}

impl Source for Watched {
    fn len(&self) -> u64 {
        self.file.len()
    }

    fn read_at(&self, offset: u64, buf: &mut [u8]) -> Result<(), FormatError> {
        let one_less = |left: u64| left.checked_sub(1);
        if self.left.fetch_update(Ordering::Relaxed, Ordering::Relaxed, one_less).is_err() {
            let why = "its structures contain one another in a circle, or the header of an object \
                       refers to its own parts without end";
            return Err(FormatError::Source(why.to_owned()));
        }
        self.file.read_at(offset, buf)
    }
}

/// Opens a file, whose reads are counted.
fn open(path: &Path) -> Result<(File, Arc<AtomicU64>), Error> {
    let file = ReadSeekSource::new(fs::File::open(path).map_err(Error::Io)?)?;
    let left = Arc::new(AtomicU64::new(FEW_READS + file.len() / READ_SIZE));
    Ok((File::from_source(Watched { file, left: Arc::clone(&left) })?, left))
}
