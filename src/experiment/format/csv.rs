//! Tables of text: delimiter, cells, line numbers.

use std::collections::VecDeque;
use std::io::{self, Read};
use std::ops::ControlFlow;
use std::path::Path;

use super::spelling::{
    DecimalMarks, Spelling, are_units, bare_unit, is_over_lines, is_remark, parse_cell, parse_time,
};
use super::text::{Bytes, SNIFFED_BYTES};
use crate::experiment::error::ReadError;
use crate::experiment::memory::Budget;
use crate::experiment::names::shown;
use crate::experiment::source::Source;
use crate::experiment::table::{
    Column, Head, Header, Labels, OpenTable, RowNumbers, Rows, Table, Wanted,
};

/// Bytes, and a line ending behind the last line, so that every line has one and lines can
/// be counted.
type Lines<R> = io::Chain<LineEnds<R>, &'static [u8]>;

/// Bytes of a row, with comments and blank lines before it: what is longer is no table of text,
/// or a quotation that is never closed.
const LONGEST_ROW: u64 = 1 << 24;

/// Lines of the same.
const MOST_LINES: usize = 1 << 20;

/// Memory that is taken for a byte of a row while it grows, if all cells are empty (measured: 26).
const ROW_SIZE: u64 = 32;

/// Rows of words that may stand below a table.
const MOST_REMARKS: usize = 20;

/// Memory of a number: itself, and what its vector has to spare.
const NUMBER_SIZE: usize = 2 * size_of::<f64>();

/// What follows the header, still unread.
struct Unread {
    reader: csv::Reader<Lines<Bytes>>,
    delimiter: u8,
    /// The first row, where it had to be looked at.
    first: Option<(csv::ByteRecord, Place)>,
    budget: Budget,
}

/// Opens the log and reads its header.
pub(super) fn open(path: &Path, budget: Budget) -> Result<OpenTable, ReadError> {
    let (bytes, start) = Bytes::open(path)?;
    table(path, bytes, &start, budget)
}

/// Reads the header of a text that begins with `start`.
pub(super) fn table(
    path: &Path,
    mut bytes: Bytes,
    start: &[u8],
    budget: Budget,
) -> Result<OpenTable, ReadError> {
    let io_error = |source| ReadError::Io { path: path.to_owned(), source };
    let Spelling { delimiter, preamble: (before, lines) } = Spelling::of(start);
    io::copy(&mut bytes.by_ref().take(before as u64), &mut io::sink()).map_err(io_error)?;
    let lines = LineEnds::after(bytes, lines).within(&budget);
    let mut reader = reader(delimiter, lines);
    let mut record = csv::ByteRecord::new();
    if !next(&mut reader, &mut record, path)? {
        return Err(ReadError::Empty { path: path.to_owned() });
    }
    check_header_size(path, record.len(), &budget)?;
    let mut head = head(path, &record, place_just_read(&mut reader, &record).row)?;
    let mut first = None;
    if next(&mut reader, &mut record, path)? {
        check_parted(&head, &record)?;
        if are_units(&record) {
            add_units(&mut head, &record);
        } else {
            let place = place_just_read(&mut reader, &record);
            first = Some((record, place));
        }
    }
    Ok(OpenTable { head, rows: Box::new(Unread { reader, delimiter, first, budget }) })
}

/// Refuses a header of more cells than a log has columns, which a row of commas is, too.
fn check_header_size(path: &Path, cells: usize, budget: &Budget) -> Result<(), ReadError> {
    /// Ten times as many as a large plant has signals (chosen).
    const MOST: usize = 1_000_000;
    /// Memory of a name, and of what is looked for in its column (measured: 180 to 250 bytes).
    const HEADER_SIZE: usize = 256;
    if cells > MOST {
        return Err(ReadError::Format {
            path: path.to_owned(),
            format: "a table of text",
            reason: format!("its header has {cells} cells, and {MOST} are the most"),
            remedy: "leave out columns",
        });
    }
    budget.take_values(cells, HEADER_SIZE).map_err(|error| error.refuse(path))
}

