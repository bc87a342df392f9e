//! Tables whose cells are parted by marks, and what stands above and below their rows.

use super::super::cell::{is_of_thousands, parse_time};
use super::rows::{
    BYTE_ORDER_MARK, LINES, cells, count, ends_unevenly, ends_with, filled, holds_numbers, is_row,
    line_ends, rows, split, usual,
};
use crate::experiment::unit::is_unit;

/// What parts the cells, and what stands before the header.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::experiment::format) struct Spelling {
    /// The mark between cells, or [`BLANK`].
    pub(in crate::experiment::format) delimiter: u8,
    /// Bytes and lines before the header that belong to no table.
    pub(in crate::experiment::format) preamble: (usize, u64),
}

/// What stands for runs of blanks and tabs between cells.
pub(super) const BLANK: u8 = b' ';

/// Marks that part cells, the least likely first: the comma is taken where none is found.
pub(super) const DELIMITERS: [u8; 4] = [b'|', b'\t', b';', b','];

/// What ends the lines before a table of LabVIEW (`.lvm`): once for the file, once for the table.
const LABVIEW: (&[u8], &[u8]) = (b"LabVIEW Measurement", b"***End_of_Header***");

impl Spelling {
    pub(super) fn by_marks(start: &[u8], marks: &[u8]) -> Self {
        Self::by_widths(start, marks).past_padding(start).at_marked_header(start)
    }

    /// Whether runs of blanks part the cells, for each of which a tab is put.
    pub(in crate::experiment::format) fn is_of_blanks(self) -> bool {
        self.delimiter == BLANK
    }

    /// The mark between cells, once tabs are put for runs of blanks.
    pub(in crate::experiment::format) fn mark(self) -> u8 {
        if self.is_of_blanks() { b'\t' } else { self.delimiter }
    }

    /// The header in the last comment above the table, where that begins with numbers, as NumPy writes it:
    /// `# time,u,y`. Whether each column has one name is asked of it as of any other header.
    fn at_marked_header(self, start: &[u8]) -> Self {
        const MARK: &[u8] = b"#";
        let found = || {
            let (bytes, _) = self.preamble;
            let lines = rows(start.get(bytes..)?).take(LINES);
            let comments = lines.take_while(|line| !is_row(line)).map(<[u8]>::len);
            let (above, table) = start.split_at_checked(bytes + comments.sum::<usize>())?;
            let comment = above.split_inclusive(|byte| *byte == b'\n').next_back()?;
            let names = comment.strip_prefix(BYTE_ORDER_MARK).unwrap_or(comment);
            let names = names.strip_prefix(MARK)?;
            let cells = split(names, self.delimiter);
            let row = split(rows(table).next()?, self.delimiter);
            let is_name = |cell: &[u8]| parse_time(cell.trim_ascii(), self.delimiter).is_err();
            // The mark may be the name of a column of numbers of rows.
            let mut names_of = cells.iter().enumerate();
            let is_header = cells.len() > 1
                && names_of.all(|(column, cell)| is_name(cell) || column == 0 && cell.is_empty());
            let before = line_ends(&[above.get(..above.len() - comment.len())?]);
            let preamble = (above.len() - names.len(), before);
            (is_header && holds_numbers(&row, self.delimiter)).then_some(Self { preamble, ..self })
        };
        found().unwrap_or(self)
    }

    /// The table as rows of one width, with what is shorter or longer before it, parted by one of `marks`.
    fn by_widths(start: &[u8], marks: &[u8]) -> Self {
        /// Rows that are not parted alike by chance.
        const MANY: usize = 5;
        let plain = Self { delimiter: sniff_delimiter(start, marks), preamble: (0, 0) };
        let text = start.strip_prefix(BYTE_ORDER_MARK).unwrap_or(start);
        // The last line may be cut off.
        let whole = text.iter().rposition(|byte| *byte == b'\n').map_or(0, |end| end + 1);
        let lines: Vec<&[u8]> = rows(text.get(..whole).unwrap_or_default()).take(LINES).collect();
        let counts = |delimiter: u8| -> Vec<usize> {
            let is_trailing = ends_unevenly(&lines, delimiter);
            let own = |line: &&[u8]| usize::from(is_trailing && ends_with(line, delimiter));
            lines.iter().map(|line| cells(line, delimiter) - own(line)).collect()
        };
        let agreeing = |delimiter: u8| {
            let counts = counts(delimiter);
            let width = usual(&counts);
            (counts.iter().filter(|count| **count == width && width > 1).count(), width)
        };
        let first = counts(plain.delimiter).into_iter().find(|count| *count > 0).unwrap_or(0);
        let (own, own_width) = agreeing(plain.delimiter);
        let best = marks.iter().map(|delimiter| (agreeing(*delimiter), *delimiter));
        let Some(((agree, width), delimiter)) =
            best.max_by_key(|((agree, width), _)| (*agree, *width))
        else {
            return plain;
        };
        // A decimal comma parts some rows as evenly as what does part them, but not the header; where many
        // rows agree on another mark, the first line belongs to no table.
        if own < 2 && first > 1 && agree < MANY || first == own_width && own >= agree {
            return plain;
        }
        let counts = counts(delimiter);
        let header = counts.windows(2).position(|pair| pair == [width, width]);
        match header.filter(|_| agree > 2) {
            Some(header) => {
                let before = lines.get(..header).unwrap_or_default();
                let mark = start.len() - text.len();
                let skipped = before.iter().map(|line| line.len()).sum::<usize>();
                Self { delimiter, preamble: (mark + skipped, line_ends(before)) }
            }
            None => plain,
        }
    }

