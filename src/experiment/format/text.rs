//! Bytes of a file as UTF-8 text: unpacked, decoded, and with its hash at the end.

use std::fs::File;
use std::io::{self, Chain, Cursor, Read};
use std::path::{Path, PathBuf};

use encoding_rs::{Encoding, UTF_16BE, UTF_16LE, WINDOWS_1252};
use encoding_rs_io::DecodeReaderBytesBuilder;
use flate2::read::MultiGzDecoder;

use super::blanks::Tabbed;
use super::first_bytes::is_gzip;
use crate::experiment::error::ReadError;
use crate::experiment::source::{Hashing, Source, source_of};

/// Bytes that are looked at to find out how a text is written.
pub(super) const SNIFFED_BYTES: usize = 64 * 1024;

/// A file whose first bytes were looked at.
type Plain = Hashing<Chain<Cursor<Vec<u8>>, File>>;

/// The bytes of a text, and where they come from.
pub(super) enum Bytes {
    /// As they stand in the file.
    Plain(Plain),
    /// Unpacked or decoded from those of the file.
    Made(Box<dyn Read>, PathBuf),
}

impl Bytes {
    /// Opens the file, and its first bytes as text.
    pub(super) fn open(path: &Path) -> Result<(Self, Vec<u8>), ReadError> {
        let io_error = |source| ReadError::Io { path: path.to_owned(), source };
        let mut file = File::open(path).map_err(io_error)?;
        let start = start_of(&mut file).map_err(io_error)?;
        let whole = Cursor::new(start.clone()).chain(file);
        if !is_gzip(&start) {
            return match encoding_of(&start) {
                None if has_old_line_ends(&start) => Ok(Self::with_line_feeds(path, whole, start)),
                None => Ok((Self::Plain(Hashing::new(whole)), start)),
                Some(encoding) => Self::decoded(path, whole, encoding),
            };
        }
        let mut unpacked = MultiGzDecoder::new(whole);
        let start = start_of(&mut unpacked).map_err(|error| damaged(path, &error))?;
        if encoding_of(&start).is_none() && start.contains(&0) {
            return Err(ReadError::Format {
                path: path.to_owned(),
                format: "CSV packed by gzip",
                reason: "what is packed is no text".to_owned(),
                remedy: "unpack it with `gunzip`",
            });
        }
        let whole = Cursor::new(start.clone()).chain(unpacked);
        match encoding_of(&start) {
            None => Ok(Self::unpacked(path, whole, start)),
            Some(encoding) => Self::decoded(path, whole, encoding),
        }
    }

    /// Text that was made of the file at `path`, and its first bytes.
    fn unpacked(path: &Path, whole: impl Read + 'static, start: Vec<u8>) -> (Self, Vec<u8>) {
        if has_old_line_ends(&start) {
            return Self::with_line_feeds(path, whole, start);
        }
        (Self::Made(Box::new(whole), path.to_owned()), start)
    }

    /// A text whose lines end with a carriage return alone.
    fn with_line_feeds(path: &Path, whole: impl Read + 'static, start: Vec<u8>) -> (Self, Vec<u8>) {
        let mut start = start;
        with_feeds(&mut start);
        (Self::Made(Box::new(LineFeeds(whole)), path.to_owned()), start)
    }

    /// What is still unread, with a tab for each run of blanks.
    pub(super) fn tabbed(self, path: &Path) -> Self {
        Self::Made(Box::new(Tabbed::new(self)), path.to_owned())
    }

    /// A text that was made of a file of another kind.
    #[cfg(feature = "xlsx")]
    pub(super) fn made(text: Vec<u8>, path: &Path) -> (Self, Vec<u8>) {
        let start = text.get(..SNIFFED_BYTES).unwrap_or(&text).to_vec();
        (Self::Made(Box::new(Cursor::new(text)), path.to_owned()), start)
    }

    /// Decoded piece by piece: bytes that never end are never held.
    fn decoded(
        path: &Path,
        whole: impl Read + 'static,
        encoding: &'static Encoding,
    ) -> Result<(Self, Vec<u8>), ReadError> {
        let io_error = |source| ReadError::Io { path: path.to_owned(), source };
        let mut builder = DecodeReaderBytesBuilder::new();
        let mut text = builder.encoding(Some(encoding)).bom_override(true).build(whole);
        let start = start_of(&mut text).map_err(io_error)?;
        let whole = Cursor::new(start.clone()).chain(text);
        Ok(Self::unpacked(path, whole, start))
    }

