//! A file of which so much is read for one object, and no more.
//!
//! The crate hdf5-pure 0.47 follows the parts of an object's header that name further parts, to a depth
//! of 32 and without an end to their number: where each names the next one twice, a few kilobytes are
//! billions of parts.

use std::fs;
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

use hdf5_pure::{Error, File, FormatError, ReadSeekSource, Source};

/// Reads for one object of a file of any size.
const FEW_READS: u64 = 20_000;

/// Bytes of a file for each read for one object, at the least: a group has an entry, a name and a
/// header for each object in it, which are some ten reads of half a kilobyte.
const READ_SIZE: u64 = 16;

/// Reads that are still allowed.
#[derive(Clone, Debug)]
pub(super) struct Reads {
    left: Arc<AtomicU64>,
    of_an_object: u64,
}

impl Reads {
    /// The next object is begun.
    pub(super) fn begin(&self) {
        self.left.store(self.of_an_object, Ordering::Relaxed);
    }

    /// All objects are known: their numbers lie where they were said to.
    pub(super) fn end(&self) {
        self.left.store(u64::MAX, Ordering::Relaxed);
    }
}

struct Watched {
    file: ReadSeekSource<fs::File>,
    reads: Reads,
}

impl Source for Watched {
    fn len(&self) -> u64 {
        self.file.len()
    }

    fn read_at(&self, offset: u64, buf: &mut [u8]) -> Result<(), FormatError> {
        let one_less = |left: u64| left.checked_sub(1);
        let taken = self.reads.left.fetch_update(Ordering::Relaxed, Ordering::Relaxed, one_less);
        if taken.is_err() {
            let why = "the header of an object names its own parts without end";
            return Err(FormatError::Source(why.to_owned()));
        }
        self.file.read_at(offset, buf)
    }
}

/// Opens a file, whose reads are counted.
pub(super) fn open(path: &Path) -> Result<(File, Reads), Error> {
    let file = ReadSeekSource::new(fs::File::open(path).map_err(Error::Io)?)?;
    let of_an_object = FEW_READS + file.len() / READ_SIZE;
    let reads = Reads { left: Arc::new(AtomicU64::new(of_an_object)), of_an_object };
    Ok((File::from_source(Watched { file, reads: reads.clone() })?, reads))
}
