//! The records of a file, one after another.
//!
//! Chunks are unpacked here and not by the reader of the crate mcap 0.25, which never ends where
//! a chunk's size is wrong by a byte, and asks for the memory that a record claims to need.
//!
//! # References
//! MCAP format specification, <https://mcap.dev/spec>, records 0x03 to 0x06.

use std::fmt::Display;
use std::io::Read;

use mcap::McapError;
use mcap::records::{ChunkHeader, Record, op};
use mcap::sans_io::{LinearReadEvent, LinearReader, LinearReaderOptions};

use crate::experiment::error::ReadError;
use crate::experiment::memory::Budget;

/// A record larger than this is a sign of damage: memory is not asked for it.
const LARGEST_RECORD: u64 = 1 << 30;

/// Bytes before a record: what it is, and its length.
const RECORD_HEAD: usize = 9;

/// Why a file is refused.
pub(super) fn refused(reason: impl Display, remedy: &str) -> ReadError {
    ReadError::format("MCAP", reason, remedy)
}

impl From<McapError> for ReadError {
    fn from(error: McapError) -> Self {
        let remedy = match error {
            McapError::UnsupportedCompression(_) => {
                "write it with the compression zstd, lz4 or none: `mcap compress FILE`"
            }
            _ => "`mcap recover FILE` saves what is whole",
        };
        refused(error, remedy)
    }
}

/// Hands the schemas, channels and messages of a file of `size` bytes to `visit`, those in chunks
/// too, with memory for one chunk. Checksums of chunks and of all data are compared where the
/// file has them.
pub(super) fn each_record(
    mut file: impl Read,
    size: u64,
    budget: &Budget,
    mut visit: impl FnMut(Record<'_>) -> Result<(), ReadError>,
) -> Result<(), ReadError> {
    // No record is larger than its file: memory is not asked for one that says so.
    let largest = usize::try_from(size.min(LARGEST_RECORD)).unwrap_or(usize::MAX);
    let options = LinearReaderOptions::default()
        .with_validate_data_section_crc(true)
        .with_emit_chunks(true)
        .with_record_length_limit(largest);
    let mut reader = LinearReader::new_with_options(options);
    while let Some(event) = reader.next_event() {
        match event? {
            LinearReadEvent::ReadRequest(need) => {
                let count = file.read(reader.insert(need)).map_err(McapError::from)?;
                reader.notify_read(count);
            }
            LinearReadEvent::Record { opcode, data } => match parsed(opcode, data)? {
                Some(Record::Chunk { header, data }) => {
                    let unpacked = unpacked(&header, &data, budget)?;
                    each_in_chunk(&unpacked, &mut visit)?;
                }
                Some(record) => visit(record)?,
                None => {}
            },
        }
    }
    Ok(())
}

/// Hands on the records of a chunk.
fn each_in_chunk(
    mut rest: &[u8],
    visit: &mut impl FnMut(Record<'_>) -> Result<(), ReadError>,
) -> Result<(), ReadError> {
    while !rest.is_empty() {
        let head = rest.split_first_chunk::<RECORD_HEAD>();
        let ([opcode, length @ ..], data) = head.ok_or(McapError::UnexpectedEoc)?;
        let length = usize::try_from(u64::from_le_bytes(*length)).unwrap_or(usize::MAX);
        let (record, after) = data.split_at_checked(length).ok_or(McapError::UnexpectedEoc)?;
        if let Some(record) = parsed(*opcode, record)? {
            visit(record)?;
        }
        rest = after;
    }
    Ok(())
}

/// What a chunk holds.
fn unpacked(header: &ChunkHeader, data: &[u8], budget: &Budget) -> Result<Vec<u8>, ReadError> {
    let inside: Box<dyn Read + '_> = match header.compression.as_str() {
        "" => Box::new(data),
        "zstd" => {
            Box::new(zstd::stream::read::Decoder::with_buffer(data).map_err(McapError::from)?)
        }
        "lz4" => Box::new(lz4::Decoder::new(data).map_err(McapError::from)?),
        other => return Err(McapError::UnsupportedCompression(other.to_owned()).into()),
    };
    let size = header.uncompressed_size;
    // A vector that grows takes up to twice of what is in it.
    let limit = size.min(budget.left() / 2);
    let mut bytes = Vec::new();
    let count = inside.take(limit).read_to_end(&mut bytes).map_err(McapError::from)? as u64;
    if count < size {
        budget.check(2 * (count + 1))?;
        return Err(McapError::UnexpectedEoc.into());
    }
    let (saved, calculated) = (header.uncompressed_crc, crc32fast::hash(&bytes));
    if saved != 0 && saved != calculated {
        return Err(McapError::BadChunkCrc { saved, calculated }.into());
    }
    Ok(bytes)
}

/// A record, where it is one that is of use.
fn parsed(opcode: u8, data: &[u8]) -> Result<Option<Record<'_>>, McapError> {
    match opcode {
        op::SCHEMA | op::CHANNEL | op::MESSAGE | op::CHUNK if strings_fit(opcode, data) => {
            mcap::parse_record(opcode, data).map(Some)
        }
        op::SCHEMA | op::CHANNEL | op::CHUNK => Err(McapError::UnexpectedEof),
        _ => Ok(None),
    }
}

