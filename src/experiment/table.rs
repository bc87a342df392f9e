//! A CSV file as columns of numbers: header, delimiter, cells, row numbers.
//!
//! Knows nothing of joints beyond "this column is wanted": what the columns mean is
//! decided in [`super::layout`].

use std::collections::{HashSet, VecDeque};
use std::fs::File;
use std::io::{self, Cursor, Read};
use std::path::{Path, PathBuf};

use sha2::{Digest as _, Sha256};

use super::error::listed;
use super::{ReadError, Source};

/// Name and unit of a column.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Header {
    pub(super) name: String,
    pub(super) unit: Option<String>,
    /// The cell as it stands in the file.
    pub(super) text: String,
}

impl Header {
    /// Splits `boom.output [deg]` into a name and a unit.
    fn parse(cell: &str) -> Self {
        let text = cell.trim();
        let split = text.strip_suffix(']').and_then(|rest| rest.rsplit_once('['));
        let (name, unit) = match split {
            Some((name, unit)) => (name.trim(), Some(unit.trim().to_owned())),
            None => (text, None),
        };
        Self { name: name.to_owned(), unit, text: text.to_owned() }
    }
}

/// A file whose first bytes were looked at, and a line ending behind its last line,
/// so that every line has one and lines can be counted.
type Bytes = io::Chain<Hashing<io::Chain<Cursor<Vec<u8>>, File>>, &'static [u8]>;

/// The first row of a log, and what follows still unread.
pub(super) struct OpenTable {
    pub(super) path: PathBuf,
    pub(super) headers: Vec<Header>,
    /// Line of the header in the file.
    pub(super) header_row: u64,
    reader: csv::Reader<Bytes>,
}

impl OpenTable {
    /// Opens the log and reads its header.
    pub(super) fn open(path: &Path) -> Result<Self, ReadError> {
        let io_error = |source| ReadError::Io { path: path.to_owned(), source };
        let mut file = File::open(path).map_err(io_error)?;
        let mut start = Vec::new();
        file.by_ref().take(SNIFFED_BYTES).read_to_end(&mut start).map_err(io_error)?;
        let mut reader = csv::ReaderBuilder::new()
            .delimiter(sniff_delimiter(&start))
            .comment(Some(b'#'))
            .flexible(true)
            .has_headers(false)
            .from_reader(Hashing::new(Cursor::new(start).chain(file)).chain(&b"\n"[..]));
        let mut record = csv::ByteRecord::new();
        let csv_error = |source| ReadError::Csv { path: path.to_owned(), source };
        if !reader.read_byte_record(&mut record).map_err(csv_error)? {
            return Err(ReadError::Empty { path: path.to_owned() });
        }
        let header_row = place_just_read(&mut reader, &record).row;
        let text = |(cell, column): (&[u8], usize)| {
            let not_utf8 =
                |_| ReadError::NotUtf8 { path: path.to_owned(), row: header_row, column };
            std::str::from_utf8(cell).map(Header::parse).map_err(not_utf8)
        };
        let headers = record.iter().zip(1..).map(text).collect::<Result<_, _>>()?;
        Ok(Self { path: path.to_owned(), headers, header_row, reader })
    }

    /// The names of all columns, for messages.
    pub(super) fn names(&self) -> String {
        listed(self.headers.iter().map(|header| header.text.as_str()))
    }

    /// Reads the columns `numeric` as numbers and `label` as text.
    ///
    /// # Errors
    /// What is wrong with the file or a row. A bad cell spoils its column only: see
    /// [`Column::error`].
    pub(super) fn read(
        mut self,
        numeric: &[usize],
        label: Option<usize>,
    ) -> Result<Table, ReadError> {
        let mut columns: Vec<_> = numeric.iter().map(|&index| Column::new(index)).collect();
        let mut labels = label.map(Labels::new);
        let mut rows = Vec::new();
        let mut record = csv::ByteRecord::new();
        loop {
            let more = self.reader.read_byte_record(&mut record);
            if !more.map_err(|source| ReadError::Csv { path: self.path.clone(), source })? {
                break;
            }
            let Place { row, lines } = place_just_read(&mut self.reader, &record);
            self.check_width(row, record.len(), lines)?;
            rows.push(row);
            for column in &mut columns {
                column.push(&record, row);
            }
            if let Some(labels) = &mut labels {
                labels.push(&record, row, &self.path)?;
            }
        }
        if rows.is_empty() {
            return Err(ReadError::HeaderOnly { path: self.path });
        }
        let source = self.reader.into_inner().into_inner().0.finish(&self.path)?;
        Ok(Table { source, rows, columns, trials: labels.map_or_else(Vec::new, |l| l.runs) })
    }

