//! The list of formats, and what opens a log.

use std::path::Path;

use super::csv;
use super::fence;
use super::first_bytes::{is_gzip, is_matlab, start_of};
#[cfg(feature = "mat")]
use super::mat;
#[cfg(feature = "mcap")]
use super::mcap;
#[cfg(feature = "parquet")]
use super::parquet;
#[cfg(feature = "xlsx")]
use super::xlsx;
use crate::experiment::error::{ReadError, ReadErrorKind};
use crate::experiment::memory::Budget;
use crate::experiment::table::{OpenTable, Opened};

/// Memory of what is said of a column: of a million 1.9 GB were measured, with names of ten letters.
const COLUMN_SIZE: u64 = 2000;

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
    open: fn(&Path, &Budget) -> Result<Opened, ReadError>,
}

/// All formats that are read. The last one is text, which any bytes may be.
const FORMATS: [Format; 5] = [
    Format {
        name: "Parquet",
        endings: &[".parquet", ".pq"],
        starts: |start| start.starts_with(b"PAR1"),
        remedy: "write it again, or rename it if it is of another format",
        #[cfg(feature = "parquet")]
        open: parquet::open,
        #[cfg(not(feature = "parquet"))]
        open: |_, _| Err(left_out("Parquet", "parquet")),
    },
    Format {
        name: "MATLAB",
        endings: &[".mat"],
        starts: is_matlab,
        remedy: "save it with `save -v7`, or rename it if it is of another format",
        #[cfg(feature = "mat")]
        open: mat::open,
        #[cfg(not(feature = "mat"))]
        open: |_, _| Err(left_out("MATLAB", "mat")),
    },
    Format {
        name: "MCAP",
        endings: &[".mcap"],
        starts: |start| start.starts_with(b"\x89MCAP0\r\n"),
        remedy: "record it again, or rename it if it is of another format",
        #[cfg(feature = "mcap")]
        open: mcap::open,
        #[cfg(not(feature = "mcap"))]
        open: |_, _| Err(left_out("MCAP", "mcap")),
    },
    Format {
        name: "XLSX",
        endings: &[".xlsx", ".xlsm"],
        starts: |start| start.starts_with(b"PK\x03\x04"),
        remedy: "save it again as .xlsx, or as CSV",
        #[cfg(feature = "xlsx")]
        open: |path, budget| workbook(path, xlsx::open(path, budget)),
        #[cfg(not(feature = "xlsx"))]
        open: |path, _| workbook(path, Err(left_out("XLSX", "xlsx"))),
    },
    Format {
        name: "CSV",
        endings: &[".csv", ".tsv", ".txt", ".lvm", ".csv.gz", ".tsv.gz", ".txt.gz"],
        starts: |_| true,
        remedy: "write it as text",
        open: csv::open,
    },
];

/// Files that are not read: their first bytes, what one is, and what to do with it.
type Foreign = (&'static [&'static [u8]], &'static str, &'static str);

const FOREIGN: [Foreign; 11] = [
    (&[b"RRF"], "it is a recording of Rerun", "open it with `rerun FILE`"),
    (
        &[b"<!doctype html", b"<!DOCTYPE html", b"<!DOCTYPE HTML", b"<html", b"<HTML"],
        "it is a web page",
        "open it in a browser",
    ),
    (
        &[b"schema = \"tauscope/model/"],
        "it is a model",
        "give it with `--model`, after the log: `tauscope compare LOG --model FILE`",
    ),
    (
        &[b"SQLite format 3\0"],
        "it is an SQLite database, as rosbag2 writes",
        "convert it to MCAP: `ros2 bag convert -i BAG -o out.yaml`, with \
         `storage_id: mcap` in out.yaml",
    ),
    (
        &[b"#ROSBAG V"],
        "it is a recording of ROS 1",
        "convert it to MCAP: `mcap convert in.bag out.mcap`",
    ),
    (
        &[b"\xd0\xcf\x11\xe0"],
        "it is a file of an old spreadsheet program",
        "save it as .xlsx, or as CSV",
    ),
    (
        &[b"ARROW1", b"FEA1"],
        "it is a Feather file of Arrow",
        "write it as Parquet: `pandas.read_feather(IN).to_parquet(OUT)`",
    ),
    (&[b"TDSm"], "it is a TDMS file of LabVIEW", "export it as CSV, or convert it with npTDMS"),
    (
        &[b"MDF     "],
        "it is a measurement data file (MDF)",
        "export it as CSV, Parquet or .mat, with its own tool or asammdf",
    ),
    (&[b"ULog\x01\x12\x35"], "it is a ULog file of PX4", "convert it to CSV with `ulog2csv`"),
    (
        &[b"\x28\xb5\x2f\xfd", b"\xfd7zXZ\0", b"BZh", b"\x04\x22\x4d\x18", b"7z\xbc\xaf\x27\x1c"],
        "it is packed by zstd, xz, bzip2, lz4 or 7-Zip",
        "unpack it first; of packed files those of gzip are read, and chunks of MCAP",
    ),
];