/// Whether the strings of a record lie within it: the crate takes memory for a string before it looks
/// whether it is there, so that four bytes that claim four gigabytes would end the program.
fn strings_fit(opcode: u8, data: &[u8]) -> bool {
    let (head, strings) = match opcode {
        op::SCHEMA => (2, 2),
        op::CHANNEL => (4, 2),
        op::CHUNK => (28, 1),
        _ => return true,
    };
    let mut rest = data.get(head..);
    for _ in 0..strings {
        rest = rest.and_then(block).map(|(_, rest)| rest);
    }
    // Behind those of a channel is a map of strings.
    match rest {
        Some(rest) if opcode == op::CHANNEL => block(rest).is_some_and(|(map, _)| are_strings(map)),
        rest => rest.is_some(),
    }
}

fn are_strings(mut data: &[u8]) -> bool {
    while let Some((_, rest)) = block(data) {
        data = rest;
    }
    data.is_empty()
}

/// As many bytes as the number before them says, and what is behind them.
fn block(data: &[u8]) -> Option<(&[u8], &[u8])> {
    let (length, rest) = data.split_first_chunk::<4>()?;
    rest.split_at_checked(usize::try_from(u32::from_le_bytes(*length)).ok()?)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn text(text: &str) -> Vec<u8> {
        let length = u32::try_from(text.len()).unwrap();
        [&length.to_le_bytes()[..], text.as_bytes()].concat()
    }

    #[test]
    fn a_string_that_is_longer_than_its_record_does_not_fit() {
        let topics = [text("a/topic"), text("cdr")].concat();
        let entries = [text("key"), text("value")].concat();
        let map = [&u32::try_from(entries.len()).unwrap().to_le_bytes()[..], &entries].concat();
        let channel = [&[1, 0, 1, 0][..], &topics, &map].concat();
        assert!(matches!(parsed(op::CHANNEL, &channel), Ok(Some(Record::Channel(_)))));
        // The last byte of each length.
        for place in [7, 18, 25, 29, 36] {
            let mut forged = channel.clone();
            assert_eq!(forged[place], 0);
            forged[place] = 0x7f;
            assert!(parsed(op::CHANNEL, &forged).is_err(), "{place}");
        }
        let schema = [&[1, 0][..], &topics, &[0; 4]].concat();
        assert!(matches!(parsed(op::SCHEMA, &schema), Ok(Some(Record::Schema { .. }))));
        assert!(parsed(op::SCHEMA, &topics).is_err());
        assert!(matches!(parsed(op::HEADER, &[]), Ok(None)), "of no use");
    }
}
