//! Rows of a text, before it is known what parts their cells.

use super::super::cell::{Time, parse_time};

pub(super) const BYTE_ORDER_MARK: &[u8] = b"\xef\xbb\xbf";

/// Lines that are looked at to separate the table from what precedes it.
pub(super) const LINES: usize = 200;

/// The lines of a text; those that one quoted cell goes over are one. A quotation mark that nothing
/// answers soon is a mark like any other.
pub(super) fn rows(text: &[u8]) -> impl Iterator<Item = &[u8]> {
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

pub(super) fn line_ends(rows: &[&[u8]]) -> u64 {
    rows.iter().flat_map(|row| row.iter()).fold(0, |ends, byte| ends + u64::from(*byte == b'\n'))
}

/// The cells of a line.
pub(super) fn split(line: &[u8], delimiter: u8) -> csv::ByteRecord {
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
pub(super) fn filled(record: &csv::ByteRecord) -> usize {
    record.iter().filter(|cell| !cell.trim_ascii().is_empty()).count()
}

/// Whether most cells of a row are numbers or times, and two at least.
pub(super) fn holds_numbers(record: &csv::ByteRecord, delimiter: u8) -> bool {
    let is_value = |cell: &[u8]| match parse_time(cell.trim_ascii(), delimiter) {
        Ok(Time::Number(value) | Time::Written(value)) => value.is_finite(),
        Err(_) => false,
    };
    let values = record.iter().filter(|cell| is_value(cell)).count();
    values > 1 && 2 * values > record.len()
}

pub(super) fn is_row(line: &[u8]) -> bool {
    let line = line.strip_prefix(BYTE_ORDER_MARK).unwrap_or(line);
    !line.starts_with(b"#") && !line.trim_ascii().is_empty()
}

/// Cells of a line, as long as no quotation goes over it; 0 of a line that is no row.
pub(super) fn cells(line: &[u8], delimiter: u8) -> usize {
    if is_row(line) { 1 + count(line, delimiter) } else { 0 }
}

/// Whether a mark between cells is the last of a line.
pub(super) fn ends_with(line: &[u8], delimiter: u8) -> bool {
    let line = line.strip_suffix(b"\n").unwrap_or(line);
    line.strip_suffix(b"\r").unwrap_or(line).ends_with(&[delimiter])
}

/// Whether a mark stands behind the last cell of each row below the header and not of the header, or
/// the other way round: it makes no cell.
pub(super) fn ends_unevenly(lines: &[&[u8]], delimiter: u8) -> bool {
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
pub(super) fn usual(counts: &[usize]) -> usize {
    let rows: Vec<usize> = counts.iter().copied().filter(|count| *count > 0).collect();
    let times = |count: &usize| rows.iter().filter(|other| *other == count).count();
    rows.iter().copied().max_by_key(|count| (times(count), *count)).unwrap_or_default()
}

/// Delimiters of a line, units and quoted cells left out: from a bracket, or a quotation mark that begins
/// a cell, to the one that answers it, where one does.
pub(super) fn count(line: &[u8], delimiter: u8) -> usize {
    let last_quotation = line.iter().rposition(|byte| *byte == b'"').unwrap_or(0);
    let (mut at, mut count, mut begins) = (0, 0, true);
    while let Some(&byte) = line.get(at) {
        at += 1;
        let behind = line.get(at..).unwrap_or_default();
        let answer = match byte {
            // One that comes before the answer is the beginning of another unit.
            b'[' => behind
                .iter()
                .position(|byte| b"[]".contains(byte))
                .filter(|place| behind.get(*place) == Some(&b']')),
            b'"' if begins && at <= last_quotation => behind.iter().position(|byte| *byte == b'"'),
            _ => None,
        };
        if let Some(answer) = answer {
            at += answer + 1;
            begins = false;
        } else {
            count += usize::from(byte == delimiter);
            begins = byte == delimiter || begins && byte.is_ascii_whitespace();
        }
    }
    count
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn marks_within_units_and_quoted_cells_part_nothing() {
        for (line, marks) in [
            ("t,u [a,b],y", 2),
            ("t,\"u, V\", \"y, deg\"", 2),
            ("t,u [V,y", 2),
            ("t,a\"b,c\"d", 2),
            ("t,\"open,y", 2),
            ("t,u [V,y [deg],z [a,b]", 3),
        ] {
            assert_eq!(count(line.as_bytes(), b','), marks, "{line}");
        }
        assert_eq!(count(&vec![b'['; 100_000], b','), 0);
    }
}
