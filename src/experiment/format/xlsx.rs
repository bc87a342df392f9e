//! Sheets of a spreadsheet program: the one that is most like a log, as text.

use std::fmt::Display;
use std::fs::File;
use std::io::{BufReader, Read as _};
use std::path::Path;

use calamine::{
    Cell, Data, ExcelDateTime, Range, Reader as _, SheetType, SheetVisible, Xlsx, XlsxError,
    open_workbook,
};
use zip::ZipArchive;

use super::cell::parse_time;
use super::csv::table;
use super::date::{DAY, date_of_days, days_since_1970};
use super::text::Bytes;
use crate::experiment::error::ReadError;
use crate::experiment::memory::Budget;
use crate::experiment::names::on_one_line;
use crate::experiment::table::{Opened, Wanted};
use crate::experiment::time_column::find_time_column;
use crate::numerics::to_decimals;

/// Sheets of a workbook, at most: those before that of the log are read in vain.
const MOST_SHEETS: usize = 100;

/// Memory of a cell: itself, its place and a short text, once as it is read and once in its table.
const CELL_SIZE: u64 = 96;

type Workbook = Xlsx<BufReader<File>>;

/// Opens the workbook and reads the header of the first sheet with a column of times, else of the first
/// one with numbers, else of the first one with rows, to say what is wrong with it.
pub(super) fn open(path: &Path, budget: &Budget) -> Result<Opened, ReadError> {
    let parts = check_parts(path, budget)?;
    let mut workbook: Workbook = open_workbook(path).map_err(|error: XlsxError| damaged(error))?;
    let names = sheets(&workbook);
    let count = names.len();
    if count > MOST_SHEETS {
        return Err(damaged(format!("{count} sheets; {MOST_SHEETS} are the most")));
    }
    // Each sheet that shares the part of another would be unpacked again.
    if count > parts {
        return Err(damaged("two of its sheets are one part of the file"));
    }
    let (mut numbers, mut rows) = (None, None);
    for name in names {
        let range = cells(&mut workbook, &name, budget)?;
        if range.height() < 2 {
            continue;
        }
        let found = of_sheet(&range, &name, count, budget);
        if !range.rows().any(|row| row.iter().filter(|cell| is_value(cell)).count() > 1) {
            rows = rows.or(Some(found));
        } else if found.as_ref().is_ok_and(|(head, _)| find_time_column(head).is_some()) {
            return found;
        } else {
            numbers = numbers.or(Some(found));
        }
    }
    let nothing = || Err(damaged("no sheet has a header and a row"));
    numbers.or(rows).unwrap_or_else(nothing)
}

fn damaged(reason: impl Display) -> ReadError {
    ReadError::format("XLSX", reason, "save it again as .xlsx, or as CSV")
}

/// The names of the sheets with cells; what is hidden is read where nothing else is there.
fn sheets(workbook: &Workbook) -> Vec<String> {
    let mut sheets = workbook.sheets_metadata().to_vec();
    sheets.retain(|sheet| sheet.typ != SheetType::ChartSheet);
    sheets.sort_by_key(|sheet| sheet.visible != SheetVisible::Visible);
    sheets.into_iter().map(|sheet| sheet.name).collect()
}

/// Whether a cell may be one of a log: a number, a date, or a formula for one.
fn is_value(cell: &Data) -> bool {
    match cell {
        Data::Float(_) | Data::Int(_) | Data::DateTime(_) => true,
        Data::String(text) => text == NO_VALUE || parse_time(text.trim().as_bytes(), b';').is_ok(),
        _ => false,
    }
}

/// Reads the header of a sheet, one of `count`, as that of a text with commas.
fn of_sheet(
    range: &Range<Data>,
    name: &str,
    count: usize,
    budget: &Budget,
) -> Result<Opened, ReadError> {
    let text = text_of(range).map_err(damaged)?;
    budget.take(text.len() as u64)?;
    let (bytes, start) = Bytes::made(text);
    let (head, read_rows) = table(bytes, &start, Some(b','), budget)?;
    let note = format!("the sheet `{}` of {count} is read", on_one_line(name));
    let read_rows = move |wanted: &Wanted<'_>| {
        let mut table = read_rows(wanted)?;
        table.notes.extend((count > 1).then_some(note));
        Ok(table)
    };
    Ok((head, Box::new(read_rows)))
}

/// Stands for the value of a formula that the program which wrote it did not work out.
const NO_VALUE: &str = "a formula without a value: open and save";