    fn check_width(&self, row: u64, found: usize, lines: u64) -> Result<(), ReadError> {
        let expected = self.headers.len();
        if found == expected {
            return Ok(());
        }
        Err(ReadError::UnequalRow { path: self.path.clone(), row, found, expected, lines })
    }
}

/// Bytes that are looked at to tell the delimiter.
const SNIFFED_BYTES: u64 = 64 * 1024;

/// The delimiter that is most frequent in the first line that is no comment, units and
/// quoted cells left out.
fn sniff_delimiter(start: &[u8]) -> u8 {
    let text = start.strip_prefix(b"\xef\xbb\xbf").unwrap_or(start);
    let line = text
        .split(|&byte| byte == b'\n')
        .find(|line| !line.starts_with(b"#") && !line.trim_ascii().is_empty())
        .unwrap_or_default();
    let mut enclosed = None;
    let mut counts = [(b'\t', 0), (b';', 0), (b',', 0)];
    for &byte in line {
        enclosed = match (enclosed, byte) {
            (None, b'[') => Some(b']'),
            (None, b'"') => Some(b'"'),
            (Some(end), byte) if end == byte => None,
            (enclosed, _) => enclosed,
        };
        for (delimiter, count) in &mut counts {
            *count += usize::from(enclosed.is_none() && *delimiter == byte);
        }
    }
    // The comma is last, so that it wins when nothing is found.
    counts.into_iter().max_by_key(|(_, count)| *count).map_or(b',', |(delimiter, _)| delimiter)
}

/// Where a record stands in the file.
struct Place {
    /// Its first line, counted from 1.
    row: u64,
    /// Lines it takes up.
    lines: u64,
}

/// The place of the record that was read last.
///
/// The parser's own count is that of the comment lines before it, and takes "\r\n" in
/// two halves; so the lines before the end of the record are counted here.
fn place_just_read(reader: &mut csv::Reader<Bytes>, record: &csv::ByteRecord) -> Place {
    let end = reader.position().byte().saturating_sub(1);
    let file = reader.get_mut().get_mut().0;
    let before_end = file.lines_before(end);
    // In a quotation that is never closed, the line end behind the file is one of its own.
    let text = record.as_slice();
    let text = if end == file.bytes { text.strip_suffix(b"\n").unwrap_or(text) } else { text };
    let inside = text.iter().filter(|&&byte| byte == b'\n').fold(0, |count, _| count + 1);
    Place { row: before_end + 1 - inside, lines: inside + 1 }
}

/// The columns that were asked for.
pub(super) struct Table {
    pub(super) source: Source,
    /// Line of the file of each row.
    pub(super) rows: Vec<u64>,
    pub(super) columns: Vec<Column>,
    /// Runs of rows with the same label; empty without a label column.
    pub(super) trials: Vec<TrialRows>,
}

/// A run of rows with the same label.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct TrialRows {
    pub(super) label: String,
    pub(super) start: usize,
    pub(super) end: usize,
}

/// One column of numbers; a missing value is NaN.
pub(super) struct Column {
    index: usize,
    pub(super) values: Vec<f64>,
    /// The first bad cell and its row. The values end before it.
    pub(super) error: Option<(u64, BadCell)>,
}

impl Column {
    fn new(index: usize) -> Self {
        Self { index, values: Vec::new(), error: None }
    }

    fn push(&mut self, record: &csv::ByteRecord, row: u64) {
        if self.error.is_some() {
            return;
        }
        match parse_cell(record.get(self.index).unwrap_or_default().trim_ascii()) {
            Ok(value) => self.values.push(value),
            Err(bad) => self.error = Some((row, bad)),
        }
    }
}

/// A cell that is neither a finite number nor missing.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum BadCell {
    Text(String),
    Infinite,
}

/// The number in a cell; NaN where there is none.
fn parse_cell(cell: &[u8]) -> Result<f64, BadCell> {
    if cell.is_empty() {
        return Ok(f64::NAN);
    }
    let number = std::str::from_utf8(cell).ok().and_then(|text| text.parse::<f64>().ok());
    match number {
        Some(value) if value.is_infinite() => Err(BadCell::Infinite),
        Some(value) => Ok(value),
        None => Err(BadCell::Text(String::from_utf8_lossy(cell).into_owned())),
    }
}

struct Labels {
    index: usize,
    runs: Vec<TrialRows>,
    seen: HashSet<String>,
    rows: usize,
}

impl Labels {
    fn new(index: usize) -> Self {
        Self { index, runs: Vec::new(), seen: HashSet::new(), rows: 0 }
    }

