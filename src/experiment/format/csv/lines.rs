//! Rows of a text, and the lines of the file that they stand on.

use std::io::{BufRead as _, BufReader, Read as _};

use super::super::cell::is_missing;
use super::super::line::part;
use super::super::spelling::Spelling;
use super::super::text::Bytes;
use crate::experiment::error::ReadError;
use crate::experiment::memory::Budget;

/// Bytes of a row: what is longer is no table of text, or a quotation that is never closed.
const LONGEST_ROW: u64 = 1 << 24;

/// Lines of the same.
const MOST_LINES: u64 = 100;

/// Memory that is taken for a byte of a row while it grows, if all cells are empty (measured: 26).
const ROW_SIZE: u64 = 32;

/// The rows of a table of text, one after another.
pub(super) struct Records {
    bytes: BufReader<Bytes>,
    mark: u8,
    /// Lines that were read.
    count: u64,
    /// Bytes that a row may have.
    longest: u64,
    /// The lines of the row that was read last.
    text: Vec<u8>,
    /// Its cells.
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
        let (_, count) = spelling.preamble;
        Self {
            bytes: BufReader::with_capacity(1 << 16, bytes),
            mark: spelling.delimiter,
            count,
            longest: LONGEST_ROW.min(budget.left() / ROW_SIZE),
            text: Vec::new(),
            record: csv::ByteRecord::new(),
        }
    }

    /// Reads the next record, past comments and blank lines; where it is, or `None` at the end. A quoted cell
    /// may go over several lines.
    pub(super) fn next(&mut self) -> Result<Option<Place>, ReadError> {
        self.text.clear();
        let mut row = self.count + 1;
        while self.read_line(row)? {
            self.count += 1;
            let is_whole = part(&self.text, self.mark, &mut self.record);
            if row == self.count && self.is_left_out() {
                self.text.clear();
                row += 1;
            } else if is_whole {
                break;
            }
        }
        let is_open = !self.text.ends_with(b"\n");
        let lines = self.count + 1 - row;
        Ok((!self.text.is_empty()).then_some(Place { row, lines, is_open }))
    }

    pub(super) fn into_bytes(self) -> Bytes {
        self.bytes.into_inner()
    }

    /// Adds the next line to those of the record at `row`; whether there was one.
    fn read_line(&mut self, row: u64) -> Result<bool, ReadError> {
        let left = (self.longest + 1).saturating_sub(self.text.len() as u64);
        let read = self.bytes.by_ref().take(left).read_until(b'\n', &mut self.text)?;
        if self.text.len() as u64 > self.longest || self.count >= row + MOST_LINES {
            return Err(self.without_end(row));
        }
        Ok(read > 0)
    }

    fn without_end(&self, row: u64) -> ReadError {
        let mut text = format!(
            "it does not end within {} bytes and {MOST_LINES} lines; is a quotation mark never closed? If so, \
             close it, or remove the mark.",
            self.longest
        );
        if self.longest < LONGEST_ROW {
            text += " A longer row needs a larger `--max-memory`.";
        }
        ReadError::content(text).in_row(row)
    }

    /// Whether a line between records is blank or a comment. One that begins with a cell like `#N/A` is none.
    fn is_left_out(&self) -> bool {
        if !self.text.trim_ascii_start().starts_with(b"#") {
            return self.text.iter().all(|byte| b" \r\n".contains(byte));
        }
        let first = self.record.get(0).unwrap_or_default().trim_ascii();
        !std::str::from_utf8(first).is_ok_and(is_missing)
    }
}
