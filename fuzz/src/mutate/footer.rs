//! Parquet: pages, then a footer that describes them, its length and a magic word.

use super::Mutation;

const MAGIC: &[u8] = b"PAR1";

/// Changes the pages or the footer, of which the length is put right.
pub(super) fn parquet(mutation: &mut Mutation, bytes: &[u8]) -> Option<Vec<u8>> {
    let rest = bytes.strip_prefix(MAGIC)?.strip_suffix(MAGIC)?;
    let (rest, length) = rest.split_last_chunk()?;
    let length = usize::try_from(u32::from_le_bytes(*length)).ok()?;
    let (pages, footer) = rest.split_at_checked(rest.len().checked_sub(length)?)?;
    let (mut pages, mut footer) = (pages.to_vec(), footer.to_vec());
    // What stands in the footer counts; only pages of the same length are where it says.
    match mutation.below(4) {
        0 => pages = same_length(mutation, &pages),
        1 => mutation.numbers(&mut footer),
        2 => footer = same_length(mutation, &footer),
        _ => mutation.bytes(&mut footer),
    }
    let length = u32::try_from(footer.len()).ok()?.to_le_bytes();
    Some([MAGIC, &pages, &footer, &length, MAGIC].concat())
}

/// Changes a few bytes and keeps their number.
fn same_length(mutation: &mut Mutation, bytes: &[u8]) -> Vec<u8> {
    let mut changed = bytes.to_vec();
    if bytes.is_empty() {
        return changed;
    }
    for _ in 0..=mutation.below(3) {
        let place = mutation.below(bytes.len());
        changed[place] = match mutation.below(3) {
            0 => mutation.extreme().to_le_bytes()[0],
            1 => changed[place] ^ (1 << mutation.below(8)),
            _ => bytes[mutation.below(bytes.len())],
        };
    }
    changed
}