/// Refuses a table whose cells are parted by blanks, which would be one column.
fn check_parted(head: &Head, first: &csv::ByteRecord) -> Result<(), ReadError> {
    let words = |cell: &[u8]| String::from_utf8_lossy(cell).split_whitespace().count();
    let [header] = head.headers.as_slice() else { return Ok(()) };
    let (names, values) = (words(header.text.as_bytes()), first.get(0).map_or(0, words));
    if first.len() > 1 || names < 2 || names != values {
        return Ok(());
    }
    Err(ReadError::Format {
        path: head.path.clone(),
        format: "a table of text",
        reason: format!("its {names} cells are parted by blanks"),
        remedy: "part them by commas, semicolons or tabs",
    })
}

/// The units of a row below the header, where the header has none.
fn add_units(head: &mut Head, record: &csv::ByteRecord) {
    for (header, cell) in head.headers.iter_mut().zip(record) {
        let unit = bare_unit(&String::from_utf8_lossy(cell));
        if header.unit.is_none() && !unit.is_empty() {
            header.unit = Some(unit);
        }
    }
}

fn reader<R: Read>(delimiter: u8, lines: LineEnds<R>) -> csv::Reader<Lines<R>> {
    csv::ReaderBuilder::new()
        .delimiter(delimiter)
        .comment(Some(b'#'))
        .flexible(true)
        .has_headers(false)
        .from_reader(lines.chain(&b"\n"[..]))
}

/// What the header says, which stands on the line `header_row`.
fn head(path: &Path, record: &csv::ByteRecord, header_row: u64) -> Result<Head, ReadError> {
    let text = |(cell, column): (&[u8], usize)| {
        let not_utf8 = |_| ReadError::NotUtf8 { path: path.to_owned(), row: header_row, column };
        std::str::from_utf8(cell).map(Header::parse).map_err(not_utf8)
    };
    let headers = record.iter().zip(1..).map(text).collect::<Result<_, _>>()?;
    Ok(Head { path: path.to_owned(), headers, header_row })
}

/// Whether there is one more row, which is then in `record`.
fn next<R: Read>(
    reader: &mut csv::Reader<R>,
    record: &mut csv::ByteRecord,
    path: &Path,
) -> Result<bool, ReadError> {
    let more = reader.read_byte_record(record);
    more.map_err(|source| ReadError::Csv { path: path.to_owned(), source })
}

impl Rows for Unread {
    fn read(mut self: Box<Self>, wanted: &Wanted<'_>) -> Result<Table, ReadError> {
        let mut gathered = Gathered::new(wanted, self.delimiter, self.budget.rest());
        if let Some((record, place)) = self.first.take() {
            gathered.take(&record, &place, wanted)?;
        }
        let mut record = csv::ByteRecord::new();
        let mut remarks: Vec<(csv::ByteRecord, Place)> = Vec::new();
        while next(&mut self.reader, &mut record, wanted.path())? {
            let place = place_just_read(&mut self.reader, &record);
            if remarks.len() < MOST_REMARKS && gathered.may_end_with(&record) {
                remarks.push((record.clone(), place));
                continue;
            }
            for (remark, place) in remarks.drain(..) {
                gathered.take(&remark, &place, wanted)?;
            }
            if let Err(error) = gathered.take(&record, &place, wanted) {
                if !self.is_cut_off(&record, wanted)? {
                    return Err(error);
                }
                gathered.table.notes.push(format!(
                    "{}: the last row, {}, is cut off and left out",
                    wanted.path().display(),
                    place.row
                ));
            }
        }
        gathered.leave_out(&remarks, wanted);
        let bytes = self.reader.into_inner().into_inner().0.inner;
        gathered.table_of(bytes.finish(wanted.path())?);
        Ok(gathered.table)
    }
}

impl Unread {
    /// Whether the row just read is the last one, and was not written to its end.
    fn is_cut_off(
        &mut self,
        record: &csv::ByteRecord,
        wanted: &Wanted<'_>,
    ) -> Result<bool, ReadError> {
        let is_short = record.len() < wanted.head.headers.len() && !is_over_lines(record);
        let is_last =
            is_short && !next(&mut self.reader, &mut csv::ByteRecord::new(), wanted.path())?;
        Ok(is_last && self.reader.get_mut().get_mut().0.last != b'\n')
    }
}

/// Rows as they come.
struct Gathered {
    delimiter: u8,
    marks: DecimalMarks,
    table: Table,
    labels: Option<Labels>,
    budget: Budget,
}

