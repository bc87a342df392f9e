//! Where a log was read: its file, with the hash of its bytes.

use std::cell::RefCell;
use std::fs::File;
use std::io::{self, BufReader, Read};
use std::path::{Path, PathBuf};
use std::rc::Rc;

use sha2::{Digest as _, Sha256};

use super::error::ReadError;

/// A file that an experiment was read from.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Source {
    /// Where it was read.
    pub path: PathBuf,
    /// SHA-256 of its bytes, as lower-case hexadecimal.
    pub sha256: String,
    /// Its length in bytes.
    pub bytes: u64,
}

/// Reads a file to its end for its hash and its length.
pub(super) fn source_of(path: &Path) -> Result<Source, ReadError> {
    let (mut file, sum) = Hashing::new(BufReader::new(File::open(path)?));
    io::copy(&mut file, &mut io::sink())?;
    Ok(sum.take().source(path))
}

/// The hash of some bytes, and how many there are.
#[derive(Default)]
pub(super) struct Sum {
    hasher: Sha256,
    bytes: u64,
}

impl Sum {
    pub(super) fn add(&mut self, bytes: &[u8]) {
        self.hasher.update(bytes);
        self.bytes += bytes.len() as u64;
    }

    /// The log at `path`, of which these are all bytes.
    pub(super) fn source(self, path: &Path) -> Source {
        let sha256 = base16ct::lower::encode_string(&self.hasher.finalize());
        Source { path: path.to_owned(), sha256, bytes: self.bytes }
    }
}

/// Passes bytes on and hashes them on the way, so that a log is read once.
pub(super) struct Hashing<R> {
    inner: R,
    sum: Rc<RefCell<Sum>>,
}

impl<R: Read> Hashing<R> {
    /// The bytes of `inner`, and the sum of those that have passed.
    pub(super) fn new(inner: R) -> (Self, Rc<RefCell<Sum>>) {
        let sum = Rc::<RefCell<Sum>>::default();
        (Self { inner, sum: Rc::clone(&sum) }, sum)
    }
}

impl<R: Read> Read for Hashing<R> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let count = self.inner.read(buffer)?;
        self.sum.borrow_mut().add(buffer.get(..count).unwrap_or_default());
        Ok(count)
    }
}
