//! The formats of logs: one entry of [`FORMATS`] and one file each.

mod csv;
#[cfg(feature = "mat")]
mod mat;
#[cfg(feature = "mcap")]
mod mcap;
#[cfg(feature = "parquet")]
mod parquet;

use std::fs::File;
use std::io::Read as _;
use std::path::Path;

use super::ReadError;
use super::table::OpenTable;

pub(super) use csv::GrowingRows;

/// A format of logs.
struct Format {
    /// What it is called.
    name: &'static str,
    /// How its files' names end.
    endings: &'static [&'static str],
    /// Whether the first bytes of a file are those of this format.
    starts: fn(&[u8]) -> bool,
    /// What to do with a file that is named so but does not start so.
    remedy: &'static str,
    open: fn(&Path) -> Result<OpenTable, ReadError>,
}

/// All formats. The last one is text, which any bytes may be.
const FORMATS: [Format; 4] = [
    Format {
        name: "Parquet",
        endings: &[".parquet", ".pq"],
        starts: |start| start.starts_with(b"PAR1"),
        remedy: "write it again, or rename it if it is of another format",
        #[cfg(feature = "parquet")]
        open: parquet::open,
        #[cfg(not(feature = "parquet"))]
        open: |path| left_out(path, "Parquet", "parquet"),
    },
    Format {
        name: "MATLAB",
        endings: &[".mat"],
        starts: is_matlab,
        remedy: "save it with `save -v7`, or rename it if it is of another format",
        #[cfg(feature = "mat")]
        open: mat::open,
        #[cfg(not(feature = "mat"))]
        open: |path| left_out(path, "MATLAB", "mat"),
    },
    Format {
        name: "MCAP",
        endings: &[".mcap"],
        starts: |start| start.starts_with(b"\x89MCAP0\r\n"),
        remedy: "record it again, or rename it if it is of another format",
        #[cfg(feature = "mcap")]
        open: mcap::open,
        #[cfg(not(feature = "mcap"))]
        open: |path| left_out(path, "MCAP", "mcap"),
    },
    Format {
        name: "CSV",
        endings: &[".csv", ".tsv", ".txt"],
        starts: |_| true,
        remedy: "write it as text",
        open: csv::open,
    },
];

/// Whether these are the first bytes of MATLAB 5 to 7, or of 7.3, which is HDF5 behind a
/// header of 512 bytes or alone.
fn is_matlab(start: &[u8]) -> bool {
    start.starts_with(b"MATLAB 5.0 MAT-file") || is_matlab_73(start)
}

fn is_matlab_73(start: &[u8]) -> bool {
    const HDF5: &[u8] = b"\x89HDF\r\n\x1a\n";
    start.starts_with(HDF5) || start.get(512..).is_some_and(|rest| rest.starts_with(HDF5))
}

#[cfg(not(all(feature = "mat", feature = "mcap", feature = "parquet")))]
fn left_out(
    path: &Path,
    format: &'static str,
    feature: &'static str,
) -> Result<OpenTable, ReadError> {
    Err(ReadError::FormatLeftOut { path: path.to_owned(), format, feature })
}

/// Opens a log. Its first bytes tell the format, so that a name may be anything; but a name
/// that promises a format is kept to it.
pub(super) fn open(path: &Path) -> Result<OpenTable, ReadError> {
    // A pipe gives its bytes once: it is taken for text.
    if path.metadata().is_ok_and(|metadata| !metadata.is_file()) {
        return csv::open(path);
    }
    let start = start_of(path)?;
    if start.is_empty() {
        return Err(ReadError::Empty { path: path.to_owned() });
    }
    let name = path.file_name().unwrap_or_default().to_string_lossy().to_lowercase();
    let named = FORMATS.iter().find(|format| format.ends(&name));
    match FORMATS.iter().find(|format| (format.starts)(&start)) {
        Some(found) => match named.filter(|named| !(named.starts)(&start)) {
            Some(named) if (found.starts)(b"") => Err(named.refuse(path)),
            _ => (found.open)(path),
        },
        None => csv::open(path),
    }
}

/// Whether a log that begins like this, or will be called so, is text.
pub(super) fn is_text(path: &Path, start: &[u8]) -> bool {
    let name = path.file_name().unwrap_or_default().to_string_lossy().to_lowercase();
    let is_text = |format: &Format| (format.starts)(b"");
    let other = |format: &&Format| format.ends(&name) || (format.starts)(start);
    FORMATS.iter().filter(other).all(is_text)
}

impl Format {
    fn ends(&self, name: &str) -> bool {
        self.endings.iter().any(|ending| name.ends_with(ending))
    }

    /// The file is named like this format and does not start like it.
    fn refuse(&self, path: &Path) -> ReadError {
        ReadError::Format {
            path: path.to_owned(),
            format: self.name,
            reason: "its first bytes are not those of this format".to_owned(),
            remedy: self.remedy,
        }
    }
}

/// The bytes by which formats are told apart.
fn start_of(path: &Path) -> Result<Vec<u8>, ReadError> {
    /// MATLAB 7.3 has a header of 512 bytes before its own mark.
    const TOLD_APART: u64 = 520;
    let io_error = |source| ReadError::Io { path: path.to_owned(), source };
    let mut start = Vec::new();
    let file = File::open(path).map_err(io_error)?;
    file.take(TOLD_APART).read_to_end(&mut start).map_err(io_error)?;
    Ok(start)
}

/// Whether a file's name, in lower case, is that of a log.
pub(super) fn is_named_like_a_log(name: &str) -> bool {
    FORMATS.iter().any(|format| format.ends(name))
}

/// How the names of logs end, for messages.
pub(super) fn endings() -> String {
    let endings: Vec<_> = FORMATS.iter().flat_map(|format| format.endings).copied().collect();
    endings.join(", ")
}
