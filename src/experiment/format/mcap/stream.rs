//! The records of a file, one after another.
//!
//! Chunks are unpacked here and not by the reader of the crate mcap 0.25, which never ends where
//! a chunk's size is wrong by a byte, and asks for the memory that a record claims to need.

use std::collections::BTreeMap;
use std::fs::File;
use std::io::{self, BufReader, Read, Seek as _, SeekFrom};
use std::ops::ControlFlow;

use mcap::McapError;
use mcap::records::{ChunkHeader, Footer, Record};
use mcap::sans_io::{LinearReadEvent, LinearReader, LinearReaderOptions};

use super::fault::Fault;
use super::lengths::strings_fit;
use crate::experiment::memory::Budget;

/// A record larger than this is a sign of damage: memory is not asked for it.
const LARGEST_RECORD: u64 = 1 << 30;

/// Bytes before a record: what it is, and its length.
const RECORD_HEAD: usize = 9;

/// Hands each record of a file of `size` bytes to `visit` until that breaks off, those in chunks
/// one by one, with memory for one record. Checksums of chunks and of all data are compared where the
/// file has them.
pub(super) fn each_record(
    file: impl Read,
    size: u64,
    budget: &Budget,
    visit: impl FnMut(Record<'_>) -> Result<ControlFlow<()>, Fault>,
) -> Result<(), Fault> {
    let options = LinearReaderOptions::default().with_validate_data_section_crc(true);
    each_from(file, size, options, budget, visit)
}

fn each_from(
    mut file: impl Read,
    size: u64,
    options: LinearReaderOptions,
    budget: &Budget,
    mut visit: impl FnMut(Record<'_>) -> Result<ControlFlow<()>, Fault>,
) -> Result<(), Fault> {
    // No record is larger than its file: memory is not asked for one that says so.
    let largest = usize::try_from(size.min(LARGEST_RECORD)).unwrap_or(usize::MAX);
    let options = options.with_emit_chunks(true).with_record_length_limit(largest);
    let mut reader = LinearReader::new_with_options(options);
    while let Some(event) = reader.next_event() {
        match event.map_err(|error| damaged(&error))? {
            LinearReadEvent::ReadRequest(need) => {
                let count = file.read(reader.insert(need)).map_err(|e| damaged(&e.into()))?;
                reader.notify_read(count);
            }
            LinearReadEvent::Record { opcode, data } => {
                let record = parsed(opcode, data)?;
                let flow = match record {
                    Record::Chunk { header, data } => {
                        each_in_chunk(&header, &data, budget, &mut visit)?
                    }
                    record => visit(record)?,
                };
                if flow.is_break() {
                    return Ok(());
                }
            }
        }
    }
    Ok(())
}

/// Hands on the records of a chunk, unpacked one by one.
fn each_in_chunk(
    header: &ChunkHeader,
    data: &[u8],
    budget: &Budget,
    visit: &mut impl FnMut(Record<'_>) -> Result<ControlFlow<()>, Fault>,
) -> Result<ControlFlow<()>, Fault> {
    let mut inside = Checked::new(BufReader::new(unpacked(header, data)?));
    let mut left = header.uncompressed_size;
    let mut record = Vec::new();
    while left > 0 {
        let mut head = [0; RECORD_HEAD];
        inside.read_exact(&mut head).map_err(|error| not_unpacked(&error))?;
        let [opcode, length @ ..] = head;
        let length = u64::from_le_bytes(length);
        let after = left.checked_sub(RECORD_HEAD as u64).and_then(|left| left.checked_sub(length));
        left = after.ok_or_else(|| damaged(&McapError::UnexpectedEoc))?;
        budget.check(length)?;
        if length > LARGEST_RECORD {
            return Err(damaged(&McapError::RecordTooLarge { opcode, len: length }));
        }
        record.clear();
        let count = inside.by_ref().take(length).read_to_end(&mut record);
        if count.map_err(|error| not_unpacked(&error))? as u64 != length {
            return Err(damaged(&McapError::UnexpectedEoc));
        }
        let record = parsed(opcode, &record)?;
        if visit(record)?.is_break() {
            return Ok(ControlFlow::Break(()));
        }
    }
    let (saved, calculated) = (header.uncompressed_crc, inside.sum.finalize());
    if saved != 0 && saved != calculated {
        return Err(damaged(&McapError::BadChunkCrc { saved, calculated }));
    }
    Ok(ControlFlow::Continue(()))
}

/// A record, the strings of which lie within it.
fn parsed(opcode: u8, data: &[u8]) -> Result<Record<'_>, Fault> {
    if !strings_fit(opcode, data) {
        return Err(damaged(&McapError::UnexpectedEof));
    }
    mcap::parse_record(opcode, data).map_err(|error| damaged(&error))
}

/// What a chunk holds.
fn unpacked<'a>(header: &ChunkHeader, data: &'a [u8]) -> Result<Box<dyn Read + 'a>, Fault> {
    Ok(match header.compression.as_str() {
        "" => Box::new(data),
        "zstd" => {
            Box::new(zstd::stream::read::Decoder::with_buffer(data).map_err(|e| not_unpacked(&e))?)
        }
        "lz4" => Box::new(lz4::Decoder::new(data).map_err(|e| not_unpacked(&e))?),
        other => return Err(damaged(&McapError::UnsupportedCompression(other.to_owned()))),
    })
}

