//! How a table of text is written: what parts its cells, and where its header is.

use super::cell::{Time, is_of_thousands, parse_time};
use super::line::{BLANK, part};
use crate::experiment::unit::is_unit;

/// What parts the cells, and what stands before the header.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Spelling {
    /// The mark between cells, or [`BLANK`].
    pub(super) delimiter: u8,
    /// Bytes and lines before the header that belong to no table.
    pub(super) preamble: (usize, u64),
}

/// What may part the cells, the least likely first.
const MARKS: [u8; 5] = [BLANK, b'|', b'\t', b';', b','];

/// Lines that are looked at.
const LINES: usize = 400;

/// What ends the lines before a table of LabVIEW (`.lvm`): once for the file, once for the table.
const LABVIEW: (&[u8], &[u8]) = (b"LabVIEW Measurement", b"***End_of_Header***");

impl Spelling {
    /// How a text is written that starts so, its cells parted by `delimiter` where that is known.
    ///
    /// Of all marks the right one makes the most numbers, in rows as wide as a header above them.
    pub(super) fn of(start: &[u8], delimiter: Option<u8>) -> Self {
        let marks = delimiter.as_ref().map_or(&MARKS[..], std::slice::from_ref);
        if let Some(preamble) = behind_labview(start) {
            let below = start.get(preamble.0..).unwrap_or_default();
            return Self { delimiter: most_cells(below, marks), preamble };
        }
        // The last line may be cut off.
        let end = start.iter().rposition(|byte| *byte == b'\n').map_or(start.len(), |end| end + 1);
        let lines: Vec<&[u8]> = rows(start.get(..end).unwrap_or_default()).take(LINES).collect();
        let found = marks.iter().filter_map(|mark| Found::by(*mark, &lines));
        let best = found.max_by(|a, b| {
            a.has_header.cmp(&b.has_header).then_with(|| a.numbers.total_cmp(&b.numbers))
        });
        let plain = || Self { delimiter: most_cells(start, marks), preamble: (0, 0) };
        best.map_or_else(plain, |best| best.spelling)
    }
}

/// A table that one of the marks makes of a text.
struct Found {
    spelling: Spelling,
    /// Whether the header has a cell for each column.
    has_header: bool,
    /// Rows of numbers, each counted as the part of its cells that are numbers: a decimal comma parts rows
    /// as evenly as a mark between cells does, but makes fewer numbers.
    numbers: f64,
}

/// A line as a mark parts it.
struct Row {
    /// No cells where it is blank or a comment.
    cells: csv::ByteRecord,
    numbers: usize,
}

impl Found {
    fn by(mark: u8, lines: &[&[u8]]) -> Option<Self> {
        let rows: Vec<Row> = lines.iter().map(|line| Row::of(line, mark)).collect();
        let width = usual_width(&rows)?;
        let is_of_table = |row: &Row| row.is_of_numbers() && row.cells.len() == width;
        let part = |row: &Row| row.numbers as f64 / filled(&row.cells) as f64;
        let numbers = rows.iter().filter(|row| is_of_table(row)).map(part).sum();
        let first = rows.iter().position(is_of_table)?;
        let (above, below) = rows.split_at_checked(first)?;
        let ends_blank = below.first()?.cells.iter().next_back().is_some_and(<[u8]>::is_empty);
        let header = header_among(above, (width, ends_blank), mark).map(|at| (at, 0, true));
        let marked = || {
            let (mark_at, cells) = marked_header(lines.get(first.checked_sub(1)?)?, mark)?;
            Some((first - 1, mark_at, cells == width))
        };
        // A header of another width is refused with its row.
        let words = || (above.iter().rposition(Row::is_of_words).unwrap_or(first), 0, false);
        let (at, mark_at, has_header) = header.or_else(marked).unwrap_or_else(words);
        let before = lines.get(..at)?;
        if mark == BLANK && !(has_header && is_of_plain_words(lines.get(at)?, lines.get(first)?)) {
            return None;
        }
        let bytes = before.iter().map(|line| line.len()).sum::<usize>() + mark_at;
        let spelling = Spelling { delimiter: mark, preamble: (bytes, line_ends(before)) };
        Some(Self { spelling, has_header, numbers })
    }
}

