//! Tables whose cells are parted by runs of blanks.

use super::super::blanks::tabbed;
use super::marks::{BLANK, Spelling, are_units};
use super::rows::{BYTE_ORDER_MARK, LINES, count, holds_numbers, is_row, rows, split};

/// One row in so many may have lost a cell, which is a fault of the row.
const ODD: usize = 10;

impl Spelling {
    /// The table as rows of numbers that blanks part into as many cells as the header, where no mark
    /// parts that.
    pub(super) fn by_blanks(self, start: &[u8]) -> Option<Self> {
        let (bytes, _) = self.preamble;
        let table = start.get(bytes..)?;
        if self.parts_numbers(table) || self.are_even_tabs(table) {
            return None;
        }
        let end = start.iter().rposition(|byte| *byte == b'\n')?;
        let start = start.get(..=end)?;
        let text = start.strip_prefix(BYTE_ORDER_MARK).unwrap_or(start);
        let made = tabbed(text);
        let Self { preamble: (bytes, before), .. } = Self::by_marks(&made, b"\t");
        let (above, table) = made.split_at_checked(bytes)?;
        if !is_table(table) {
            return None;
        }
        let mut lines = text.split_inclusive(|byte| *byte == b'\n');
        let skipped = lines.by_ref().take(usize::try_from(before).ok()?).map(<[u8]>::len);
        let skipped = skipped.sum::<usize>() + (start.len() - text.len());
        let header = lines.next()?;
        // The mark of a comment may stand before the header.
        let is_comment = above.last().is_some_and(|byte| *byte != b'\n');
        let mark = header.iter().position(|byte| *byte == b'#').filter(|_| is_comment);
        let row = lines.find(|line| is_row(line) && line.iter().any(u8::is_ascii_digit));
        if mark.is_none() && row.is_some_and(|row| is_shifted(header, row)) {
            return None;
        }
        let bytes = skipped + mark.map_or(0, |mark| mark + 1);
        Some(Self { delimiter: BLANK, preamble: (bytes, before) })
    }

    /// Whether single tabs part the rows as they part the header, as in a table whose cells are words for
    /// the most part.
    fn are_even_tabs(self, table: &[u8]) -> bool {
        if self.delimiter != b'\t' {
            return false;
        }
        let mut lines = rows(table).filter(|line| is_row(line)).take(LINES);
        let width = |line: &[u8]| split(line, self.delimiter).len();
        let Some(header) = lines.next().map(width).filter(|width| *width > 1) else { return false };
        let (rows, odd) = lines.fold((0_usize, 0_usize), |(rows, odd), line| {
            (rows + 1, odd + usize::from(width(line) != header))
        });
        rows > 0 && ODD * odd <= rows
    }

    /// Whether the mark between cells makes numbers of a row of `table`, as a decimal comma does of all
    /// rows but the header.
    fn parts_numbers(self, table: &[u8]) -> bool {
        let lines = rows(table).filter(|line| is_row(line)).take(LINES);
        lines.map(|line| split(line, self.delimiter)).any(|row| holds_numbers(&row, self.delimiter))
    }
}

/// Whether a header of several names stands above rows of as many numbers, all parted by single tabs.
fn is_table(table: &[u8]) -> bool {
    let mut lines = rows(table).filter(|line| is_row(line));
    let is_marked = |line: &[u8]| b",;|".iter().any(|mark| count(line, *mark) > 0);
    let Some(header) = lines.next().filter(|line| !is_marked(line)) else { return false };
    let header = split(header, b'\t');
    let is_of_table =
        |row: csv::ByteRecord| row.len() == header.len() && holds_numbers(&row, b'\t');
    let below = lines.take(LINES).map(|line| split(line, b'\t')).filter(|row| !are_units(row));
    let are_rows: Vec<bool> = below.map(is_of_table).collect();
    let odd = are_rows.iter().filter(|is_row| !**is_row).count();
    header.len() > 1
        && !holds_numbers(&header, b'\t')
        && are_rows.first() == Some(&true)
        && ODD * odd <= are_rows.len()
}

/// Whether the first cell of a `row` between blanks has no name above it, and its second one the first
/// name of the `header`: the name of the last column has nothing below it.
fn is_shifted(header: &[u8], row: &[u8]) -> bool {
    let is_blank = |byte: &u8| b" \t".contains(byte);
    let word = |line: &[u8], from: usize| {
        let rest = line.get(from..)?;
        let first = from + rest.iter().position(|byte| !is_blank(byte))?;
        let length = line.get(first..)?.iter().position(is_blank)?;
        Some((first, first + length))
    };
    let shifted = || {
        let (name, name_end) = word(header, 0)?;
        let (_, end) = word(row, 0)?;
        let (second, _) = word(row, end)?;
        Some(end < name && second < name_end)
    };
    shifted().unwrap_or(false)
}
