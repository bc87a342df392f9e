//! The first bytes of a file, by which formats are distinguished.

use std::fs::File;
use std::io::Read as _;
use std::path::Path;

use crate::experiment::error::ReadError;

/// Whether these are the first bytes of MATLAB 5 to 7, or of 7.3, which is HDF5 after a
/// header of 512 bytes or alone.
pub(super) fn is_matlab(start: &[u8]) -> bool {
    start.starts_with(b"MATLAB 5.0 MAT-file") || is_matlab_73(start)
}

pub(super) fn is_matlab_73(start: &[u8]) -> bool {
    const HDF5: &[u8] = b"\x89HDF\r\n\x1a\n";
    start.starts_with(HDF5) || start.get(512..).is_some_and(|rest| rest.starts_with(HDF5))
}

/// Whether these are the first bytes of a file packed by gzip.
pub(super) fn is_gzip(start: &[u8]) -> bool {
    start.starts_with(b"\x1f\x8b")
}

/// The bytes by which formats are distinguished.
pub(super) fn start_of(path: &Path) -> Result<Vec<u8>, ReadError> {
    /// MATLAB 7.3 has a header of 512 bytes before its own mark.
    const LENGTH: u64 = 520;
    let mut start = Vec::new();
    File::open(path)?.take(LENGTH).read_to_end(&mut start)?;
    Ok(start)
}
