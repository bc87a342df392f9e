//! Records of a text, and the lines of the file that they stand on.

use std::io::{self, BufRead as _, BufReader, Read};

use super::super::blanks::tabbed;
use super::super::cell::is_missing;
use super::super::spelling::Spelling;
use super::super::text::Bytes;
use super::comments::Comments;
use crate::experiment::error::ReadError;
use crate::experiment::memory::Budget;

/// Bytes of a row, with comments and blank lines before it: what is longer is no table of text,
/// or a quotation that is never closed.
const LONGEST_ROW: u64 = 1 << 24;

/// Lines of the same.
const MOST_LINES: u64 = 1 << 20;

/// Memory that is taken for a byte of a row while it grows, if all cells are empty (measured: 26).
const ROW_SIZE: u64 = 32;

/// The rows of a table of text, one after another.
pub(super) struct Records {
    reader: csv::Reader<Lines<Bytes>>,
    /// The one that was read last.
    pub(super) record: csv::ByteRecord,
}

/// Where a record is in the file.
#[derive(Clone, Copy)]
pub(super) struct Place {
    /// Its first line, counted from 1.
    pub(super) row: u64,
    /// Lines it takes up.
    pub(super) lines: u64,
    /// Whether its last line has no end, as only the last one of a file may: it may be cut off.
    pub(super) is_open: bool,
}

impl Records {
    /// The records of `bytes`, written in this way, from the table's first line on.
    pub(super) fn of(bytes: Bytes, spelling: Spelling, budget: &Budget) -> Self {
        let mark = spelling.mark();
        let (_, lines) = spelling.preamble;
        let longest = LONGEST_ROW.min(budget.left() / ROW_SIZE);
        let lines = Lines::after(bytes, lines, (mark, spelling.is_of_blanks()), longest);
        let mut reader = csv::ReaderBuilder::new();
        reader.delimiter(mark).flexible(true).has_headers(false);
        Self { reader: reader.from_reader(lines), record: csv::ByteRecord::new() }
    }

    /// Reads the next record; where it is, or `None` at the end.
    pub(super) fn next(&mut self) -> Result<Option<Place>, ReadError> {
        self.reader.get_mut().begin_record();
        let more = self.reader.read_byte_record(&mut self.record)?;
        let Lines { count, first, ref line, .. } = *self.reader.get_ref();
        let is_open = !line.last().is_some_and(|byte| b"\r\n".contains(byte));
        Ok(more.then_some(Place { row: first, lines: count + 1 - first, is_open }))
    }

    pub(super) fn comments(&mut self) -> &mut Comments {
        &mut self.reader.get_mut().comments
    }

    pub(super) fn into_bytes(self) -> Bytes {
        self.reader.into_inner().inner.into_inner()
    }
}

/// Hands on the lines of a text, one at a time, without comments and blank lines between records: so it is
/// known on which lines a record stands, which a quoted cell may go over.
struct Lines<R> {
    inner: BufReader<R>,
    /// Lines that were read.
    count: u64,
    /// The first line of the record, counted from 1.
    first: u64,
    /// Bytes since the end of the last record.
    waiting: u64,
    /// Bytes that may be.
    longest: u64,
    /// Whether a line of the record was handed on.
    is_begun: bool,
    line: Vec<u8>,
    /// Bytes of the line that were handed on.
    passed: usize,
    /// What parts the cells.
    mark: u8,
    /// Whether a tab is to be put for each run of blanks.
    of_blanks: bool,
    comments: Comments,
}

impl<R: Read> Lines<R> {
    /// Bytes that come after so many lines.
    fn after(inner: R, count: u64, (mark, of_blanks): (u8, bool), longest: u64) -> Self {
        Self {
            inner: BufReader::with_capacity(1 << 16, inner),
            count,
            first: count,
            waiting: 0,
            longest,
            is_begun: false,
            line: Vec::new(),
            passed: 0,
            mark,
            of_blanks,
            comments: Comments::default(),
        }
    }

    fn begin_record(&mut self) {
        (self.is_begun, self.waiting, self.first) = (false, 0, self.count);
    }