    fn push(&mut self, record: &csv::ByteRecord, row: u64, path: &Path) -> Result<(), ReadError> {
        let cell = record.get(self.index).unwrap_or_default().trim_ascii();
        let index = self.rows;
        self.rows += 1;
        let label = String::from_utf8_lossy(cell);
        if let Some(run) = self.runs.last_mut().filter(|run| run.label == label) {
            run.end = self.rows;
            return Ok(());
        }
        let label = label.into_owned();
        if !self.seen.insert(label.clone()) {
            return Err(ReadError::TrialNotContiguous { path: path.to_owned(), row, trial: label });
        }
        self.runs.push(TrialRows { label, start: index, end: self.rows });
        Ok(())
    }
}

/// Passes bytes on and hashes them on the way, so that a log is read once.
struct Hashing<R> {
    inner: R,
    hasher: Sha256,
    bytes: u64,
    /// Places of the line ends that no record has passed yet.
    line_ends: VecDeque<u64>,
    lines_passed: u64,
}

impl<R: Read> Hashing<R> {
    fn new(inner: R) -> Self {
        let line_ends = VecDeque::new();
        Self { inner, hasher: Sha256::new(), bytes: 0, line_ends, lines_passed: 0 }
    }

    /// Number of line ends before the byte `place`, which never goes back.
    fn lines_before(&mut self, place: u64) -> u64 {
        while self.line_ends.pop_front_if(|end| *end < place).is_some() {
            self.lines_passed += 1;
        }
        self.lines_passed
    }

    /// Reads what is left and gives the hash of all of it.
    fn finish(mut self, path: &Path) -> Result<Source, ReadError> {
        io::copy(&mut self, &mut io::sink())
            .map_err(|source| ReadError::Io { path: path.to_owned(), source })?;
        let sha256 = base16ct::lower::encode_string(&self.hasher.finalize());
        Ok(Source { path: path.to_owned(), sha256, bytes: self.bytes })
    }
}

impl<R: Read> Read for Hashing<R> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let count = self.inner.read(buffer)?;
        let new = buffer.get(..count).unwrap_or_default();
        self.hasher.update(new);
        let ends = new.iter().zip(self.bytes..).filter(|(byte, _)| **byte == b'\n');
        self.line_ends.extend(ends.map(|(_, place)| place));
        self.bytes += count as u64;
        Ok(count)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_unit_stands_in_brackets() {
        let header = Header::parse(" boom.output [deg/s] ");
        assert_eq!(header.name, "boom.output");
        assert_eq!(header.unit.as_deref(), Some("deg/s"));
        assert_eq!(Header::parse("boom.output").unit, None);
    }

    #[test]
    fn the_delimiter_is_told_from_the_header() {
        assert_eq!(sniff_delimiter(b"# a, b, c\n\nt;a.input;a.output\n1;2;3"), b';');
        assert_eq!(sniff_delimiter(b"t\ta,b\tc"), b'\t');
        assert_eq!(sniff_delimiter(b"single"), b',');
        assert_eq!(sniff_delimiter(b"\xef\xbb\xbf# a, b, c\nt;x;y"), b';');
        assert_eq!(sniff_delimiter(b"t,x [a;b;c]"), b',');
    }

    #[test]
    fn a_cell_is_a_number_or_missing_or_wrong() {
        assert_eq!(parse_cell(b"-1.5e3"), Ok(-1500.0));
        assert!(parse_cell(b"").unwrap().is_nan());
        assert!(parse_cell(b"NaN").unwrap().is_nan());
        assert_eq!(parse_cell(b"inf"), Err(BadCell::Infinite));
        assert_eq!(parse_cell(b"1e999"), Err(BadCell::Infinite));
        assert_eq!(parse_cell(b"n/a"), Err(BadCell::Text("n/a".to_owned())));
    }

    #[test]
    fn rows_are_the_lines_of_the_file() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("log.csv");
        let text = "# made by hand\nt,a\n0,1\n# pause\n\n1,2\n2,x";
        let mixed = text.replacen('\n', "\r\n", 2);
        for text in [text.to_owned(), format!("{text}\n"), text.replace('\n', "\r\n"), mixed] {
            std::fs::write(&path, &text).unwrap();
            let open = OpenTable::open(&path).unwrap();
            assert_eq!(open.header_row, 2, "{text:?}");
            let table = open.read(&[0, 1], None).unwrap();
            assert_eq!(table.rows, [3, 6, 7], "{text:?}");
            assert_eq!(table.columns[1].error, Some((7, BadCell::Text("x".to_owned()))));
        }
    }
}