impl Row {
    fn of(line: &[u8], mark: u8) -> Self {
        let cells = if is_row(line) { split(line, mark) } else { csv::ByteRecord::new() };
        let is_value = |cell: &&[u8]| {
            let time = parse_time(cell.trim_ascii(), mark);
            matches!(time, Ok(Time::Number(value) | Time::Written(value)) if value.is_finite())
        };
        Self { numbers: cells.iter().filter(is_value).count(), cells }
    }

    fn is_of_numbers(&self) -> bool {
        self.numbers > 1
    }

    fn is_of_words(&self) -> bool {
        self.cells.len() > 1 && !self.is_of_numbers()
    }
}

/// The number of cells that most rows of numbers have.
fn usual_width(rows: &[Row]) -> Option<usize> {
    let rows = rows.iter().filter(|row| row.is_of_numbers());
    let widths: Vec<usize> = rows.map(|row| row.cells.len()).collect();
    let times = |width: &usize| widths.iter().filter(|other| *other == width).count();
    widths.iter().copied().max_by_key(|width| (times(width), *width))
}

/// Which of the rows above those of numbers is the header: the fullest one, as lines before a table may be
/// padded to its width; of several the first, since what is below it says more of its columns.
fn header_among(above: &[Row], (width, ends_blank): (usize, bool), mark: u8) -> Option<usize> {
    let mut found: Option<(usize, usize)> = None;
    for (at, Row { cells, numbers }) in above.iter().enumerate().rev() {
        // What has numbers and stands above a header says something of the whole log: `Rate,100,Hz`.
        if found.is_some() && *numbers > 0 {
            break;
        }
        // A mark after the last cell makes none.
        let has_one_more =
            cells.len() == width + 1 && cells.iter().next_back().is_some_and(<[u8]>::is_empty);
        let has_one_less = cells.len() + 1 == width && ends_blank;
        if cells.len() == width || has_one_more || has_one_less {
            let is_fuller = found.is_none_or(|(_, most)| filled(cells) >= most);
            // Between blanks, words above the header are as many as its names by chance only.
            if !are_units(cells) && is_fuller && (mark != BLANK || found.is_none()) {
                found = Some((at, filled(cells)));
            }
        } else if found.is_some() || !cells.is_empty() && *numbers < 2 {
            break;
        }
    }
    found.map(|(at, _)| at)
}

/// Where the names begin in a comment above rows of numbers, as NumPy writes a header: `# time,u,y`; and how
/// many they are.
fn marked_header(comment: &[u8], mark: u8) -> Option<(usize, usize)> {
    let begin = comment.iter().position(|byte| !byte.is_ascii_whitespace())?;
    let names = split(comment.get(begin..)?.strip_prefix(b"#")?, mark);
    let is_name = |cell: &[u8]| parse_time(cell.trim_ascii(), mark).is_err();
    // The mark may be the name of a column of numbers of rows.
    let mut cells = names.iter().enumerate();
    let are_names = cells.all(|(column, cell)| is_name(cell) || column == 0 && cell.is_empty());
    (are_names && names.len() > 1).then_some((begin + 1, names.len()))
}