/// Passes bytes on and sums them up.
struct Checked<R> {
    inner: R,
    sum: crc32fast::Hasher,
}

impl<R> Checked<R> {
    fn new(inner: R) -> Self {
        Self { inner, sum: crc32fast::Hasher::new() }
    }
}

impl<R: Read> Read for Checked<R> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let count = self.inner.read(buffer)?;
        self.sum.update(buffer.get(..count).unwrap_or_default());
        Ok(count)
    }
}

fn not_unpacked(error: &io::Error) -> Fault {
    Fault::new(format!("a chunk does not hold what it should: {error}"), RECOVER)
}

/// What to do about a file that is damaged.
const RECOVER: &str = "`mcap recover FILE` saves what is whole";

fn damaged(error: &McapError) -> Fault {
    let remedy = match error {
        McapError::UnsupportedCompression(_) => {
            "write it with the compression zstd, lz4 or none: `mcap compress FILE`"
        }
        _ => RECOVER,
    };
    Fault::new(error.to_string(), remedy)
}

/// What a file says at its end of all its messages.
pub(super) struct Summary {
    /// Messages of each channel that has any.
    pub(super) counts: BTreeMap<u16, u64>,
    /// When the first one was recorded, in nanoseconds.
    pub(super) start: Option<i64>,
}

/// The summary of a file of `size` bytes, where there is one.
pub(super) fn summary(mut file: &File, size: u64, budget: &Budget) -> Option<Summary> {
    let place = footer(file, size)?.summary_start;
    if place == 0 {
        return None;
    }
    file.seek(SeekFrom::Start(place)).ok()?;
    let options = LinearReaderOptions::default().with_skip_start_magic(true);
    let mut found = None;
    each_from(BufReader::new(file), size, options, budget, |record| {
        let Record::Statistics(statistics) = record else { return Ok(ControlFlow::Continue(())) };
        found = Some(statistics);
        Ok(ControlFlow::Break(()))
    })
    .ok()?;
    let stats = found?;
    let mut counts = stats.channel_message_counts;
    // A channel without messages is not waited for.
    counts.retain(|_, count| *count > 0);
    Some(Summary { counts, start: i64::try_from(stats.message_start_time).ok() })
}

/// The last record, which stands before the mark that ends the file.
fn footer(mut file: &File, size: u64) -> Option<Footer> {
    const LENGTH: usize = 20;
    let place = size.checked_sub((RECORD_HEAD + LENGTH + mcap::MAGIC.len()) as u64)?;
    file.seek(SeekFrom::Start(place)).ok()?;
    let mut bytes = [0; RECORD_HEAD + LENGTH];
    file.read_exact(&mut bytes).ok()?;
    let [opcode, rest @ ..] = bytes;
    match parsed(opcode, rest.get(RECORD_HEAD - 1..)?).ok()? {
        Record::Footer(footer) => Some(footer),
        _ => None,
    }
}
