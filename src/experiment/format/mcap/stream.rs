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
                if [op::SCHEMA, op::CHANNEL, op::MESSAGE].contains(&opcode) {
                    visit(mcap::parse_record(opcode, data)?)?;
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
