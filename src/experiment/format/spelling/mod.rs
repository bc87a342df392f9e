//! How the rows of a text are written: delimiter, lines before the header, units below it.

mod by_blanks;
mod rows;

use super::cell::{is_of_thousands, parse_time};
use crate::experiment::unit::is_unit;
use rows::{
    cells, count, ends_unevenly, ends_with, filled, holds_numbers, is_row, line_ends, rows, split,
    usual,
};

/// What parts the cells, and what stands before the header.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Spelling {
    /// The mark between cells, or [`BLANK`].
    pub(super) delimiter: u8,
    /// Bytes and lines before the header that belong to no table.
    pub(super) preamble: (usize, u64),
}

/// What stands for runs of blanks and tabs between cells.
const BLANK: u8 = b' ';

/// Marks that part cells, the least likely first: the comma is taken where none is found.
const DELIMITERS: [u8; 4] = [b'|', b'\t', b';', b','];

/// What ends the lines before a table of LabVIEW (`.lvm`): once for the file, once for the table.
const LABVIEW: (&[u8], &[u8]) = (b"LabVIEW Measurement", b"***End_of_Header***");

const BYTE_ORDER_MARK: &[u8] = b"\xef\xbb\xbf";

/// Lines that are looked at to separate the table from what precedes it.
const LINES: usize = 200;

impl Spelling {
    /// How a text is written that starts so, its cells parted by `delimiter` where that is known.
    pub(super) fn of(start: &[u8], delimiter: Option<u8>) -> Self {
        let marks = delimiter.map_or_else(|| DELIMITERS.to_vec(), |known| vec![known]);
        if let Some((behind, lines)) = behind_labview(start) {
            let below = start.get(behind..).unwrap_or_default();
            return Self { delimiter: sniff_delimiter(below, &marks), preamble: (behind, lines) };
        }
        let by_marks = Self::by_marks(start, &marks);
        by_marks.by_blanks(start).filter(|_| delimiter.is_none()).unwrap_or(by_marks)
    }

    fn by_marks(start: &[u8], marks: &[u8]) -> Self {
        Self::by_widths(start, marks).past_padding(start).at_marked_header(start)
    }

    /// Whether runs of blanks part the cells, for each of which a tab is put.
    pub(super) fn is_of_blanks(self) -> bool {
        self.delimiter == BLANK
    }

    /// The mark between cells, once tabs are put for runs of blanks.
    pub(super) fn mark(self) -> u8 {
        if self.is_of_blanks() { b'\t' } else { self.delimiter }
    }

