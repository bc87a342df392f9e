//! Bytes of a file as UTF-8 text: unpacked, decoded, and with its hash at the end.

use std::cell::RefCell;
use std::fs::File;
use std::io::{self, Cursor, Read};
use std::path::{Path, PathBuf};
use std::rc::Rc;

use encoding_rs::{Encoding, UTF_16BE, UTF_16LE, WINDOWS_1252};
use encoding_rs_io::DecodeReaderBytesBuilder;
use flate2::read::MultiGzDecoder;

use super::first_bytes::is_gzip;
use crate::experiment::error::ReadError;
use crate::experiment::source::{Hashing, Source, Sum};

/// Bytes that are looked at to find out how a text is written.
const SNIFFED_BYTES: usize = 64 * 1024;

const BYTE_ORDER_MARK: &[u8] = b"\xef\xbb\xbf";

/// The bytes of a text, without a byte order mark, and where they come from.
pub(super) struct Bytes {
    text: Box<dyn Read>,
    /// The sum of the bytes of the file, which a pipe gives once; none of a text that was made of a workbook.
    sum: Option<Rc<RefCell<Sum>>>,
    path: PathBuf,
}

impl Bytes {
    /// Opens the file, and its first bytes as text.
    pub(super) fn open(path: &Path) -> Result<(Self, Vec<u8>), ReadError> {
        let (file, sum) = Hashing::new(File::open(path)?);
        let (mut start, mut text) = looked_at(file)?;
        if is_gzip(&start) {
            let unpacked = looked_at(MultiGzDecoder::new(text));
            (start, text) = unpacked.map_err(|error| damaged(&error.to_string()))?;
            if encoding_of(&start).is_none() && start.contains(&0) {
                return Err(damaged("what is packed is no text"));
            }
        }
        if let Some(encoding) = encoding_of(&start) {
            // Decoded piece by piece: bytes that never end are never held.
            let mut builder = DecodeReaderBytesBuilder::new();
            let decoded = builder.encoding(Some(encoding)).bom_override(true).build(text);
            (start, text) = looked_at(decoded)?;
        }
        Ok((Self { text, sum: Some(sum), path: path.to_owned() }, start))
    }

    /// A text that was made of a file of another kind.
    #[cfg(feature = "xlsx")]
    pub(super) fn made(text: Vec<u8>) -> (Self, Vec<u8>) {
        let start = text.get(..SNIFFED_BYTES).unwrap_or(&text).to_vec();
        let bytes = Self { text: Box::new(Cursor::new(text)), sum: None, path: PathBuf::new() };
        (bytes, start)
    }

    /// The file that was read, all of it.
    pub(super) fn finish(mut self) -> Result<Option<Source>, ReadError> {
        io::copy(&mut self.text, &mut io::sink())?;
        Ok(self.sum.map(|sum| sum.take().source(&self.path)))
    }
}

impl Read for Bytes {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        self.text.read(buffer)
    }
}

/// The first bytes of a text, and all of it.
fn looked_at(mut bytes: impl Read + 'static) -> io::Result<(Vec<u8>, Box<dyn Read>)> {
    let mut start = Vec::new();
    bytes.by_ref().take(SNIFFED_BYTES as u64).read_to_end(&mut start)?;
    if start.starts_with(BYTE_ORDER_MARK) {
        start.drain(..BYTE_ORDER_MARK.len());
    }
    Ok((start.clone(), Box::new(Cursor::new(start).chain(bytes))))
}

fn damaged(reason: &str) -> ReadError {
    let remedy = "pack it again, or unpack it if it is of another format";
    ReadError::format("CSV packed by gzip", reason, remedy)
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
