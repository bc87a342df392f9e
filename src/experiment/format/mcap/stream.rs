//! The records of a file, one after another.

use std::collections::BTreeMap;
use std::io::{Read, Seek};
use std::ops::ControlFlow;

use mcap::McapError;
use mcap::records::Record;
use mcap::sans_io::{
    LinearReadEvent, LinearReader, LinearReaderOptions, SummaryReadEvent, SummaryReader,
    SummaryReaderOptions,
};

use super::fault::Fault;

/// A record larger than this is a sign of damage: memory is not asked for it.
const LARGEST_RECORD: usize = 1 << 30;

/// Hands each record to `visit` until that breaks off, with memory for one record.
pub(super) fn each_record(
    mut file: impl Read,
    mut visit: impl FnMut(Record<'_>) -> Result<ControlFlow<()>, Fault>,
) -> Result<(), Fault> {
    let options = LinearReaderOptions::default()
        .with_validate_chunk_crcs(true)
        .with_record_length_limit(LARGEST_RECORD);
    let mut reader = LinearReader::new_with_options(options);
    while let Some(event) = reader.next_event() {
        match event.map_err(|error| damaged(&error))? {
            LinearReadEvent::ReadRequest(need) => {
                let count = file.read(reader.insert(need)).map_err(|e| damaged(&e.into()))?;
                reader.notify_read(count);
            }
            LinearReadEvent::Record { opcode, data } => {
                let record = mcap::parse_record(opcode, data).map_err(|error| damaged(&error))?;
                if visit(record)?.is_break() {
                    return Ok(());
                }
            }
        }
    }
    Ok(())
}

fn damaged(error: &McapError) -> Fault {
    let remedy = match error {
        McapError::UnsupportedCompression(_) => {
            "write it with the compression zstd, lz4 or none: `mcap compress FILE`"
        }
        _ => "`mcap recover FILE` saves what is whole",
    };
    Fault { reason: error.to_string(), remedy }
}

/// What a file says at its end of all its messages.
pub(super) struct Summary {
    /// Messages of each channel that has any.
    pub(super) counts: BTreeMap<u16, u64>,
    /// When the first one was recorded, in nanoseconds.
    pub(super) start: Option<i64>,
}

/// The summary, where there is one.
pub(super) fn summary(mut file: impl Read + Seek) -> Option<Summary> {
    let options = SummaryReaderOptions::default().with_record_length_limit(LARGEST_RECORD);
    let mut reader = SummaryReader::new_with_options(options);
    while let Some(event) = reader.next_event() {
        match event.ok()? {
            SummaryReadEvent::ReadRequest(need) => {
                let count = file.read(reader.insert(need)).ok()?;
                reader.notify_read(count);
            }
            SummaryReadEvent::SeekRequest(to) => reader.notify_seeked(file.seek(to).ok()?),
        }
    }
    let stats = reader.finish()?.stats?;
    let mut counts = stats.channel_message_counts;
    // A channel without messages is not waited for.
    counts.retain(|_, count| *count > 0);
    Some(Summary { counts, start: i64::try_from(stats.message_start_time).ok() })
}