    /// Reads the next line that belongs to a record; an empty one at the end.
    fn read_line(&mut self) -> io::Result<()> {
        loop {
            self.read_any_line()?;
            if self.line.is_empty() {
                return Ok(());
            }
            self.count += 1;
            if self.is_begun {
                return Ok(());
            }
            self.first = self.count;
            if !self.is_left_out() {
                self.is_begun = true;
                return Ok(());
            }
        }
    }

    /// Reads up to a line feed, or to a carriage return that ends a line alone.
    fn read_any_line(&mut self) -> io::Result<()> {
        (self.passed, self.line) = (0, std::mem::take(&mut self.line));
        self.line.clear();
        loop {
            let bytes = self.inner.fill_buf()?;
            let Some(next) = bytes.first() else { break };
            if self.line.ends_with(b"\r") && !b"\r\n".contains(next) {
                break;
            }
            let end = bytes.iter().position(|byte| *byte == b'\n' || *byte == b'\r');
            let length = end.map_or(bytes.len(), |end| end + 1);
            self.line.extend_from_slice(bytes.get(..length).unwrap_or_default());
            self.inner.consume(length);
            self.waiting += length as u64;
            self.check_length()?;
            if self.line.ends_with(b"\n") {
                break;
            }
        }
        if self.of_blanks {
            self.line = tabbed(&self.line);
        }
        Ok(())
    }

    fn check_length(&self) -> io::Result<()> {
        if self.waiting <= self.longest && self.count - self.first <= MOST_LINES {
            return Ok(());
        }
        let is_for_memory = self.longest < LONGEST_ROW;
        let or_memory =
            if is_for_memory { " A longer row needs a larger `--max-memory`." } else { "" };
        Err(io::Error::other(format!(
            "the row behind line {} does not end within {} bytes and {MOST_LINES} lines; is a \
             quotation mark never closed?{or_memory}",
            self.count, self.longest
        )))
    }

    /// Whether a line between records is blank or a comment. One that begins with a cell like `#N/A` is none.
    fn is_left_out(&mut self) -> bool {
        if self.line.iter().all(|byte| b" \r\n".contains(byte)) {
            return true;
        }
        let line = self.line.trim_ascii_end();
        let first = line.split(|byte| *byte == self.mark).next().unwrap_or_default();
        let is_comment =
            line.starts_with(b"#") && !std::str::from_utf8(first).is_ok_and(is_missing);
        if is_comment {
            self.comments.note(line, self.count, self.mark);
        }
        is_comment
    }
}

impl<R: Read> Read for Lines<R> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        if self.passed == self.line.len() {
            self.read_line()?;
        }
        let count = self.line.get(self.passed..).unwrap_or_default().read(buffer)?;
        self.passed += count;
        Ok(count)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Hands on few bytes at a time.
    struct Few<'t>(&'t [u8], usize);

    impl Read for Few<'_> {
        fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
            let count = self.1.min(buffer.len());
            self.0.read(&mut buffer[..count])
        }
    }

    /// The lines between records, each the only one of its record.
    fn lines(text: &[u8], pieces: usize) -> Vec<(u64, String)> {
        let mut lines = Lines::after(Few(text, pieces), 0, (b',', false), 1000);
        let mut found = Vec::new();
        loop {
            lines.begin_record();
            lines.read_line().unwrap();
            if lines.line.is_empty() {
                return found;
            }
            found.push((lines.first, String::from_utf8_lossy(&lines.line).into_owned()));
        }
    }

    #[test]
    fn a_value_that_is_none_is_no_comment() {
        let text = b"#N/A\n# by hand\r\n#N/A,1\r# old\r#N/Ax,1\n\n#DIV/0!,2\n0,#N/A\n#\n#NV";
        let expected =
            [(1, "#N/A\n"), (3, "#N/A,1\r"), (7, "#DIV/0!,2\n"), (8, "0,#N/A\n"), (10, "#NV")];
        let expected = expected.map(|(row, line)| (row, line.to_owned()));
        for pieces in 1..20 {
            assert_eq!(lines(text, pieces), expected, "{pieces}");
        }
    }
}
