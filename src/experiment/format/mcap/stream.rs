//! The records of a file, one after another.
//!
//! Read here, since the crate `mcap` (0.25 and 0.26) takes memory for what a record claims to hold, and
//! does not refuse every chunk whose size is wrong.
//!
//! # References
//! MCAP format specification, <https://mcap.dev/spec>, records 0x02 to 0x06 and 0x0F.

use std::fmt::Display;
use std::fs::File;
use std::io::{BufReader, Read};
use std::path::Path;

use crate::experiment::error::ReadError;
use crate::experiment::memory::Budget;

/// What a file begins and ends with.
const MAGIC: [u8; 8] = *b"\x89MCAP0\r\n";

/// Bytes before a record: what it is, and its length.
const HEAD: u64 = 9;

// What records are, as the specification numbers them.
const FOOTER: u8 = 2;
pub(super) const SCHEMA: u8 = 3;
pub(super) const CHANNEL: u8 = 4;
pub(super) const MESSAGE: u8 = 5;
const CHUNK: u8 = 6;
const DATA_END: u8 = 15;

/// Why a file is refused.
pub(super) fn refused(reason: impl Display, remedy: &str) -> ReadError {
    ReadError::format("MCAP", reason, remedy)
}

fn damaged(reason: impl Display) -> ReadError {
    refused(reason, "`mcap recover FILE` saves what is whole")
}

fn cut_off() -> ReadError {
    damaged("it ends within a record")
}

/// Hands each record of a file to `take`, in chunks or not: what it is, and its fields. Records are read with
/// memory for one chunk. Checksums of chunks and of all data are compared where the file has them.
pub(super) fn for_each_record(
    path: &Path,
    budget: &Budget,
    mut take: impl FnMut(u8, Fields<'_>) -> Result<(), ReadError>,
) -> Result<(), ReadError> {
    let file = File::open(path)?;
    let size = file.metadata()?.len();
    let mut file = BufReader::new(file);
    let (mut head, mut record, mut sum) = (Vec::new(), Vec::new(), crc32fast::Hasher::new());
    fill(&mut head, &mut file, MAGIC.len() as u64)?;
    sum.update(&head);
    loop {
        fill(&mut head, &mut file, HEAD)?;
        let mut fields = Fields(&head);
        let [opcode] = fields.bytes()?;
        let length = u64::from_le_bytes(fields.bytes()?);
        if length > size {
            return Err(damaged("a record is longer than the file"));
        }
        budget.check(2 * length)?;
        fill(&mut record, &mut file, length)?;
        match opcode {
            CHUNK => {
                let mut rest = &*unpacked(Fields(&record), budget)?;
                while !rest.is_empty() {
                    let mut fields = Fields(rest);
                    let [opcode] = fields.bytes()?;
                    let length = u64::from_le_bytes(fields.bytes()?);
                    let record = fields.take(length)?;
                    rest = fields.0;
                    take(opcode, Fields(record))?;
                }
            }
            DATA_END => {
                let saved = u32::from_le_bytes(Fields(&record).bytes()?);
                compare(saved, sum.clone().finalize())?;
            }
            FOOTER => {
                fill(&mut record, &mut file, MAGIC.len() as u64)?;
                return if record == MAGIC { Ok(()) } else { Err(cut_off()) };
            }
            _ => take(opcode, Fields(&record))?,
        }
        sum.update(&head);
        sum.update(&record);
    }
}

/// Reads so many bytes.
fn fill(bytes: &mut Vec<u8>, file: &mut impl Read, count: u64) -> Result<(), ReadError> {
    bytes.clear();
    let read = file.take(count).read_to_end(bytes)? as u64;
    if read == count { Ok(()) } else { Err(cut_off()) }
}

/// What a chunk holds.
fn unpacked(mut fields: Fields<'_>, budget: &Budget) -> Result<Vec<u8>, ReadError> {
    let [_, _, size] = [fields.bytes()?, fields.bytes()?, fields.bytes()?].map(u64::from_le_bytes);
    let saved = u32::from_le_bytes(fields.bytes()?);
    let compression = fields.text()?;
    let length = u64::from_le_bytes(fields.bytes()?);
    let data = fields.take(length)?;
    let inside: Box<dyn Read + '_> = match compression {
        "" => Box::new(data),
        "zstd" => Box::new(zstd::stream::read::Decoder::with_buffer(data).map_err(damaged)?),
        "lz4" => Box::new(lz4::Decoder::new(data).map_err(damaged)?),
        other => {
            let remedy = "write it with the compression zstd, lz4 or none: `mcap compress FILE`";
            return Err(refused(format!("a chunk is compressed by {other}"), remedy));
        }
    };
    // A vector that grows takes up to twice of what is in it.
    let limit = size.min(budget.left() / 2);
    let mut bytes = Vec::new();
    let count = inside.take(limit).read_to_end(&mut bytes).map_err(damaged)? as u64;
    if count < size {
        budget.check(2 * (count + 1))?;
        return Err(damaged("a chunk is shorter than it says"));
    }
    compare(saved, crc32fast::hash(&bytes))?;
    Ok(bytes)
}

/// Refuses bytes whose checksum is not the one that was saved; 0 stands for none.
fn compare(saved: u32, found: u32) -> Result<(), ReadError> {
    let is_same = saved == 0 || saved == found;
    is_same.then_some(()).ok_or_else(|| damaged("its checksum is not that of its bytes"))
}

/// The fields of a record that are still to be read.
pub(super) struct Fields<'a>(pub(super) &'a [u8]);

impl<'a> Fields<'a> {
    fn take(&mut self, count: u64) -> Result<&'a [u8], ReadError> {
        let count = usize::try_from(count).unwrap_or(usize::MAX);
        let (taken, rest) = self.0.split_at_checked(count).ok_or_else(cut_off)?;
        self.0 = rest;
        Ok(taken)
    }

    pub(super) fn bytes<const N: usize>(&mut self) -> Result<[u8; N], ReadError> {
        let (bytes, rest) = self.0.split_first_chunk().ok_or_else(cut_off)?;
        self.0 = rest;
        Ok(*bytes)
    }

    /// As many bytes as the number before them says.
    pub(super) fn block(&mut self) -> Result<&'a [u8], ReadError> {
        let length = u32::from_le_bytes(self.bytes()?);
        self.take(length.into())
    }

    pub(super) fn text(&mut self) -> Result<&'a str, ReadError> {
        std::str::from_utf8(self.block()?).map_err(damaged)
    }
}