    /// The file that was read, all of it.
    pub(super) fn finish(self, path: &Path) -> Result<Source, ReadError> {
        match self {
            Self::Plain(bytes) => bytes.finish(path),
            Self::Made(_, path) => source_of(&path),
        }
    }
}

impl Read for Bytes {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        match self {
            Self::Plain(bytes) => bytes.read(buffer),
            Self::Made(bytes, _) => bytes.read(buffer),
        }
    }
}

/// Bytes with a line feed for each carriage return.
struct LineFeeds<R>(R);

impl<R: Read> Read for LineFeeds<R> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let count = self.0.read(buffer)?;
        with_feeds(buffer.get_mut(..count).unwrap_or_default());
        Ok(count)
    }
}

fn with_feeds(bytes: &mut [u8]) {
    for byte in bytes.iter_mut().filter(|byte| **byte == b'\r') {
        *byte = b'\n';
    }
}

/// Whether the lines of a text that starts so end with a carriage return alone, as those of old
/// computers do: a comment would go on to the end of the file.
fn has_old_line_ends(start: &[u8]) -> bool {
    // The last byte may be the first half of a line end.
    let before = start.split_last().map_or(start, |(_, before)| before);
    before.contains(&b'\r') && !start.contains(&b'\n')
}

fn start_of(bytes: &mut impl Read) -> io::Result<Vec<u8>> {
    let mut start = Vec::new();
    bytes.by_ref().take(SNIFFED_BYTES as u64).read_to_end(&mut start)?;
    Ok(start)
}

fn damaged(path: &Path, error: &io::Error) -> ReadError {
    ReadError::Format {
        path: path.to_owned(),
        format: "CSV packed by gzip",
        reason: error.to_string(),
        remedy: "pack it again, or rename it if it is of another format",
    }
}

/// A text as tables are read, whatever program wrote it; none of bytes that are no text.
pub(in crate::experiment) fn text_of(bytes: Vec<u8>) -> Option<String> {
    match encoding_of(&bytes) {
        Some(encoding) => Some(encoding.decode(&bytes).0.into_owned()),
        None => String::from_utf8(bytes).ok(),
    }
}

/// How a text that starts so is written, where it is not UTF-8.
fn encoding_of(start: &[u8]) -> Option<&'static Encoding> {
    if let Some((encoding, _)) = Encoding::for_bom(start) {
        return Some(encoding).filter(|encoding| [UTF_16LE, UTF_16BE].contains(encoding));
    }
    // In UTF-16 without a mark every other byte of a table of numbers is 0.
    let zeros = |first: usize| {
        let bytes = start.iter().skip(first).step_by(2).take(100);
        start.len() > 3 && bytes.filter(|byte| **byte == 0).count() * 2 > start.len().min(200) / 2
    };
    match (zeros(0), zeros(1)) {
        (true, false) => return Some(UTF_16BE),
        (false, true) => return Some(UTF_16LE),
        _ => {}
    }
    let text = std::str::from_utf8(start);
    // A letter may be cut off at the end.
    let is_cut = |error: &std::str::Utf8Error| error.error_len().is_none();
    let is_single_bytes = text.is_err_and(|error| !is_cut(&error)) && !start.contains(&0);
    is_single_bytes.then_some(WINDOWS_1252)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn encodings_are_told_by_the_first_bytes() {
        let utf16: Vec<u8> = "t;u;y\n0;1;2\n".encode_utf16().flat_map(u16::to_le_bytes).collect();
        assert_eq!(encoding_of(&utf16), Some(UTF_16LE));
        let swapped: Vec<u8> = utf16.chunks(2).flat_map(|pair| [pair[1], pair[0]]).collect();
        assert_eq!(encoding_of(&swapped), Some(UTF_16BE));
        assert_eq!(encoding_of(&[b"\xff\xfe", utf16.as_slice()].concat()), Some(UTF_16LE));
        assert_eq!(encoding_of(b"t;y [\xb0]\n0;1\n"), Some(WINDOWS_1252));
        assert_eq!(encoding_of("\u{feff}t;y [°]\n0;1\n".as_bytes()), None);
        assert_eq!(encoding_of("t;y [°".as_bytes().split_last().unwrap().1), None);
    }
}
