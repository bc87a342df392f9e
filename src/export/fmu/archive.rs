//! The archive that an FMU is.

use std::io::{Cursor, Write as _};

use crate::export::ExportError;
use zip::write::SimpleFileOptions;
use zip::{CompressionMethod, ZipWriter};

/// A file in the archive.
#[derive(Debug)]
pub(super) struct Entry {
    pub(super) path: String,
    pub(super) content: Vec<u8>,
}

impl Entry {
    pub(super) fn text(path: &str, text: String) -> Self {
        Self { path: path.to_owned(), content: text.into_bytes() }
    }
}

/// The archive of `entries`, the same bytes for the same entries.
pub(super) fn archive(entries: &[Entry]) -> Result<Vec<u8>, ExportError> {
    let mut writer = ZipWriter::new(Cursor::new(Vec::new()));
    let options = SimpleFileOptions::default()
        .compression_method(CompressionMethod::Deflated)
        .last_modified_time(zip::DateTime::default());
    let written = entries.iter().try_for_each(|entry| {
        writer.start_file(entry.path.as_str(), options)?;
        writer.write_all(&entry.content)?;
        Ok(())
    });
    let archive = written.and_then(|()| writer.finish());
    archive
        .map(Cursor::into_inner)
        .map_err(|error: zip::result::ZipError| ExportError::Archive { problem: error.to_string() })
}
