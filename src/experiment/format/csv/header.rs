//! The header of a table of text, and its units.

use super::super::spelling::{are_units, bare_unit, is_remark};
use crate::experiment::error::{ReadError, ReadErrorKind};
use crate::experiment::table::{Head, Header};
use crate::experiment::time_column::find_time_column;
use crate::experiment::unit::{is_time, is_unit};

/// What a text is expected to be.
const A_TABLE: &str = "a table of text";

/// Refuses a header of more cells than a log has columns, which a row of commas is, too.
pub(super) fn check_header_size(cells: usize) -> Result<(), ReadError> {
    /// Ten times as many as a large plant has signals (chosen).
    const MOST: usize = 1_000_000;
    if cells > MOST {
        let reason = format!("its header has {cells} cells; at most {MOST} are read");
        return Err(ReadError::format(A_TABLE, reason, "leave out columns"));
    }
    Ok(())
}

/// A name without the quotation marks that a blank before them makes part of the cell, or single ones.
fn unquoted(cell: &str) -> &str {
    let inner = |mark: char| cell.trim().strip_prefix(mark)?.strip_suffix(mark);
    inner('"').or_else(|| inner('\'')).unwrap_or(cell)
}

/// Refuses a table whose first row of numbers, `first`, has one cell more than there are names: the header
/// ends with a mark, and it is not known which cell is too many.
pub(super) fn check_last_name(
    head: &Head,
    first: &csv::ByteRecord,
    row: u64,
) -> Result<(), ReadError> {
    let (cells, names) = (head.headers.len(), head.headers.len().saturating_sub(1));
    let is_nameless = names > 0 && head.headers.last().is_some_and(|last| last.text.is_empty());
    let is_filled = first.get(names).is_some_and(|cell| !cell.trim_ascii().is_empty());
    if !is_nameless || first.len() != cells || !is_filled {
        return Ok(());
    }
    let header = head.header_row;
    let reason = format!(
        "row {header} has {names} names and a separator after the last, and row {row} has {cells} cells"
    );
    Err(ReadError::format(A_TABLE, reason, "name each column"))
}

/// Rows of words that may stand between the header and the first row of numbers.
const MOST_ABOVE: usize = 3;

/// Whether a row below the header, with so many `before` it, holds no numbers but its units, or what
/// else a logger says of its columns, as the types of their numbers. The units in it are then those of
/// the columns that have none.
pub(super) fn describes(
    head: &mut Head,
    record: &csv::ByteRecord,
    delimiter: u8,
    before: usize,
) -> bool {
    let are_all_units = are_units(record);
    if before >= MOST_ABOVE || !are_all_units && !is_remark(record, delimiter) {
        return false;
    }
    let time = find_time_column(head);
    for (column, (header, cell)) in head.headers.iter_mut().zip(record).enumerate() {
        let unit = bare_unit(&String::from_utf8_lossy(cell));
        let is_of_time = time == Some(column) && is_time(&unit);
        let is_none = unit.is_empty() || unit == "-";
        let is_meant = !is_none && (are_all_units || is_unit(&unit)) || is_of_time;
        if header.unit.is_none() && is_meant {
            header.unit = Some(unit);
        }
    }
    true
}

/// What the header says, which stands on the line `header_row`.
pub(super) fn head(record: &csv::ByteRecord, header_row: u64) -> Result<Head, ReadError> {
    let header = |(cell, column): (&[u8], usize)| {
        let text = std::str::from_utf8(cell).ok().map(unquoted).map(Header::parse);
        text.ok_or_else(|| {
            let text = format!(
                "the name of column {column} is not UTF-8 text; choose UTF-8 when saving it"
            );
            ReadError::new(ReadErrorKind::Content, text).in_row(header_row)
        })
    };
    let headers = record.iter().zip(1..).map(header).collect::<Result<_, _>>()?;
    Ok(Head { headers, header_row, unread: Vec::new() })
}