    /// The header below lines that are padded to the width of the table, as spreadsheet programs
    /// write them: the first full row above those of numbers.
    fn past_padding(self, start: &[u8]) -> Self {
        let (bytes, before) = self.preamble;
        let lines: Vec<&[u8]> = rows(start.get(bytes..).unwrap_or_default()).take(LINES).collect();
        let mut above: Vec<(usize, csv::ByteRecord)> = Vec::new();
        for (index, line) in lines.iter().enumerate().filter(|(_, line)| is_row(line)) {
            let record = split(line, self.delimiter);
            if !holds_numbers(&record, self.delimiter) {
                above.push((index, record));
                continue;
            }
            // A mark behind the last cell makes none.
            let width = record.len();
            let is_full = |record: &csv::ByteRecord| {
                let ends_with_mark = record.len() == width + 1;
                filled(record) == record.len() - usize::from(ends_with_mark)
            };
            let is_padded = above.first().is_some_and(|(_, first)| !is_full(first));
            // What is full below it says more of its columns.
            let header = above.iter().find(|(_, record)| is_full(record) && !are_units(record));
            let (Some((index, _)), true) = (header, is_padded) else { return self };
            let above = lines.get(..*index).unwrap_or_default();
            let skipped: usize = above.iter().map(|line| line.len()).sum();
            return Self { preamble: (bytes + skipped, before + line_ends(above)), ..self };
        }
        self
    }
}

/// Whether a row says something, and no cell of it is a number or a time: the words below a table.
pub(in crate::experiment::format) fn is_remark(record: &csv::ByteRecord, delimiter: u8) -> bool {
    let cells = record.iter().map(<[u8]>::trim_ascii).filter(|cell| !cell.is_empty());
    let mut cells = cells.peekable();
    cells.peek().is_some()
        && !is_over_lines(record)
        && cells.all(|cell| parse_time(cell, delimiter).is_err() && !is_of_thousands(cell))
}

/// Whether a cell goes over several lines: behind a quotation mark that is never closed lies the
/// rest of the table.
pub(in crate::experiment::format) fn is_over_lines(record: &csv::ByteRecord) -> bool {
    record.iter().any(|cell| cell.trim_ascii().contains(&b'\n'))
}

/// The one of `marks` that is most frequent in the first line that is no comment.
pub(super) fn sniff_delimiter(start: &[u8], marks: &[u8]) -> u8 {
    let text = start.strip_prefix(BYTE_ORDER_MARK).unwrap_or(start);
    let line = text.split(|&byte| byte == b'\n').find(|line| is_row(line)).unwrap_or_default();
    let counts = marks.iter().map(|delimiter| (*delimiter, count(line, *delimiter)));
    // The comma is last, so that it wins when nothing is found.
    counts.max_by_key(|(_, count)| *count).map_or(b',', |(delimiter, _)| delimiter)
}

/// Whether the cells below a header are its units: none is a number, and one at least is a unit.
pub(in crate::experiment::format) fn are_units(record: &csv::ByteRecord) -> bool {
    let texts = record.iter().map(|cell| bare_unit(&String::from_utf8_lossy(cell)));
    // What has no unit has none, or `-`.
    let texts: Vec<String> = texts.filter(|text| !["", "-"].contains(&text.as_str())).collect();
    let is_number = |text: &String| text.replace(',', ".").parse::<f64>().is_ok();
    !texts.is_empty()
        && !texts.iter().any(is_number)
        && 2 * texts.iter().filter(|text| is_unit(text)).count() > texts.len()
}

/// A unit without its brackets.
pub(in crate::experiment::format) fn bare_unit(cell: &str) -> String {
    let cell = cell.trim();
    let inner = |open: char, close: char| cell.strip_prefix(open)?.strip_suffix(close);
    inner('[', ']').or_else(|| inner('(', ')')).unwrap_or(cell).trim().to_owned()
}

/// Where the table of a log of LabVIEW begins, in bytes and in lines.
pub(super) fn behind_labview(start: &[u8]) -> Option<(usize, u64)> {
    let (first, end) = LABVIEW;
    let text = start.strip_prefix(BYTE_ORDER_MARK).unwrap_or(start);
    let lines: Vec<&[u8]> = rows(text).collect();
    lines.first().filter(|line| line.starts_with(first))?;
    // One for the file and one for its first table: of more tables the next header is a row that is wrong.
    let ends = lines.iter().enumerate().filter(|(_, line)| line.starts_with(end));
    let (last, _) = ends.take(2).last()?;
    let before = lines.get(..=last)?;
    let bytes: usize = before.iter().map(|line| line.len()).sum();
    Some((start.len() - text.len() + bytes, line_ends(before)))
}
