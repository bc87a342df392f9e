//! Whether the strings of a record lie within it.
//!
//! The reader of a record takes memory for a string before it looks whether it is there: four bytes
//! that claim four gigabytes would end the program where memory is limited. Here the lengths are
//! compared with the record first.
//!
//! # References
//! MCAP format specification, <https://mcap.dev/spec>, records 0x01 to 0x0d.

use mcap::records::op;

/// Bytes of a number of eight, as times and places are.
const LONG: usize = 8;

/// Whether all strings of the record `data` end within it. Other parts of it, and records that have
/// no strings, are not judged.
pub(super) fn strings_fit(opcode: u8, data: &[u8]) -> bool {
    let rest = Some(data);
    match opcode {
        op::HEADER => rest.and_then(string).and_then(string),
        op::SCHEMA => rest.and_then(|data| data.get(2..)).and_then(string).and_then(string),
        op::CHANNEL => {
            let topic = rest.and_then(|data| data.get(4..));
            topic.and_then(string).and_then(string).and_then(map)
        }
        op::CHUNK => rest.and_then(|data| data.get(3 * LONG + 4..)).and_then(string),
        op::CHUNK_INDEX => {
            let offsets = rest.and_then(|data| data.get(4 * LONG..)).and_then(block);
            let compression = offsets.and_then(|(_, rest)| rest.get(LONG..));
            compression.and_then(string)
        }
        op::ATTACHMENT => {
            rest.and_then(|data| data.get(2 * LONG..)).and_then(string).and_then(string)
        }
        op::ATTACHMENT_INDEX => {
            rest.and_then(|data| data.get(5 * LONG..)).and_then(string).and_then(string)
        }
        op::METADATA => rest.and_then(string).and_then(map),
        op::METADATA_INDEX => rest.and_then(|data| data.get(2 * LONG..)).and_then(string),
        _ => rest,
    }
    .is_some()
}

/// What is behind a string at the beginning of `data`.
fn string(data: &[u8]) -> Option<&[u8]> {
    block(data).map(|(_, rest)| rest)
}

/// What is behind a map of strings at the beginning of `data`.
fn map(data: &[u8]) -> Option<&[u8]> {
    let (mut pairs, rest) = block(data)?;
    while !pairs.is_empty() {
        pairs = string(pairs).and_then(string)?;
    }
    Some(rest)
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
        assert!(strings_fit(op::CHANNEL, &channel));
        let parsed = mcap::parse_record(op::CHANNEL, &channel);
        assert!(parsed.is_ok(), "as the crate has it");
        // The last byte of each length.
        for place in [7, 18, 25, 29, 36] {
            let mut forged = channel.clone();
            assert_eq!(forged[place], 0);
            forged[place] = 0x7f;
            assert!(!strings_fit(op::CHANNEL, &forged), "{place}");
        }
        assert!(strings_fit(op::HEADER, &topics) && !strings_fit(op::HEADER, &topics[1..]));
        assert!(strings_fit(op::DATA_END, &[]), "no strings");
    }
}