impl Gathered {
    fn new(wanted: &Wanted<'_>, delimiter: u8, budget: Budget) -> Self {
        let path = wanted.path().to_owned();
        let table = Table {
            source: Source { path, sha256: String::new(), bytes: 0 },
            rows: RowNumbers::default(),
            columns: vec![Column::default(); wanted.numeric.len()],
            trials: Vec::new(),
            notes: Vec::new(),
        };
        let labels = wanted.label.map(|_| Labels::default());
        Self { delimiter, marks: DecimalMarks::default(), table, labels, budget }
    }

    fn take(
        &mut self,
        record: &csv::ByteRecord,
        place: &Place,
        wanted: &Wanted<'_>,
    ) -> Result<(), ReadError> {
        check_width(wanted, place, record.len())?;
        let row = place.row;
        let cell = |index: usize| record.get(index).unwrap_or_default().trim_ascii();
        if self.table.rows.is_empty() && are_units(record) {
            return Ok(());
        }
        let label = wanted.label.map_or(&b""[..], cell);
        let size = wanted.numeric.len() * NUMBER_SIZE + label.len();
        self.budget.take_values(1, size).map_err(|error| error.refuse(wanted.path()))?;
        self.table.rows.push(row);
        for (column, index) in self.table.columns.iter_mut().zip(wanted.numeric) {
            let is_time = wanted.time == Some(*index);
            let parse = if is_time { parse_time } else { parse_cell };
            let parsed = parse(cell(*index), self.delimiter);
            column.push(self.marks.agreed(cell(*index), self.delimiter, parsed), row);
        }
        if let Some(labels) = &mut self.labels {
            let memory = (wanted.path(), &self.budget);
            labels.push(&String::from_utf8_lossy(label), row, memory)?;
        }
        Ok(())
    }

    /// Whether a row may be words below the table.
    fn may_end_with(&self, record: &csv::ByteRecord) -> bool {
        !self.table.rows.is_empty() && is_remark(record, self.delimiter)
    }

    /// Says that words below the table are no rows of it.
    fn leave_out(&mut self, remarks: &[(csv::ByteRecord, Place)], wanted: &Wanted<'_>) {
        let Some((first, place)) = remarks.first() else { return };
        let says = first.iter().map(String::from_utf8_lossy).find(|cell| !cell.trim().is_empty());
        let rows = match remarks.len() {
            1 => format!("the last row, {}, is left out: it holds", place.row),
            count => {
                format!("the last {count} rows, from {} on, are left out: they hold", place.row)
            }
        };
        self.table.notes.push(format!(
            "{}: {rows} no number and no time (`{}`)",
            wanted.path().display(),
            shown(says.unwrap_or_default().trim())
        ));
    }

    /// What came so far, of this much of the file.
    fn table_of(&mut self, source: Source) -> &Table {
        self.table.source = source;
        self.table.trials = self.labels.as_ref().map_or_else(Vec::new, Labels::runs);
        &self.table
    }
}

/// The rows of a text that still grows: each is parsed once, when it has come whole.
pub(in crate::experiment) struct GrowingRows {
    budget: Budget,
    /// What came first, by which the spelling is known: all that came, until it is full.
    start: Vec<u8>,
    spelling: Spelling,
    /// What was not parsed yet.
    text: Vec<u8>,
    /// Lines before it.
    lines: u64,
    /// The header, once a whole row stands below it.
    head: Option<Head>,
    gathered: Option<Gathered>,
}

/// What became of a record that has come whole.
enum Taken {
    /// It is done with.
    Done,
    /// It stays, until another one is done with.
    Held,
}

impl GrowingRows {
    /// Nothing has come yet.
    pub(in crate::experiment) fn new(budget: Budget) -> Self {
        let (spelling, text) = (Spelling::of(b""), Vec::new());
        let start = Vec::new();
        Self { budget, start, spelling, text, lines: 0, head: None, gathered: None }
    }

    /// Adds whole lines.
    pub(in crate::experiment) fn push(&mut self, lines: &[u8]) {
        self.text.extend_from_slice(lines);
        let room = SNIFFED_BYTES - self.start.len();
        if room == 0 {
            return;
        }
        let (sniffed, others) = lines.split_at(lines.len().min(room));
        self.start.extend_from_slice(sniffed);
        let spelling = Spelling::of(&self.start);
        if spelling != self.spelling {
            // What was a table so far stands before it, or its cells are parted otherwise.
            let all = [self.start.as_slice(), others].concat();
            let (before, lines) = spelling.preamble;
            let text = all.get(before..).unwrap_or_default().to_vec();
            let (start, budget) = (std::mem::take(&mut self.start), self.budget.rest());
            *self = Self { start, spelling, text, lines, ..Self::new(budget) };
        }
    }

