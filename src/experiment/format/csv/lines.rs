//! Records of a text, and the lines of the file that they stand on.

use std::collections::VecDeque;
use std::io::{self, Read};
use std::ops::ControlFlow;
use std::path::Path;

use crate::experiment::error::ReadError;
use crate::experiment::memory::Budget;

/// Bytes, and a line ending behind the last line, so that every line has one and lines can
/// be counted.
pub(super) type Lines<R> = io::Chain<LineEnds<R>, &'static [u8]>;

/// Bytes of a row, with comments and blank lines before it: what is longer is no table of text,
/// or a quotation that is never closed.
const LONGEST_ROW: u64 = 1 << 24;

/// Lines of the same.
const MOST_LINES: usize = 1 << 20;

/// Memory that is taken for a byte of a row while it grows, if all cells are empty (measured: 26).
const ROW_SIZE: u64 = 32;

pub(super) fn reader<R: Read>(delimiter: u8, lines: LineEnds<R>) -> csv::Reader<Lines<R>> {
    csv::ReaderBuilder::new()
        .delimiter(delimiter)
        .comment(Some(b'#'))
        .flexible(true)
        .has_headers(false)
        .from_reader(lines.chain(&b"\n"[..]))
}

/// Whether there is one more row, which is then in `record`.
pub(super) fn next<R: Read>(
    reader: &mut csv::Reader<R>,
    record: &mut csv::ByteRecord,
    path: &Path,
) -> Result<bool, ReadError> {
    let more = reader.read_byte_record(record);
    more.map_err(|source| ReadError::Csv { path: path.to_owned(), source })
}

/// What became of a record that has come whole.
pub(super) enum Taken {
    /// It is done with.
    Done,
    /// It stays, until another one is done with.
    Held,
}

/// A part of a table of text.
#[derive(Clone, Copy)]
pub(super) struct Piece<'t> {
    pub(super) text: &'t [u8],
    /// Lines of the file before it.
    pub(super) lines: u64,
    /// Whether the table begins before it.
    pub(super) is_begun: bool,
}

/// Hands on the records of a piece that are whole, and says how many bytes are done with.
pub(super) fn each(
    Piece { text, lines, is_begun }: Piece<'_>,
    delimiter: u8,
    path: &Path,
    take: &mut impl FnMut(&csv::ByteRecord, &Place) -> Result<ControlFlow<Taken, Taken>, ReadError>,
) -> Result<usize, ReadError> {
    // At its beginning a reader drops a byte order mark, which is one there only: an empty line stands
    // before what goes on.
    let before = u64::from(is_begun && lines > 0);
    let all = b"\n".take(before).chain(text);
    let mut reader = reader(delimiter, LineEnds::after(all, lines - before));
    let mut record = csv::ByteRecord::new();
    let mut done = 0;
    let mut holds = false;
    loop {
        if !next(&mut reader, &mut record, path)? {
            // Remarks and empty lines stand behind the last record.
            return Ok(if holds { done } else { text.len() });
        }
        let end = reader.position().byte().saturating_sub(before);
        let end = usize::try_from(end).unwrap_or(usize::MAX);
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

/// Where a record is in the file.
#[derive(Clone, Copy)]
pub(super) struct Place {
    /// Its first line, counted from 1.
    pub(super) row: u64,
    /// Lines it takes up.
    pub(super) lines: u64,
}

/// The place of the record that was read last.
///
/// The parser's own count is that of the comment lines before it, and takes "\r\n" in
/// two halves; so the lines before the end of the record are counted here.
pub(super) fn place_just_read<R: Read>(
    reader: &mut csv::Reader<Lines<R>>,
    record: &csv::ByteRecord,
) -> Place {
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
pub(super) struct LineEnds<R> {
    pub(super) inner: R,
    bytes: u64,
    /// The last of them.
    pub(super) last: u8,
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
    pub(super) fn after(inner: R, lines: u64) -> Self {
        let (ends, longest) = (VecDeque::new(), LONGEST_ROW);
        Self { inner, bytes: 0, last: b'\n', ends, passed: lines, row_end: 0, longest }
    }

    /// With rows for which there is memory.
    pub(super) fn within(self, budget: &Budget) -> Self {
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
