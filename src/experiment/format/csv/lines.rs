//! Records of a text, and the lines of the file that they stand on.

use std::collections::VecDeque;
use std::io::{self, Read};
use std::ops::ControlFlow;
use std::path::Path;

use super::comments::{Comments, End, first_line, without_marks};
use crate::experiment::error::ReadError;
use crate::experiment::memory::Budget;
use crate::experiment::table::Wanted;

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
    let lines = LineEnds { mark: delimiter, ..lines };
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
    (path, wanted): (&Path, Option<&Wanted<'_>>),
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
        let is_row = next(&mut reader, &mut record, path)?;
        if let Some(wanted) = wanted {
            reader.get_ref().get_ref().0.comments().check_labels(wanted)?;
        }
        if !is_row {
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
    /// Bytes that were read, and are handed on with those behind them.
    held_back: Vec<u8>,
    /// What parts the cells.
    mark: u8,
    comments: Comments,
}

impl<R: Read> LineEnds<R> {
    /// Bytes that come after so many `lines`.
    pub(super) fn after(inner: R, lines: u64) -> Self {
        let (ends, longest) = (VecDeque::new(), LONGEST_ROW);
        Self {
            inner,
            bytes: 0,
            last: b'\n',
            ends,
            passed: lines,
            row_end: 0,
            longest,
            held_back: Vec::new(),
            mark: b',',
            comments: Comments::default(),
        }
    }

    /// With rows for which there is memory.
    pub(super) fn within(self, budget: &Budget) -> Self {
        Self { longest: LONGEST_ROW.min(budget.left() / ROW_SIZE), ..self }
    }

    /// Reads bytes with a blank for the mark of a comment at the beginning of a line that is a cell.
    fn read_cells(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let mut count = 0;
        loop {
            let held = self.held_back.len().min(buffer.len() - count);
            let room = buffer.get_mut(count..count + held).unwrap_or_default();
            room.copy_from_slice(self.held_back.get(..held).unwrap_or_default());
            self.held_back.drain(..held);
            count += held;
            let new = self.inner.read(buffer.get_mut(count..).unwrap_or_default())?;
            count += new;
            let is_all = new == 0;
            let known = buffer.get_mut(..count).unwrap_or_default();
            let end = if is_all { End::Come } else { End::Open };
            let done = without_marks(known, self.last, end);
            if done > 0 || is_all {
                let row = self.passed + self.ends.len() as u64 + 1;
                let first = (first_line(known, self.last), row);
                self.comments.note(known.get(..done).unwrap_or_default(), first, self.mark);
                self.held_back.splice(0..0, known.get(done..).unwrap_or_default().iter().copied());
                return Ok(done);
            }
        }
    }

    /// The comments that it passed on.
    pub(super) fn comments(&self) -> &Comments {
        &self.comments
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
        let count = self.read_cells(buffer)?;
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

    /// Hands on few bytes at a time.
    struct Few<'t>(&'t [u8], usize);

    impl Read for Few<'_> {
        fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
            let count = self.1.min(buffer.len());
            self.0.read(&mut buffer[..count])
        }
    }

    #[test]
    fn a_value_that_is_none_is_no_comment() {
        let text = b"#N/A\n# by hand\r\n#N/A;1\r# old\r#N/Ax,1\n#DIV/0!,2\n0,#N/A\n#\n#NV";
        let expected = b" N/A\n# by hand\r\n N/A;1\n# old\n#N/Ax,1\n DIV/0!,2\n0,#N/A\n#\n NV";
        for pieces in 1..20 {
            for room in [1, 3, 16, 64] {
                let mut lines = LineEnds::after(Few(text, pieces), 0);
                let (mut made, mut buffer) = (Vec::new(), vec![0; room]);
                loop {
                    let count = lines.read(&mut buffer).unwrap();
                    made.extend_from_slice(&buffer[..count]);
                    if count == 0 {
                        break;
                    }
                }
                // With less room than a comment takes, a mark may stay.
                let is_right = made == expected || room < 16 && made.len() == text.len();
                assert!(is_right, "{pieces} {room} {:?}", String::from_utf8_lossy(&made));
            }
        }
    }
}
