//! A CSV file as columns of numbers: header, delimiter, cells, row numbers.
//!
//! Knows nothing of joints beyond "this column is wanted": what the columns mean is
//! decided in [`super::layout`].

use std::collections::HashSet;
use std::fs::File;
use std::io::{self, Cursor, Read};
use std::path::{Path, PathBuf};

use sha2::{Digest as _, Sha256};

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

    pub(super) fn is_named(&self, wanted: &str) -> bool {
        self.name == wanted || self.text == wanted
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
    ending: LineEnding,
    reader: csv::Reader<Bytes>,
}

impl OpenTable {
    /// Opens the log and reads its header.
    pub(super) fn open(path: &Path) -> Result<Self, ReadError> {
        let io_error = |source| ReadError::Io { path: path.to_owned(), source };
        let mut file = File::open(path).map_err(io_error)?;
        let mut start = Vec::new();
        file.by_ref().take(SNIFFED_BYTES).read_to_end(&mut start).map_err(io_error)?;
        let delimiter = sniff_delimiter(&start);
        let ending = LineEnding::sniff(&start);
        let mut reader = csv::ReaderBuilder::new()
            .delimiter(delimiter)
            .comment(Some(b'#'))
            .flexible(true)
            .has_headers(false)
            .from_reader(Hashing::new(Cursor::new(start).chain(file)).chain(ending.bytes()));
        let mut record = csv::StringRecord::new();
        let csv_error = |source| ReadError::Csv { path: path.to_owned(), source };
        if !reader.read_record(&mut record).map_err(csv_error)? {
            return Err(ReadError::Empty { path: path.to_owned() });
        }
        let header_row = row_just_read(&reader, ending);
        let headers = record.iter().map(Header::parse).collect();
        let table = Self { path: path.to_owned(), headers, header_row, ending, reader };
        table.check_names()?;
        Ok(table)
    }

    fn check_names(&self) -> Result<(), ReadError> {
        let mut names: Vec<_> = self.headers.iter().map(|header| &header.name).collect();
        names.sort();
        match names.windows(2).find(|pair| pair[0] == pair[1] && !pair[0].is_empty()) {
            Some(pair) => Err(ReadError::DuplicateColumn {
                path: self.path.clone(),
                row: self.header_row,
                column: pair[0].clone(),
            }),
            None => Ok(()),
        }
    }

    /// The names of all columns, for messages.
    pub(super) fn names(&self) -> String {
        let names: Vec<_> = self.headers.iter().map(|header| header.text.as_str()).collect();
        names.join(", ")
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
            let row = row_just_read(&self.reader, self.ending);
            self.check_width(row, record.len())?;
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

    fn check_width(&self, row: u64, found: usize) -> Result<(), ReadError> {
        let expected = self.headers.len();
        if found == expected {
            return Ok(());
        }
        Err(ReadError::UnequalRow { path: self.path.clone(), row, found, expected })
    }
}

/// Bytes that are looked at to tell the delimiter.
const SNIFFED_BYTES: u64 = 64 * 1024;

/// The delimiter that is most frequent in the first line that is no comment.
fn sniff_delimiter(start: &[u8]) -> u8 {
    let line = start
        .split(|&byte| byte == b'\n')
        .find(|line| !line.starts_with(b"#") && !line.trim_ascii().is_empty())
        .unwrap_or_default();
    let pieces = |delimiter: u8| line.split(|&byte| byte == delimiter).count();
    // The comma is last, so that it wins when nothing is found.
    [b'\t', b';', b','].into_iter().max_by_key(|&delimiter| pieces(delimiter)).unwrap_or(b',')
}

/// Line of the record that was read last.
///
/// A record's own position is that of the comment lines before it, so the line is
/// counted back from where the reader stands now.
fn row_just_read<R: Read>(reader: &csv::Reader<R>, ending: LineEnding) -> u64 {
    let line = reader.position().line();
    match ending {
        LineEnding::Lf => line.saturating_sub(1).max(1),
        // The parser has only taken the first half and is still on the line.
        LineEnding::CrLf => line,
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum LineEnding {
    Lf,
    CrLf,
}

impl LineEnding {
    fn bytes(self) -> &'static [u8] {
        match self {
            Self::Lf => b"\n",
            Self::CrLf => b"\r\n",
        }
    }

    fn sniff(start: &[u8]) -> Self {
        let first = start.iter().position(|&byte| byte == b'\n');
        match first.and_then(|index| start.get(index.wrapping_sub(1))) {
            Some(b'\r') => Self::CrLf,
            _ => Self::Lf,
        }
    }
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
        if let Some(run) = self.runs.last_mut().filter(|run| run.label.as_bytes() == cell) {
            run.end = self.rows;
            return Ok(());
        }
        let label = String::from_utf8_lossy(cell).into_owned();
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
}

impl<R: Read> Hashing<R> {
    fn new(inner: R) -> Self {
        Self { inner, hasher: Sha256::new(), bytes: 0 }
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
        self.hasher.update(buffer.get(..count).unwrap_or_default());
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
        for text in [text.to_owned(), format!("{text}\n"), text.replace('\n', "\r\n")] {
            std::fs::write(&path, &text).unwrap();
            let open = OpenTable::open(&path).unwrap();
            assert_eq!(open.header_row, 2, "{text:?}");
            let table = open.read(&[0, 1], None).unwrap();
            assert_eq!(table.rows, [3, 6, 7], "{text:?}");
            assert_eq!(table.columns[1].error, Some((7, BadCell::Text("x".to_owned()))));
        }
    }
}
