//! How the rows of a text are written: delimiter, lines before the header, units below it.

use super::blanks::tabbed;
use super::cell::{Time, is_of_thousands, parse_time};
use crate::experiment::unit::is_unit;

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

    /// The table as rows of numbers that blanks part into as many cells as the header, where no mark
    /// parts that.
    fn by_blanks(self, start: &[u8]) -> Option<Self> {
        let (bytes, _) = self.preamble;
        let mut by_marks = rows(start.get(bytes..)?).filter(|line| is_row(line)).take(LINES);
        let by_marks = by_marks.by_ref().map(|line| split(line, self.delimiter));
        let mut are_numbers = by_marks.map(|row| holds_numbers(&row, self.delimiter));
        // A decimal comma parts all rows but the header.
        let is_parted = !are_numbers.next()? && are_numbers.any(|is_of_numbers| is_of_numbers);
        let whole = start.iter().rposition(|byte| *byte == b'\n').filter(|_| !is_parted)?;
        let start = start.get(..=whole)?;
        let text = start.strip_prefix(BYTE_ORDER_MARK).unwrap_or(start);
        let made = tabbed(text);
        let Self { preamble: (bytes, before), .. } = Self::by_marks(&made, b"\t");
        let (above, table) = made.split_at_checked(bytes)?;
        let mut table = rows(table).filter(|line| is_row(line));
        let is_marked = |line: &&[u8]| b",;|".iter().any(|mark| count(line, *mark) > 0);
        let header = split(table.next().filter(|line| !is_marked(line))?, b'\t');
        let below = table.take(LINES).map(|line| split(line, b'\t'));
        let mut below = below.filter(|row| !are_units(row)).peekable();
        below.peek().filter(|_| header.len() > 1 && !holds_numbers(&header, b'\t'))?;
        let is_table = below.all(|row| row.len() == header.len() && holds_numbers(&row, b'\t'));
        // The mark of a comment may stand before the header.
        let is_comment = above.last().is_some_and(|byte| *byte != b'\n');
        let mut lines = text.split_inclusive(|byte| *byte == b'\n');
        let above = lines.by_ref().take(usize::try_from(before).ok()?);
        let skipped: usize = above.map(<[u8]>::len).sum::<usize>() + (start.len() - text.len());
        let header = lines.next()?;
        let row = lines.find(|line| is_row(line) && line.iter().any(u8::is_ascii_digit));
        let mark = header.iter().position(|byte| *byte == b'#').filter(|_| is_comment);
        let bytes = skipped + mark.map_or(0, |mark| mark + 1);
        let is_shifted = mark.is_none() && row.is_some_and(|row| is_shifted(header, row));
        (is_table && !is_shifted).then_some(Self { delimiter: BLANK, preamble: (bytes, before) })
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
            let is_header =
                cells.len() > 1 && cells.len() == row.len() && cells.iter().all(is_name);
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

/// The lines of a text; those that one quoted cell goes over are one. A quotation mark that nothing
/// answers soon is a mark like any other.
fn rows(text: &[u8]) -> impl Iterator<Item = &[u8]> {
    /// Lines of a cell, at most.
    const LINES_OF_CELL: usize = 5;
    let mut rest = text;
    std::iter::from_fn(move || {
        let ends =
            rest.iter().enumerate().filter(|(_, byte)| **byte == b'\n').map(|(at, _)| at + 1);
        let mut ends = ends.take(LINES_OF_CELL);
        let first = ends.next().unwrap_or(rest.len());
        let is_open = |line: &[u8]| line.iter().fold(false, |open, byte| open ^ (*byte == b'"'));
        let is_whole = |end: &usize| rest.get(..*end).is_some_and(|line| !is_open(line));
        let end = std::iter::once(first).chain(ends).find(is_whole).unwrap_or(first);
        let (row, behind) = rest.split_at_checked(end).filter(|(row, _)| !row.is_empty())?;
        rest = behind;
        Some(row)
    })
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

fn line_ends(rows: &[&[u8]]) -> u64 {
    rows.iter().flat_map(|row| row.iter()).fold(0, |ends, byte| ends + u64::from(*byte == b'\n'))
}

/// The cells of a line.
fn split(line: &[u8], delimiter: u8) -> csv::ByteRecord {
    let mut reader = csv::ReaderBuilder::new()
        .delimiter(delimiter)
        .flexible(true)
        .has_headers(false)
        .from_reader(line);
    let mut record = csv::ByteRecord::new();
    // What cannot be parted is no row of numbers.
    let is_row = reader.read_byte_record(&mut record).unwrap_or(false);
    if is_row { record } else { csv::ByteRecord::new() }
}

/// Cells that are not empty.
fn filled(record: &csv::ByteRecord) -> usize {
    record.iter().filter(|cell| !cell.trim_ascii().is_empty()).count()
}

/// Whether most cells of a row are numbers or times, and two at least.
fn holds_numbers(record: &csv::ByteRecord, delimiter: u8) -> bool {
    let is_value = |cell: &[u8]| match parse_time(cell.trim_ascii(), delimiter) {
        Ok(Time::Number(value) | Time::Written(value)) => value.is_finite(),
        Err(_) => false,
    };
    let values = record.iter().filter(|cell| is_value(cell)).count();
    values > 1 && 2 * values > record.len()
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

fn is_row(line: &[u8]) -> bool {
    let line = line.strip_prefix(BYTE_ORDER_MARK).unwrap_or(line);
    !line.starts_with(b"#") && !line.trim_ascii().is_empty()
}

/// Cells of a line, as long as no quotation goes over it; 0 of a line that is no row.
fn cells(line: &[u8], delimiter: u8) -> usize {
    if is_row(line) { 1 + count(line, delimiter) } else { 0 }
}

/// Whether a mark between cells is the last of a line.
fn ends_with(line: &[u8], delimiter: u8) -> bool {
    let line = line.strip_suffix(b"\n").unwrap_or(line);
    line.strip_suffix(b"\r").unwrap_or(line).ends_with(&[delimiter])
}

/// Whether a mark stands behind the last cell of each row below the header and not of the header, or
/// the other way round: it makes no cell.
fn ends_unevenly(lines: &[&[u8]], delimiter: u8) -> bool {
    let rows = lines.iter().filter(|line| cells(line, delimiter) > 1);
    let ends = rows.map(|line| (ends_with(line, delimiter), cells(line, delimiter)));
    let ends: Vec<(bool, usize)> = ends.collect();
    let Some((last, _)) = ends.last() else { return false };
    let Some(header) = ends.iter().rposition(|(ends, _)| ends != last) else { return false };
    let width = |(ends, cells): &(bool, usize)| cells - usize::from(*ends);
    let below = ends.get(header + 1..).unwrap_or_default();
    below.len() > 1
        && below.iter().all(|row| ends.get(header).is_some_and(|it| width(it) == width(row)))
}

/// The count that most rows have.
fn usual(counts: &[usize]) -> usize {
    let rows: Vec<usize> = counts.iter().copied().filter(|count| *count > 0).collect();
    let times = |count: &usize| rows.iter().filter(|other| *other == count).count();
    rows.iter().copied().max_by_key(|count| (times(count), *count)).unwrap_or_default()
}

/// Delimiters of a line, units and quoted cells left out.
fn count(line: &[u8], delimiter: u8) -> usize {
    let mut enclosed = None;
    let mut count = 0;
    for &byte in line {
        enclosed = match (enclosed, byte) {
            (None, b'[') => Some(b']'),
            (None, b'"') => Some(b'"'),
            (Some(end), byte) if end == byte => None,
            (enclosed, _) => enclosed,
        };
        count += usize::from(enclosed.is_none() && delimiter == byte);
    }
    count
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
    let texts: Vec<String> = texts.filter(|text| !text.is_empty()).collect();
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
        assert!(row(&["s", "V", "deg"]) && row(&["[ms]", "(%)", ""]));
        assert!(!row(&["0", "V", "deg"]) && !row(&["", ""]) && !row(&["x", "n/a"]));
    }
}
