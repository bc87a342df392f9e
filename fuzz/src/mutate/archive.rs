//! XLSX: an archive of XML files.

use std::io::{Cursor, Read as _, Write as _};

use zip::write::SimpleFileOptions;
use zip::{CompressionMethod, ZipArchive, ZipWriter};

use super::Mutation;
use super::tables;

/// Most bytes that a file may have unpacked here.
const LARGEST: u64 = 1 << 18;

/// Changes a file of the archive, most often as words of a text.
pub(super) fn xlsx(mutation: &mut Mutation, bytes: &[u8]) -> Option<Vec<u8>> {
    let mut files = files(bytes)?;
    let place = mutation.below(files.len());
    let (name, content) = files.get_mut(place)?;
    match mutation.below(8) {
        0 => mutation.shuffle(&mut files),
        1 => *name = mutation.text(name),
        2..5 => *content = tables::tags(mutation, content)?,
        _ => mutation.bytes(content),
    }
    archive(&files)
}

fn files(bytes: &[u8]) -> Option<Vec<(String, Vec<u8>)>> {
    let mut archive = ZipArchive::new(Cursor::new(bytes)).ok()?;
    let mut files = Vec::new();
    for index in 0..archive.len() {
        let file = archive.by_index(index).ok()?;
        let (name, mut content) = (file.name().ok()?.into_owned(), Vec::new());
        file.take(LARGEST).read_to_end(&mut content).ok()?;
        files.push((name, content));
    }
    Some(files)
}

fn archive(files: &[(String, Vec<u8>)]) -> Option<Vec<u8>> {
    let mut writer = ZipWriter::new(Cursor::new(Vec::new()));
    let options = SimpleFileOptions::default().compression_method(CompressionMethod::Deflated);
    for (name, content) in files {
        // A name that is there twice is left out.
        if writer.start_file(name, options).is_ok() {
            writer.write_all(content).ok()?;
        }
    }
    Some(writer.finish().ok()?.into_inner())
}