    /// Bytes that were not parsed yet: of a row that is not whole, or that is wrong, and of
    /// words that may stand below the table.
    pub(in crate::experiment) fn waiting(&self) -> usize {
        self.text.len()
    }

    /// The header; `None` as long as it has not come.
    pub(in crate::experiment) fn head(&mut self, path: &Path) -> Result<Option<Head>, ReadError> {
        if self.head.is_some() {
            return Ok(self.head.clone());
        }
        let (mut found, mut below) = (None, false);
        let mut sought = |record: &csv::ByteRecord, place: &Place| {
            let Some(head) = &mut found else {
                check_header_size(path, record.len(), &self.budget)?;
                found = Some(head(path, record, place.row)?);
                return Ok(ControlFlow::Continue(Taken::Done));
            };
            below = true;
            check_parted(head, record)?;
            if !are_units(record) {
                return Ok(ControlFlow::Break(Taken::Held));
            }
            add_units(head, record);
            Ok(ControlFlow::Break(Taken::Done))
        };
        let taken = each(&self.text, self.spelling.delimiter, self.lines, path, &mut sought)?;
        if below {
            self.drop_parsed(taken);
            self.head.clone_from(&found);
        }
        Ok(found)
    }

    /// All rows that have come whole, of this much of the file.
    pub(in crate::experiment) fn read(
        &mut self,
        wanted: &Wanted<'_>,
        source: Source,
    ) -> Result<&Table, ReadError> {
        let (delimiter, budget) = (self.spelling.delimiter, self.budget.rest());
        let gathered = self.gathered.take();
        let mut gathered = gathered.unwrap_or_else(|| Gathered::new(wanted, delimiter, budget));
        let mut remarks: Vec<(csv::ByteRecord, Place)> = Vec::new();
        let mut failure = None;
        let mut gather = |record: &csv::ByteRecord, place: &Place| {
            if remarks.len() < MOST_REMARKS && gathered.may_end_with(record) {
                remarks.push((record.clone(), *place));
                return Ok(ControlFlow::Continue(Taken::Held));
            }
            let held =
                remarks.iter().try_for_each(|(remark, at)| gathered.take(remark, at, wanted));
            remarks.clear();
            Ok(match held.and_then(|()| gathered.take(record, place, wanted)) {
                Ok(()) => ControlFlow::Continue(Taken::Done),
                Err(error) => {
                    failure = Some(error);
                    ControlFlow::Break(Taken::Held)
                }
            })
        };
        // Until a row stands below it, the header is found anew each time.
        if self.head.is_some() {
            let taken = each(&self.text, delimiter, self.lines, wanted.path(), &mut gather)?;
            self.drop_parsed(taken);
        }
        let gathered = self.gathered.insert(gathered);
        failure.map_or_else(|| Ok(gathered.table_of(source)), Err)
    }

    fn drop_parsed(&mut self, bytes: usize) {
        let lines = self.text.drain(..bytes).filter(|byte| *byte == b'\n');
        self.lines += lines.fold(0, |count, _| count + 1);
    }
}

/// Hands on the records of `text` that are whole, and says how many bytes are done with.
fn each(
    text: &[u8],
    delimiter: u8,
    lines: u64,
    path: &Path,
    take: &mut impl FnMut(&csv::ByteRecord, &Place) -> Result<ControlFlow<Taken, Taken>, ReadError>,
) -> Result<usize, ReadError> {
    let mut reader = reader(delimiter, LineEnds::after(text, lines));
    let mut record = csv::ByteRecord::new();
    let mut done = 0;
    let mut holds = false;
    loop {
        if !next(&mut reader, &mut record, path)? {
            // Remarks and empty lines stand behind the last record.
            return Ok(if holds { done } else { text.len() });
        }
        let end = usize::try_from(reader.position().byte()).unwrap_or(usize::MAX);
        // The line end behind the text is part of a quotation that still goes on.
        if end > text.len() {
            return Ok(done);
        }
        let place = place_just_read(&mut reader, &record);
        let step = take(&record, &place)?;
        let (ControlFlow::Break(taken) | ControlFlow::Continue(taken)) = &step;
        holds = matches!(taken, Taken::Held);
        done = if holds { done } else { end };
        if step.is_break() {
            return Ok(done);
        }
    }
}