/// How many parts of the file may be sheets.
///
/// Each part is unpacked once, and memory asked for what the crate calamine 0.38 takes for it: what a part says
/// of its size is not trusted. Refuses what cannot be unpacked, or whose checksum is another.
fn check_parts(path: &Path, budget: &Budget) -> Result<usize, ReadError> {
    // What is no archive is refused by the crate.
    let Ok(mut archive) = ZipArchive::new(File::open(path)?) else { return Ok(0) };
    let (mut sheets, mut memory) = (0, 0);
    for index in 0..archive.len() {
        let Ok(mut part) = archive.by_index(index) else { continue };
        let name = part.name().map(|name| name.to_ascii_lowercase()).unwrap_or_default();
        let (is_texts, is_styles) =
            (name.ends_with("sharedstrings.xml"), name.ends_with("styles.xml"));
        let is_sheet = name.contains("sheets/") && !name.contains("_rels/");
        let size = if is_sheet || is_texts { SHEET_SIZE } else { PART_SIZE };
        let mut inside = Vec::new();
        let read = part.by_ref().take(budget.left() / size + 1).read_to_end(&mut inside);
        read.map_err(|error| damaged(format!("its part `{name}`: {error}")))?;
        memory += inside.len() as u64 * size;
        budget.check(memory)?;
        sheets += usize::from(is_sheet);
        if is_texts {
            // They stay while cells are read that share them.
            let count = stated_texts(&inside).max(count_of(&inside, b"<si"));
            budget.take(count.saturating_mul(TEXT_SIZE).saturating_add(inside.len() as u64))?;
        }
        if is_styles {
            budget.check(size_of_styles(&inside))?;
        }
    }
    Ok(sheets)
}

/// The cells of a sheet. The crate keeps all between the first and the last, for which memory is asked
/// before.
fn cells(workbook: &mut Workbook, name: &str, budget: &Budget) -> Result<Range<Data>, ReadError> {
    let mut reader = workbook.worksheet_cells_reader(name).map_err(damaged)?;
    let (mut found, mut texts) = (Vec::new(), 0);
    let (mut first, mut last) = ((u32::MAX, u32::MAX), (0, 0));
    while let Some(cell) = reader.next_cell_with_formula_metadata().map_err(damaged)? {
        let value = match Data::from(cell.value) {
            Data::Empty if cell.formula.is_some() => Data::String(NO_VALUE.to_owned()),
            Data::Empty => continue,
            value => value,
        };
        // A text that many cells share is repeated in each.
        if let Data::String(text) = &value {
            texts += 2 * text.len() as u64;
        }
        let (row, column) = cell.pos;
        first = (row.min(first.0), column.min(first.1));
        last = (row.max(last.0), column.max(last.1));
        found.push(Cell::new(cell.pos, value));
        budget.check(found.len() as u64 * CELL_SIZE + texts)?;
    }
    let length = |first: u32, last: u32| u64::from(last.saturating_sub(first)) + 1;
    let all = length(first.0, last.0).saturating_mul(length(first.1, last.1));
    budget.check(all.saturating_mul(CELL_SIZE).saturating_add(texts))?;
    Ok(Range::from_sparse(found))
}

/// Memory for a byte of a part that is read piece by piece: elements of three bytes that are not ended
/// take two words each.
const SHEET_SIZE: u64 = 6;

/// Memory for a byte of a part that lists names: relationships, formats, names of ranges (measured: 4 to 9
/// times their size).
const PART_SIZE: u64 = 10;

/// Memory of a text that cells share beside its letters: itself, and what the allocator adds.
const TEXT_SIZE: u64 = size_of::<String>() as u64 + 32;

/// How often `mark` stands in `part`.
fn count_of(part: &[u8], mark: &[u8]) -> u64 {
    part.windows(mark.len()).filter(|text| *text == mark).count() as u64
}

/// How many texts their list says that there are (`count`, `uniqueCount`): calamine 0.38 takes memory
/// for them before it has seen one.
fn stated_texts(part: &[u8]) -> u64 {
    let mut most = 0;
    for (at, _) in part.windows(4).enumerate().filter(|(_, text)| *text == b"ount") {
        let behind = part.iter().skip(at + 4);
        let behind = behind.skip_while(|byte| b"=\"' \t\r\n".contains(byte));
        let digits = behind.take_while(|byte| byte.is_ascii_digit());
        let digit = |number: u64, digit: &u8| {
            number.saturating_mul(10).saturating_add(u64::from(digit - b'0'))
        };
        most = most.max(digits.fold(0, digit));
    }
    most
}