/// Whether nothing but blanks parts the names of a header, and the first value of a `row` stands below the
/// first name: else the name of the last column has nothing below it.
fn is_of_plain_words(header: &[u8], row: &[u8]) -> bool {
    let is_marked =
        |name: &[u8]| !name.contains(&b'[') && name.iter().any(|byte| b",;|".contains(byte));
    if split(header, BLANK).iter().any(is_marked) {
        return false;
    }
    let word = |line: &[u8], from: usize| {
        let begin = from + line.get(from..)?.iter().position(|byte| !b" \t".contains(byte))?;
        let length = line.get(begin..)?.iter().position(|byte| b" \t".contains(byte))?;
        Some((begin, begin + length))
    };
    let is_shifted = || {
        let (name, name_end) = word(header, 0).filter(|_| !header.contains(&b'#'))?;
        let (_, end) = word(row, 0)?;
        let (second, _) = word(row, end)?;
        Some(end < name && second < name_end)
    };
    !is_shifted().unwrap_or(false)
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

fn is_row(line: &[u8]) -> bool {
    let line = line.trim_ascii();
    !line.starts_with(b"#") && !line.is_empty()
}

fn line_ends(rows: &[&[u8]]) -> u64 {
    rows.iter().flat_map(|row| row.iter()).fold(0, |ends, byte| ends + u64::from(*byte == b'\n'))
}

/// The cells of a line.
fn split(line: &[u8], mark: u8) -> csv::ByteRecord {
    let mut cells = csv::ByteRecord::new();
    part(line, mark, &mut cells);
    cells
}

/// Cells that are not empty.
fn filled(record: &csv::ByteRecord) -> usize {
    record.iter().filter(|cell| !cell.trim_ascii().is_empty()).count()
}

/// The one of `marks` that makes the most cells of the first line that is no comment.
fn most_cells(text: &[u8], marks: &[u8]) -> u8 {
    let line = rows(text).find(|line| is_row(line)).unwrap_or_default();
    let marks = marks.iter().copied().filter(|mark| *mark != BLANK);
    marks.max_by_key(|mark| split(line, *mark).len()).unwrap_or(b',')
}

/// Whether a row says something, and no cell of it is a number or a time: the words below a table.
pub(super) fn is_remark(record: &csv::ByteRecord, delimiter: u8) -> bool {
    let cells = record.iter().map(<[u8]>::trim_ascii).filter(|cell| !cell.is_empty());
    let mut cells = cells.peekable();
    cells.peek().is_some()
        && cells.all(|cell| parse_time(cell, delimiter).is_err() && !is_of_thousands(cell))
        && !is_over_lines(record)
}

/// Whether a cell goes over several lines: after a quotation mark that is never closed lies the
/// rest of the table.
pub(super) fn is_over_lines(record: &csv::ByteRecord) -> bool {
    record.iter().any(|cell| cell.trim_ascii().contains(&b'\n'))
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

/// Where the table of a log of LabVIEW begins, in bytes and in lines.
fn behind_labview(start: &[u8]) -> Option<(usize, u64)> {
    let (first, end) = LABVIEW;
    let lines: Vec<&[u8]> = rows(start).collect();
    lines.first().filter(|line| line.starts_with(first))?;
    // One for the file and one for its first table: of more tables the next header is a row that is wrong.
    let ends = lines.iter().enumerate().filter(|(_, line)| line.starts_with(end));
    let (last, _) = ends.take(2).last()?;
    let before = lines.get(..=last)?;
    Some((before.iter().map(|line| line.len()).sum(), line_ends(before)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_delimiter_is_told_from_the_header() {
        for (text, mark) in [
            ("# a, b, c\n\nt;a.input;a.output\n1;2;3", b';'),
            ("t\ta,b\tc", b'\t'),
            ("single", b','),
            ("t,x [a;b;c]\n0,1\n", b','),
            // Decimal commas part the rows as evenly.
            ("t;mode;u\n0,1;ok;2,5\n0,2;ok;2,5\n", b';'),
            ("t;u;y\n0,1;;2,5\n0,2;1,5;2,5\n0,3;;2,5\n", b';'),
        ] {
            assert_eq!(Spelling::of(text.as_bytes(), None).delimiter, mark, "{text:?}");
        }
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
        // Names of several words, dates and marks between cells make other tables.
        for text in [
            format!("time in s  u y\n{rows}"),
            "time u y\n2024-05-01 12:00:00 1 2\n2024-05-01 12:00:01 1 2\n".to_owned(),
            "t s;u V\n0 1\n0 2\n".to_owned(),
            "     t  u  y note\n0 0.0  1  2\n1 0.1  1  2\n".to_owned(),
        ] {
            assert!(Spelling::of(text.as_bytes(), None).delimiter != BLANK, "{text:?}");
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