    /// The header in the last comment above the table, where that begins with numbers, as NumPy writes it:
    /// `# time,u,y`.
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
                && cells.len() == row.len()
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

/// Where the table of a log of LabVIEW begins, in bytes and in lines.
fn behind_labview(start: &[u8]) -> Option<(usize, u64)> {
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

/// Whether a row says something, and no cell of it is a number or a time: the words below a table.
pub(super) fn is_remark(record: &csv::ByteRecord, delimiter: u8) -> bool {
    let cells = record.iter().map(<[u8]>::trim_ascii).filter(|cell| !cell.is_empty());
    let mut cells = cells.peekable();
    cells.peek().is_some()
        && !is_over_lines(record)
        && cells.all(|cell| parse_time(cell, delimiter).is_err() && !is_of_thousands(cell))
}

/// Whether a cell goes over several lines: behind a quotation mark that is never closed lies the
/// rest of the table.
pub(super) fn is_over_lines(record: &csv::ByteRecord) -> bool {
    record.iter().any(|cell| cell.trim_ascii().contains(&b'\n'))
}

/// The one of `marks` that is most frequent in the first line that is no comment.
fn sniff_delimiter(start: &[u8], marks: &[u8]) -> u8 {
    let text = start.strip_prefix(BYTE_ORDER_MARK).unwrap_or(start);
    let line = text.split(|&byte| byte == b'\n').find(|line| is_row(line)).unwrap_or_default();
    let counts = marks.iter().map(|delimiter| (*delimiter, count(line, *delimiter)));
    // The comma is last, so that it wins when nothing is found.
    counts.max_by_key(|(_, count)| *count).map_or(b',', |(delimiter, _)| delimiter)
}

/// Whether the cells below a header are its units: none is a number, and one at least is a unit.
pub(super) fn are_units(record: &csv::ByteRecord) -> bool {
    let texts = record.iter().map(|cell| bare_unit(&String::from_utf8_lossy(cell)));
    // What has no unit has none, or `-`.
    let texts: Vec<String> = texts.filter(|text| !["", "-"].contains(&text.as_str())).collect();
    let is_number = |text: &String| text.replace(',', ".").parse::<f64>().is_ok();
    !texts.is_empty()
        && !texts.iter().any(is_number)
        && 2 * texts.iter().filter(|text| is_unit(text)).count() > texts.len()
}

/// A unit without its brackets.
pub(super) fn bare_unit(cell: &str) -> String {
    let cell = cell.trim();
    let inner = |open: char, close: char| cell.strip_prefix(open)?.strip_suffix(close);
    inner('[', ']').or_else(|| inner('(', ')')).unwrap_or(cell).trim().to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_delimiter_is_told_from_the_header() {
        assert_eq!(sniff_delimiter(b"# a, b, c\n\nt;a.input;a.output\n1;2;3", &DELIMITERS), b';');
        assert_eq!(sniff_delimiter(b"t\ta,b\tc", &DELIMITERS), b'\t');
        assert_eq!(sniff_delimiter(b"single", &DELIMITERS), b',');
        assert_eq!(sniff_delimiter(b"\xef\xbb\xbf# a, b, c\nt;x;y", &DELIMITERS), b';');
        assert_eq!(sniff_delimiter(b"t,x [a;b;c]", &DELIMITERS), b',');
    }

    #[test]
    fn what_stands_before_the_header_is_told_from_the_table() {
        let table = "t;u;y\n0,0;1,5;2\n0,1;1;2\n0,2;1;2\n";
        let plain = Spelling { delimiter: b';', preamble: (0, 0) };
        assert_eq!(Spelling::of(table.as_bytes(), None), plain);
        let preamble = "Logger 4.2, boom test\nOperator:;somebody\n\n";
        let found = Spelling::of(format!("{preamble}{table}").as_bytes(), None);
        assert_eq!(found, Spelling { delimiter: b';', preamble: (preamble.len(), 3) });
        // One row of another length is a fault of the row, and not of the header.
        assert_eq!(Spelling::of(format!("{table}1;2\n").as_bytes(), None), plain);
    }

    #[test]
    fn a_delimiter_that_is_known_is_not_looked_for() {
        let text = b"t,\"u; V\",\"y; deg\"\n0,1,2\n0.1,1,2\n";
        let known = Spelling { delimiter: b',', preamble: (0, 0) };
        assert_eq!(Spelling::of(text, Some(b',')), known);
        assert_eq!(Spelling::of(b"a;b;c;d,e\n0,1\n", Some(b',')), known);
    }

    #[test]
    fn a_mark_behind_the_last_cell_makes_no_cell() {
        let rows = "0,1,2\n0.1,1,2\n0.2,1,2\n";
        let trailing = rows.replace('\n', ",\n");
        for (header, rows) in [("t,u,y\n", trailing.as_str()), ("t,u,y,\r\n", rows)] {
            let plain = Spelling { delimiter: b',', preamble: (0, 0) };
            assert_eq!(Spelling::of(format!("{header}{rows}").as_bytes(), None), plain);
            let found = Spelling::of(format!("Logger 3\n\n{header}{rows}").as_bytes(), None);
            assert_eq!(found, Spelling { delimiter: b',', preamble: (10, 2) });
        }
    }

    #[test]
    fn the_table_of_labview_begins_behind_two_headers() {
        let before = "LabVIEW Measurement\t\nSeparator\tTab\n***End_of_Header***\t\n\t\n\
                      Channels\t2\t\nX0\t0\t0\n***End_of_Header***\t\t\n";
        let log = format!("{before}X_Value\tu\ty\tComment\n0\t1\t2\n0.1\t1\t2\n");
        let found = Spelling::of(log.as_bytes(), None);
        assert_eq!(found, Spelling { delimiter: b'\t', preamble: (before.len(), 7) });
    }

    #[test]
    fn runs_of_blanks_part_cells_where_nothing_else_does() {
        let rows = "  0.00   1.5  20\n  0.01   1.5  20.1\n  0.02  -1.5   9\n";
        for (before, header) in [
            ("", "t u  y\n"),
            ("Rig 7, by hand\n\n", "t [s]   u (V)\ty [deg]\n"),
            ("# Rig 7\n  #", " t u y\n"),
            ("", "t u y\n s V deg\n"),
        ] {
            let found = Spelling::of(format!("{before}{header}{rows}").as_bytes(), None);
            let lines = before.bytes().filter(|byte| *byte == b'\n').count() as u64;
            let expected = Spelling { delimiter: BLANK, preamble: (before.len(), lines) };
            assert_eq!(found, expected, "{before:?} {header:?}");
        }
        let marked = format!("\u{feff}  t u y\n{rows}");
        let behind_mark = Spelling { delimiter: BLANK, preamble: (3, 0) };
        assert_eq!(Spelling::of(marked.as_bytes(), None), behind_mark);
        // Names of several words, dates and marks between cells make other tables.
        for text in [
            format!("time in s  u y\n{rows}"),
            "time u y\n2024-05-01 12:00:00 1 2\n2024-05-01 12:00:01 1 2\n".to_owned(),
            "t s;u V\n0 1\n0 2\n".to_owned(),
            "     t  u  y note\n0 0.0  1  2\n1 0.1  1  2\n".to_owned(),
        ] {
            assert!(!Spelling::of(text.as_bytes(), None).is_of_blanks(), "{text:?}");
        }
    }

    #[test]
    fn lines_padded_to_the_width_of_the_table_do_not_hide_the_header() {
        let table = "t;u;y\n0,0;1,5;2\n0,1;1;2\n0,2;1;2\n";
        for preamble in ["\"Run 7\";;\nDate;01.03.2026;\n;;\n", "Rig 3;;\r\nBy:;me;\r\n\r\n"] {
            for units in ["", "s;V;deg\n"] {
                let table = table.replacen('\n', &format!("\n{units}"), 1);
                let found = Spelling::of(format!("{preamble}{table}").as_bytes(), None);
                assert_eq!((found.delimiter, found.preamble), (b';', (preamble.len(), 3)));
            }
        }
        // An index without a name is a column all the same.
        let plain = Spelling { delimiter: b',', preamble: (0, 0) };
        assert_eq!(Spelling::of(b",t,u,y\n0,0,1,2\n1,0.1,1,2\n", None), plain);
    }

    #[test]
    fn units_below_the_header_are_no_samples() {
        let row = |cells: &[&str]| are_units(&csv::ByteRecord::from(cells.to_vec()));
        assert!(row(&["s", "-", "-"]) && row(&["", "-", "deg"]) && !row(&["-", "-"]));
        assert!(row(&["s", "V", "deg"]) && row(&["[ms]", "(%)", ""]));
        assert!(!row(&["0", "V", "deg"]) && !row(&["", ""]) && !row(&["x", "n/a"]));
    }
}