/// At most so many bytes that calamine 0.38 takes for the styles of cells, each of which has a copy of
/// its format: as many as there are, of the longest one.
fn size_of_styles(part: &[u8]) -> u64 {
    let longest = part.split(|byte| *byte == b'"').map(<[u8]>::len).max().unwrap_or(0) as u64;
    count_of(part, b"xf").saturating_mul(longest)
}

/// The cells of a sheet, each row on the line of its number.
fn text_of(range: &Range<Data>) -> std::io::Result<Vec<u8>> {
    let first = range.start().map_or(0, |(row, _)| row as usize);
    let mut text = "\n".repeat(first).into_bytes();
    for row in range.rows() {
        if row.iter().all(|cell| matches!(cell, Data::Empty)) {
            text.push(b'\n');
            continue;
        }
        // What begins with `#` is no remark in a sheet.
        let mut line = csv::WriterBuilder::new().comment(Some(b'#')).from_writer(&mut text);
        line.write_record(row.iter().map(cell)).map_err(std::io::Error::other)?;
        line.flush()?;
    }
    Ok(text)
}

/// Days from the first of January 1900, as spreadsheets count, to 1970.
const DAYS_TO_1970: f64 = 25_569.0;

/// Days since 1970 of a date: books count from 1900 or, those of older Macintoshes, from 1904, which
/// only its day in the calendar shows.
fn days_of(time: &ExcelDateTime) -> f64 {
    const DAYS_FROM_1900_TO_1904: f64 = 1462.0;
    let from_1900 = time.as_f64() - DAYS_TO_1970;
    let (year, month, day, ..) = time.to_ymd_hms_milli();
    let Some(days) = days_since_1970(year, month, day) else { return from_1900 };
    let apart = days - from_1900;
    from_1900 + DAYS_FROM_1900_TO_1904 * (apart / DAYS_FROM_1900_TO_1904).round()
}

/// A cell as text: numbers with all their digits, dates as text, which is no value of a signal.
fn cell(data: &Data) -> String {
    match data {
        Data::Empty => String::new(),
        // Numbers of hundreds of digits have an exponent so.
        Data::Float(value) => format!("{value:?}").trim_end_matches(".0").to_owned(),
        Data::Int(value) => value.to_string(),
        Data::Bool(value) => u8::from(*value).to_string(),
        Data::DateTime(time) => {
            /// Days of the first of March 1900: before it times of day are shown, and no dates.
            const FIRST_DATES: f64 = 61.0;
            if time.is_datetime() && time.as_f64() >= FIRST_DATES {
                date_of_days(days_of(time)).unwrap_or_else(|| one_line(data))
            } else {
                // To the microsecond, below which a number of days is rounded.
                format!("{} s", to_decimals(time.as_f64() * DAY, 6))
            }
        }
        other => one_line(other),
    }
}

/// What a cell says: a line of the text is a row of the sheet.
fn one_line(data: &Data) -> String {
    data.to_string().replace(['\n', '\r'], " ")
}

#[cfg(test)]
mod tests {
    use calamine::ExcelDateTimeType;

    use super::*;

    #[test]
    fn dates_of_both_epochs_are_the_same_days() {
        // Noon of the first of March 2024, and a millisecond before the midnight after it.
        for part in [0.5, 1.0 - 1.0 / 86_400_000.0] {
            let from_1900 = 45_352.0 + part;
            let date = |value, is_1904| {
                let kind = ExcelDateTimeType::DateTime;
                days_of(&ExcelDateTime::new(value, kind, is_1904))
            };
            let days = 19_783.0 + part;
            assert!((date(from_1900, false) - days).abs() < 1e-9);
            assert!((date(from_1900 - 1462.0, true) - days).abs() < 1e-9);
        }
    }

    #[test]
    fn a_date_is_text_and_no_number() {
        let text = |value, kind| cell(&Data::DateTime(ExcelDateTime::new(value, kind, false)));
        let noon = 45_352.5 + 0.25 / 86_400.0;
        let date = text(noon, ExcelDateTimeType::DateTime);
        assert!(date.starts_with("2024-03-01T12:00:00.25"), "{date}");
        assert_eq!(text(1.0 + 0.25 / 86_400.0, ExcelDateTimeType::TimeDelta), "86400.25 s");
        let just_before = (3_600.0 - 1e-9) / 86_400.0;
        assert_eq!(text(just_before, ExcelDateTimeType::TimeDelta), "3600 s");
        assert_eq!(text(just_before, ExcelDateTimeType::DateTime), "3600 s");
        assert_eq!(cell(&Data::Float(0.5)), "0.5");
    }
}