/// What was `opened` as a workbook. That is a ZIP archive, as others are that hold logs.
fn workbook(path: &Path, opened: Result<Opened, ReadError>) -> Result<Opened, ReadError> {
    let name = path.file_name().unwrap_or_default().to_string_lossy().to_lowercase();
    let is_named = FORMATS.iter().any(|format| format.name == "XLSX" && format.ends(&name));
    opened.map_err(|error| match error.kind {
        ReadErrorKind::Format if !is_named => {
            let remedy = "unpack it first, or call it .xlsx if it is a workbook";
            ReadError::format("a log", "it is a ZIP archive", remedy)
        }
        _ => error,
    })
}

#[cfg(not(all(feature = "mat", feature = "mcap", feature = "parquet", feature = "xlsx")))]
fn left_out(format: &str, feature: &str) -> ReadError {
    let text =
        format!("{format} is not in this build of tauscope; build it with `--features {feature}`");
    ReadError::new(ReadErrorKind::Format, text)
}

/// Opens a log. Its first bytes identify the format, so that a name may be anything; but a name
/// that promises a format is kept to it.
pub(in crate::experiment) fn open(path: &Path, budget: Budget) -> Result<OpenTable, ReadError> {
    let opened = open_any(path, &budget)?;
    budget.check((opened.0.headers.len() as u64).saturating_mul(COLUMN_SIZE))?;
    Ok(OpenTable::new(opened, budget))
}

fn open_any(path: &Path, budget: &Budget) -> Result<Opened, ReadError> {
    // A pipe gives its bytes once: it is taken for text.
    if path.metadata().is_ok_and(|metadata| !metadata.is_file()) {
        return csv::open(path, budget);
    }
    let start = start_of(path)?;
    if start.is_empty() {
        return Err(ReadError::empty());
    }
    if let Some((_, what, remedy)) = foreign(&start) {
        return Err(ReadError::format("a log", what, remedy));
    }
    let name = path.file_name().unwrap_or_default().to_string_lossy().to_lowercase();
    let named = FORMATS.iter().find(|format| format.ends(&name));
    let binary = FORMATS.iter().find(|format| !format.is_text() && (format.starts)(&start));
    if let Some(found) = binary {
        return fence::open(found.name, || (found.open)(path, budget));
    }
    match named.filter(|named| !(named.starts)(&start)) {
        Some(named) => {
            let reason = "its first bytes are not those of this format";
            Err(ReadError::format(named.name, reason, named.remedy))
        }
        // Text is read by code that does not panic: if it did, that would be a fault to see.
        None => csv::open(path, budget),
    }
}

/// The format of a file that begins like this, where it is one that is not read.
fn foreign(start: &[u8]) -> Option<&'static Foreign> {
    let start = start.trim_ascii_start();
    FOREIGN.iter().find(|(marks, ..)| marks.iter().any(|mark| start.starts_with(mark)))
}

/// Whether the log at `path` is a text, or will be one: it has whole lines while it grows.
pub(crate) fn is_text(path: &Path) -> bool {
    let name = path.file_name().unwrap_or_default().to_string_lossy().to_lowercase();
    let start = start_of(path).unwrap_or_default();
    let is_other =
        |format: &Format| !format.is_text() && (format.ends(&name) || (format.starts)(&start));
    !is_gzip(&start) && foreign(&start).is_none() && !FORMATS.iter().any(is_other)
}

impl Format {
    /// Whether any bytes may be of this format, even none.
    fn is_text(&self) -> bool {
        (self.starts)(b"")
    }

    fn ends(&self, name: &str) -> bool {
        self.endings.iter().any(|ending| name.ends_with(ending))
    }
}

/// Whether a file's name, in lower case, is that of a log.
pub(crate) fn is_named_like_a_log(name: &str) -> bool {
    FORMATS.iter().any(|format| format.ends(name))
}

/// The formats that are read, for help: text first.
pub(crate) fn format_names() -> String {
    FORMATS.iter().rev().map(|format| format.name).collect::<Vec<_>>().join(", ")
}

/// How the names of logs end, for messages.
pub(in crate::experiment) fn endings() -> String {
    let endings: Vec<_> = FORMATS.iter().flat_map(|format| format.endings).copied().collect();
    endings.join(", ")
}
