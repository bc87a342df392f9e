//! Files of settings as text: small ones, whatever they claim to be.

use std::fs::File;
use std::io::{Error, ErrorKind, Read as _};
use std::path::Path;

use super::format::text_of;

/// Bytes that neither a person writes by hand nor a program about the steps of an experiment.
const MOST: u64 = 256 << 20;

/// The text of a file that somebody wrote, or this program, as `std::fs::read_to_string` gives it, which reads a
/// device without end for ever.
///
/// # Errors
/// What the system says; [`ErrorKind::InvalidData`] for what is longer than 256 MB, or is not UTF-8.
pub(crate) fn read_text(path: &Path) -> std::io::Result<String> {
    String::from_utf8(read(path)?).map_err(|error| Error::new(ErrorKind::InvalidData, error))
}

/// The text of a table that somebody filled in, as a spreadsheet program writes it: UTF-8, UTF-16 or
/// Windows-1252.
///
/// # Errors
/// As [`read_text`].
pub(crate) fn read_sheet(path: &Path) -> std::io::Result<String> {
    text_of(read(path)?).ok_or_else(|| Error::new(ErrorKind::InvalidData, "it is no text"))
}

fn read(path: &Path) -> std::io::Result<Vec<u8>> {
    let mut bytes = Vec::new();
    File::open(path)?.take(MOST + 1).read_to_end(&mut bytes)?;
    if bytes.len() as u64 > MOST {
        let reason = format!("it has more than {} MB, which no file of this kind has", MOST >> 20);
        return Err(Error::new(ErrorKind::InvalidData, reason));
    }
    Ok(bytes)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_text_is_read_whole_or_refused() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.toml");
        std::fs::write(&path, "a = 1\n").unwrap();
        assert_eq!(read_text(&path).unwrap(), "a = 1\n");
        std::fs::write(&path, b"\xff").unwrap();
        assert_eq!(read_text(&path).unwrap_err().kind(), ErrorKind::InvalidData);
        assert_eq!(read_text(folder.path()).unwrap_err().kind(), ErrorKind::IsADirectory);
    }

    #[test]
    #[cfg(target_os = "linux")]
    fn a_device_without_end_is_refused() {
        let error = read_text(Path::new("/dev/zero")).unwrap_err();
        assert!(error.to_string().contains("more than 256 MB"), "{error}");
    }
}
