//! The header of a table of text, and its units.

use super::super::spelling::{are_units, bare_unit, is_remark};
use crate::experiment::error::ReadError;
use crate::experiment::table::{Head, Header};
use crate::experiment::time_column::find_time_column;
use crate::experiment::unit::{is_time, is_unit};

/// What a text is expected to be.
const A_TABLE: &str = "a table of text";

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
    let Some((last, named)) = head.headers.split_last() else { return Ok(()) };
    let names = named.len();
    let is_filled = first.get(names).is_some_and(|cell| !cell.trim_ascii().is_empty());
    if names == 0 || !last.text.is_empty() || first.len() != names + 1 || !is_filled {
        return Ok(());
    }
    let (header, cells) = (head.header_row, first.len());
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

/// What the header says, which stands on the line `header_row`. Refuses one of more cells than a log has columns,
/// which a row of commas is, too.
pub(super) fn head(record: &csv::ByteRecord, header_row: u64) -> Result<Head, ReadError> {
    /// Ten times as many as a large plant has signals (chosen).
    const MOST: usize = 1_000_000;
    if record.len() > MOST {
        let reason = format!("its header has {} cells; at most {MOST} are read", record.len());
        return Err(ReadError::format(A_TABLE, reason, "leave out columns"));
    }
    let mut headers = Vec::new();
    for (cell, column) in record.iter().zip(1..) {
        let Ok(text) = std::str::from_utf8(cell) else {
            let text = format!(
                "the name of column {column} is not UTF-8 text; choose UTF-8 when saving it"
            );
            return Err(ReadError::content(text).in_row(header_row));
        };
        headers.push(Header::parse(unquoted(text)));
    }
    Ok(Head { headers, header_row, unread: Vec::new() })
}
