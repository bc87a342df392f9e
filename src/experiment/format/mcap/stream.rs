//! The records of a file, one after another.

use std::fmt::Display;
use std::io::Read;

use mcap::McapError;
use mcap::records::{Record, op};
use mcap::sans_io::{LinearReadEvent, LinearReader, LinearReaderOptions};

use crate::experiment::error::ReadError;
use crate::experiment::memory::Budget;

/// A record larger than this is a sign of damage. The crate mcap 0.26 takes the memory that one claims.
const LARGEST_RECORD: u64 = 1 << 28;

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

/// Hands the schemas, channels and messages of a file to `visit`, those in chunks too, with memory for one
/// record. Checksums of chunks and of all data are compared where the file has them.
pub(super) fn each_record(
    mut file: impl Read,
    budget: &Budget,
    mut visit: impl FnMut(Record<'_>) -> Result<(), ReadError>,
) -> Result<(), ReadError> {
    let largest = LARGEST_RECORD.min(budget.left());
    let options = LinearReaderOptions::default()
        .with_validate_data_section_crc(true)
        .with_validate_chunk_crcs(true)
        .with_record_length_limit(usize::try_from(largest).unwrap_or(usize::MAX));
    let mut reader = LinearReader::new_with_options(options);
    while let Some(event) = reader.next_event() {
        match event {
            Ok(LinearReadEvent::ReadRequest(need)) => {
                let count = file.read(reader.insert(need)).map_err(McapError::from)?;
                reader.notify_read(count);
            }
            Ok(LinearReadEvent::Record { opcode, data }) => {
                if let Some(record) = parsed(opcode, data)? {
                    visit(record)?;
                }
            }
            Err(error) => {
                if let McapError::RecordTooLarge { len, .. } | McapError::ChunkTooLarge(len) = error
                {
                    budget.check(len.min(LARGEST_RECORD))?;
                }
                return Err(error.into());
            }
        }
    }
    Ok(())
}

/// A record, where it is one that is of use.
fn parsed(opcode: u8, data: &[u8]) -> Result<Option<Record<'_>>, McapError> {
    match opcode {
        op::SCHEMA | op::CHANNEL | op::MESSAGE if strings_fit(opcode, data) => {
            mcap::parse_record(opcode, data).map(Some)
        }
        op::SCHEMA | op::CHANNEL => Err(McapError::UnexpectedEof),
        _ => Ok(None),
    }
}

/// Whether the strings of a record lie within it: the crate takes memory for a string before it looks
/// whether it is there, so that four bytes that claim four gigabytes would end the program.
fn strings_fit(opcode: u8, data: &[u8]) -> bool {
    let head = match opcode {
        op::SCHEMA => 2,
        op::CHANNEL => 4,
        _ => return true,
    };
    let mut rest = data.get(head..);
    for _ in 0..2 {
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
