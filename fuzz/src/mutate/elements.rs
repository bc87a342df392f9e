//! MATLAB 5, element by element.

use std::io::{Read as _, Write as _};

use flate2::Compression;
use flate2::read::ZlibDecoder;
use flate2::write::ZlibEncoder;

use super::Mutation;

const HEADER: usize = 128;
const PACKED: u32 = 15;
/// Most bytes that an element may have unpacked here.
const LARGEST: u64 = 1 << 20;

/// An element, and the size that it says it has where that is not its own.
#[derive(Clone)]
struct Element {
    kind: u32,
    data: Vec<u8>,
    says: Option<u32>,
}

/// Changes an element of a file, unpacked where it is packed.
pub(super) fn mat5(mutation: &mut Mutation, bytes: &[u8]) -> Option<Vec<u8>> {
    let (header, rest) = bytes.split_at_checked(HEADER)?;
    // Other files are of version 4, or 7.3.
    if !header.starts_with(b"MATLAB 5") {
        return None;
    }
    let mut parts = elements(rest);
    let place = mutation.below(parts.len());
    let element = parts.get_mut(place)?;
    match mutation.below(8) {
        0 => mutation.shuffle(&mut parts),
        1 => element.says = u32::try_from(mutation.extreme()).ok(),
        2 => element.kind = u32::try_from(mutation.below(20)).ok()?,
        3 => repacked(element)?,
        _ if element.kind == PACKED => {
            let mut unpacked = unpacked(&element.data)?;
            mutation.numbers(&mut unpacked);
            element.data = packed(&unpacked)?;
        }
        _ => mutation.numbers(&mut element.data),
    }
    Some([header, &written(&parts)].concat())
}

fn elements(mut bytes: &[u8]) -> Vec<Element> {
    let mut found = Vec::new();
    while let Some((kind, data, rest)) = first(bytes) {
        found.push(Element { kind, data: data.to_vec(), says: None });
        bytes = rest;
    }
    found
}

fn first(bytes: &[u8]) -> Option<(u32, &[u8], &[u8])> {
    let (kind, rest) = bytes.split_first_chunk()?;
    let (size, rest) = rest.split_first_chunk()?;
    let (data, rest) = rest.split_at_checked(usize::try_from(u32::from_le_bytes(*size)).ok()?)?;
    Some((u32::from_le_bytes(*kind), data, rest))
}

fn written(elements: &[Element]) -> Vec<u8> {
    let element = |Element { kind, data, says }: &Element| {
        let size = says.or_else(|| u32::try_from(data.len()).ok()).unwrap_or(u32::MAX);
        [&kind.to_le_bytes(), &size.to_le_bytes()[..], data].concat()
    };
    elements.iter().flat_map(element).collect()
}

/// Packs what is not packed, and the other way round.
fn repacked(element: &mut Element) -> Option<()> {
    if element.kind == PACKED {
        *element = elements(&unpacked(&element.data)?).into_iter().next()?;
    } else {
        element.data = packed(&written(std::slice::from_ref(element)))?;
        element.kind = PACKED;
    }
    Some(())
}

fn unpacked(data: &[u8]) -> Option<Vec<u8>> {
    let mut bytes = Vec::new();
    ZlibDecoder::new(data).take(LARGEST).read_to_end(&mut bytes).ok()?;
    Some(bytes)
}

fn packed(bytes: &[u8]) -> Option<Vec<u8>> {
    let mut encoder = ZlibEncoder::new(Vec::new(), Compression::fast());
    encoder.write_all(bytes).ok()?;
    encoder.finish().ok()
}
