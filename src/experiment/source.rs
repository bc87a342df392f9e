//! Where a log was read: its file, with the hash of its bytes.

use std::fs::File;
use std::io::{self, BufReader, Read};
use std::path::{Path, PathBuf};

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
    Hashing::new(BufReader::new(File::open(path)?)).finish(path)
}

/// A file of which `hasher` has seen all `bytes`.
pub(super) fn hashed(path: &Path, hasher: Sha256, bytes: u64) -> Source {
    let sha256 = base16ct::lower::encode_string(&hasher.finalize());
    Source { path: path.to_owned(), sha256, bytes }
}

/// Passes bytes on and hashes them on the way, so that a log is read once.
pub(super) struct Hashing<R> {
    inner: R,
    hasher: Sha256,
    bytes: u64,
}

impl<R: Read> Hashing<R> {
    pub(super) fn new(inner: R) -> Self {
        Self { inner, hasher: Sha256::new(), bytes: 0 }
    }

    /// Reads what is left and gives the hash of all of it.
    pub(super) fn finish(mut self, path: &Path) -> Result<Source, ReadError> {
        io::copy(&mut self, &mut io::sink())?;
        Ok(hashed(path, self.hasher, self.bytes))
    }
}

impl<R: Read> Read for Hashing<R> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let count = self.inner.read(buffer)?;
        self.hasher.update(buffer.get(..count).unwrap_or_default());
        self.bytes += count as u64;
        Ok(count)
    }
}