fn check_width(wanted: &Wanted<'_>, place: &Place, found: usize) -> Result<(), ReadError> {
    let expected = wanted.head.headers.len();
    if found == expected {
        return Ok(());
    }
    let (path, row, lines) = (wanted.path().to_owned(), place.row, place.lines);
    Err(ReadError::UnequalRow { path, row, found, expected, lines })
}

/// Where a record is in the file.
#[derive(Clone, Copy)]
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
fn place_just_read<R: Read>(reader: &mut csv::Reader<Lines<R>>, record: &csv::ByteRecord) -> Place {
    let end = reader.position().byte().saturating_sub(1);
    let file = reader.get_mut().get_mut().0;
    let before_end = file.lines_before(end);
    // In a quotation that is never closed, the line end behind the file is one of its own.
    let text = record.as_slice();
    let text = if end == file.bytes { text.strip_suffix(b"\n").unwrap_or(text) } else { text };
    let inside = text.iter().filter(|&&byte| byte == b'\n').fold(0, |count, _| count + 1);
    Place { row: before_end + 1 - inside, lines: inside + 1 }
}

/// Passes bytes on and notes where lines end.
struct LineEnds<R> {
    inner: R,
    bytes: u64,
    /// The last of them.
    last: u8,
    /// Places of the line ends that no record has passed yet.
    ends: VecDeque<u64>,
    passed: u64,
    /// The end of the last row.
    row_end: u64,
    /// Bytes that a row may have.
    longest: u64,
}

impl<R: Read> LineEnds<R> {
    /// Bytes that come after so many `lines`.
    fn after(inner: R, lines: u64) -> Self {
        let (ends, longest) = (VecDeque::new(), LONGEST_ROW);
        Self { inner, bytes: 0, last: b'\n', ends, passed: lines, row_end: 0, longest }
    }

    /// With rows for which there is memory.
    fn within(self, budget: &Budget) -> Self {
        Self { longest: LONGEST_ROW.min(budget.left() / ROW_SIZE), ..self }
    }

    /// Number of line ends before the byte `place`, which never goes back.
    fn lines_before(&mut self, place: u64) -> u64 {
        self.row_end = place;
        while self.ends.pop_front_if(|end| *end < place).is_some() {
            self.passed += 1;
        }
        self.passed
    }
}

impl<R: Read> Read for LineEnds<R> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let waiting = self.bytes.saturating_sub(self.row_end);
        if waiting > self.longest || self.ends.len() > MOST_LINES {
            let or_memory = if self.longest < LONGEST_ROW {
                " A longer row needs a larger `--max-memory`."
            } else {
                ""
            };
            return Err(io::Error::other(format!(
                "the row behind line {} does not end within {} bytes and {MOST_LINES} lines; is a \
                 quotation mark never closed?{or_memory}",
                self.passed, self.longest
            )));
        }
        let count = self.inner.read(buffer)?;
        let new = buffer.get(..count).unwrap_or_default();
        let ends = new.iter().zip(self.bytes..).filter(|(byte, _)| **byte == b'\n');
        self.ends.extend(ends.map(|(_, place)| place));
        self.last = new.last().copied().unwrap_or(self.last);
        self.bytes += count as u64;
        Ok(count)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::experiment::MemoryLimit;
    use crate::experiment::table::BadCell;

    #[test]
    fn rows_are_the_lines_of_the_file() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("log.csv");
        let text = "# made by hand\nt,a\n0,1\n# pause\n\n1,2\n2,x";
        let mixed = text.replacen('\n', "\r\n", 2);
        for text in [text.to_owned(), format!("{text}\n"), text.replace('\n', "\r\n"), mixed] {
            std::fs::write(&path, &text).unwrap();
            let open = open(&path, Budget::new(MemoryLimit::default())).unwrap();
            assert_eq!(open.head.header_row, 2, "{text:?}");
            let table = open.read(&[0, 1], None, Some(0), 0).unwrap();
            let rows = [0, 1, 2].map(|index| table.rows.number(index));
            assert_eq!((table.rows.len(), rows), (3, [3, 6, 7]), "{text:?}");
            assert_eq!(table.columns[1].error, Some((7, BadCell::Text("x".to_owned()))));
        }
    }
}
