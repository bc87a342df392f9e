//! Sheets of a spreadsheet program: the first one with rows, as text.

use std::path::Path;

use calamine::{Data, Range, Reader as _, Xlsx, open_workbook};

use super::csv::table;
use super::text::Bytes;
use crate::experiment::error::ReadError;
use crate::experiment::table::OpenTable;

/// Opens the workbook and reads the header of its first sheet that holds rows.
pub(super) fn open(path: &Path) -> Result<OpenTable, ReadError> {
    let damaged = |reason: String| ReadError::Format {
        path: path.to_owned(),
        format: "XLSX",
        reason,
        remedy: "save it again as .xlsx, or as CSV",
    };
    let mut workbook: Xlsx<_> =
        open_workbook(path).map_err(|error: calamine::XlsxError| damaged(error.to_string()))?;
    for name in workbook.sheet_names() {
        let range = workbook.worksheet_range(&name).map_err(|error| damaged(error.to_string()))?;
        if range.height() > 1 {
            let text = text_of(&range).map_err(|error| damaged(error.to_string()))?;
            let (bytes, start) = Bytes::made(text, path);
            return table(path, bytes, &start);
        }
    }
    Err(damaged("no sheet has a header and a row".to_owned()))
}

/// The cells of a sheet, each row on the line of its number.
fn text_of(range: &Range<Data>) -> std::io::Result<Vec<u8>> {
    let first = range.start().map_or(0, |(row, _)| row as usize);
    let mut text = "\n".repeat(first).into_bytes();
    for row in range.rows() {
        let mut line = csv::Writer::from_writer(Vec::new());
        line.write_record(row.iter().map(cell)).map_err(std::io::Error::other)?;
        let line = line.into_inner().map_err(|error| std::io::Error::other(error.to_string()))?;
        let empty = row.iter().all(|cell| matches!(cell, Data::Empty));
        text.extend_from_slice(if empty { b"\n" } else { &line });
    }
    Ok(text)
}

/// A cell as text: numbers with all their digits, dates as seconds since 1970.
fn cell(data: &Data) -> String {
    /// Days from the first of January 1900, as spreadsheets count, to 1970.
    const DAYS_TO_1970: f64 = 25_569.0;
    const SECONDS: f64 = 86_400.0;
    match data {
        Data::Empty => String::new(),
        Data::Float(value) => value.to_string(),
        Data::Int(value) => value.to_string(),
        Data::Bool(value) => u8::from(*value).to_string(),
        Data::DateTime(time) if time.is_datetime() => {
            ((time.as_f64() - DAYS_TO_1970) * SECONDS).to_string()
        }
        Data::DateTime(time) => (time.as_f64() * SECONDS).to_string(),
        // A line of the text is a row of the sheet.
        other => other.to_string().replace(['\n', '\r'], " "),
    }
}
