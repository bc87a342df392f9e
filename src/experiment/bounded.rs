//! Files of settings as text: small ones, whatever they claim to be.

use std::fs::File;
use std::io::{Error, ErrorKind, Read as _};
use std::path::Path;

use super::format::text_of;

/// Bytes that nobody writes by hand.
const MOST: u64 = 64 << 20;

/// Bytes that no program writes about the steps of an experiment.
const MOST_OF_RESULTS: u64 = 256 << 20;

/// The text of a file that somebody wrote, as `std::fs::read_to_string` gives it, which reads a
/// device without end for ever.
///
/// # Errors
/// What the system says; [`ErrorKind::InvalidData`] for what is longer than 64 MB, or is not UTF-8.
pub(crate) fn read_text(path: &Path) -> std::io::Result<String> {
    read_text_to(path, MOST)
}

/// The text of a table that somebody filled in, as a spreadsheet program writes it: UTF-8, UTF-16 or
/// Windows-1252.
///
/// # Errors
/// What the system says; [`ErrorKind::InvalidData`] for what is longer than 64 MB, or is no text.
pub(crate) fn read_sheet(path: &Path) -> std::io::Result<String> {
    let mut bytes = Vec::new();
    File::open(path)?.take(MOST + 1).read_to_end(&mut bytes)?;
    check_length(bytes.len(), MOST)?;
    text_of(bytes).ok_or_else(|| Error::new(ErrorKind::InvalidData, "it is no text"))
}

/// The text of a file that this program wrote, or another one in its form, as [`read_text`] gives it.
///
/// # Errors
/// What the system says; [`ErrorKind::InvalidData`] for what is longer than 256 MB, or is not UTF-8.
pub(crate) fn read_result(path: &Path) -> std::io::Result<String> {
    read_text_to(path, MOST_OF_RESULTS)
}

fn read_text_to(path: &Path, most: u64) -> std::io::Result<String> {
    let mut text = String::new();
    File::open(path)?.take(most + 1).read_to_string(&mut text)?;
    check_length(text.len(), most)?;
    Ok(text)
}

fn check_length(bytes: usize, most: u64) -> std::io::Result<()> {
    if bytes as u64 <= most {
        return Ok(());
    }
    let reason = format!("it has more than {} MB, which no file of this kind has", most >> 20);
    Err(Error::new(ErrorKind::InvalidData, reason))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_text_is_read_whole_or_refused() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.toml");
        std::fs::write(&path, "a = 1\n").unwrap();
        assert_eq!(read_text_to(&path, 6).unwrap(), "a = 1\n");
        assert_eq!(read_text_to(&path, 5).unwrap_err().kind(), ErrorKind::InvalidData);
        std::fs::write(&path, b"\xff").unwrap();
        assert_eq!(read_text(&path).unwrap_err().kind(), ErrorKind::InvalidData);
        assert_eq!(read_text(folder.path()).unwrap_err().kind(), ErrorKind::IsADirectory);
    }

    #[test]
    #[cfg(target_os = "linux")]
    fn a_device_without_end_is_refused() {
        let error = read_text_to(Path::new("/dev/zero"), 1 << 20).unwrap_err();
        assert!(error.to_string().contains("more than 1 MB"), "{error}");
    }
}
