//! MCAP, record by record.

use std::io::{Read as _, Write as _};

use super::Mutation;

const MAGIC: &[u8] = b"\x89MCAP0\r\n";
const CHUNK: u8 = 6;
const MESSAGE: u8 = 5;
/// Most bytes that a chunk may have unpacked here.
const LARGEST: u64 = 1 << 20;

/// A record, and the size that it says it has where that is not its own.
#[derive(Clone)]
struct Record {
    opcode: u8,
    body: Vec<u8>,
    says: Option<u64>,
}

/// Changes a record of a file, or one within a chunk.
pub(super) fn mcap(mutation: &mut Mutation, bytes: &[u8]) -> Option<Vec<u8>> {
    let mut parts = records(bytes.strip_prefix(MAGIC)?);
    change(mutation, &mut parts);
    Some([MAGIC, &written(&parts), MAGIC].concat())
}

/// The whole records of `bytes`.
fn records(mut bytes: &[u8]) -> Vec<Record> {
    let mut found = Vec::new();
    while let Some((opcode, size, rest)) = head(bytes) {
        let Some((body, rest)) = rest.split_at_checked(size) else { break };
        found.push(Record { opcode, body: body.to_vec(), says: None });
        bytes = rest;
    }
    found
}

fn head(bytes: &[u8]) -> Option<(u8, usize, &[u8])> {
    let (opcode, rest) = bytes.split_first()?;
    let (size, rest) = rest.split_first_chunk()?;
    Some((*opcode, usize::try_from(u64::from_le_bytes(*size)).ok()?, rest))
}

fn written(records: &[Record]) -> Vec<u8> {
    let record = |Record { opcode, body, says }: &Record| {
        let size = says.unwrap_or(body.len() as u64);
        [&[*opcode], &size.to_le_bytes()[..], body].concat()
    };
    records.iter().flat_map(record).collect()
}

fn change(mutation: &mut Mutation, records: &mut Vec<Record>) {
    if records.is_empty() {
        return;
    }
    // Messages are many; what describes them is few, and says more.
    let mut place = mutation.below(records.len());
    if records[place].opcode == MESSAGE {
        place = mutation.below(records.len());
    }
    let record = &mut records[place];
    match mutation.below(8) {
        0 => mutation.shuffle(records),
        1 => record.says = Some(mutation.extreme()),
        2 => record.opcode = u8::try_from(mutation.below(17)).unwrap_or(0),
        3 => mutation.numbers(&mut record.body),
        _ if record.opcode == CHUNK => {
            if let Some(chunk) = changed_chunk(mutation, &record.body) {
                record.body = chunk;
            }
        }
        _ => mutation.bytes(&mut record.body),
    }
}

/// A chunk with a record changed, packed again in one of the ways there are.
fn changed_chunk(mutation: &mut Mutation, body: &[u8]) -> Option<Vec<u8>> {
    let (times, rest) = body.split_at_checked(16)?;
    let (_, rest) = rest.split_at_checked(12)?;
    let (length, rest) = rest.split_first_chunk::<4>()?;
    let length = usize::try_from(u32::from_le_bytes(*length)).ok()?;
    let (compression, rest) = rest.split_at_checked(length)?;
    let (_, packed) = rest.split_at_checked(8)?;
    let mut parts = records(&unpacked(compression, packed)?);
    change(mutation, &mut parts);
    let unpacked = written(&parts);
    let compression = match mutation.below(6) {
        0 => &b""[..],
        1 => b"zstd",
        2 => b"lz4",
        _ => compression,
    };
    let packed = packed_by(compression, &unpacked)?;
    let size = if mutation.one_in(8) { mutation.extreme() } else { unpacked.len() as u64 };
    // Without a checksum.
    let parts = [
        times,
        &size.to_le_bytes(),
        &0_u32.to_le_bytes(),
        &u32::try_from(compression.len()).ok()?.to_le_bytes(),
        compression,
        &(packed.len() as u64).to_le_bytes(),
        &packed,
    ];
    Some(parts.concat())
}

fn unpacked(compression: &[u8], packed: &[u8]) -> Option<Vec<u8>> {
    let mut bytes = Vec::new();
    match compression {
        b"zstd" => {
            zstd::Decoder::new(packed).ok()?.take(LARGEST).read_to_end(&mut bytes).ok()?;
        }
        b"lz4" => {
            lz4::Decoder::new(packed).ok()?.take(LARGEST).read_to_end(&mut bytes).ok()?;
        }
        _ => bytes.extend_from_slice(packed),
    }
    Some(bytes)
}

fn packed_by(compression: &[u8], bytes: &[u8]) -> Option<Vec<u8>> {
    match compression {
        b"zstd" => zstd::encode_all(bytes, 1).ok(),
        b"lz4" => {
            let mut encoder = lz4::EncoderBuilder::new().build(Vec::new()).ok()?;
            encoder.write_all(bytes).ok()?;
            Some(encoder.finish().0)
        }
        _ => Some(bytes.to_vec()),
    }
}
