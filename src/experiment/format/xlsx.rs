//! Sheets of a spreadsheet program: the first one with rows, as text.

use std::collections::BTreeSet;
use std::fs::File;
use std::io::{BufReader, Read as _};
use std::path::{Path, PathBuf};

use calamine::{
    Data, DataRef, ExcelDateTime, Range, Reader as _, Sheet, SheetType, SheetVisible, Xlsx,
    XlsxError, open_workbook,
};
use zip::ZipArchive;

use super::cell::parse_time;
use super::csv::table;
use super::date::{date_of_days, days_since_1970, passed_of_days};
use super::text::Bytes;
use crate::experiment::error::ReadError;
use crate::experiment::memory::{Budget, TooLarge};
use crate::experiment::names::on_one_line;
use crate::experiment::table::{Head, Header, OpenTable, Rows, Table, Wanted};
use crate::experiment::time_column::find_time_column;

/// Opens the workbook and reads the header of its first sheet that holds rows.
pub(super) fn open(path: &Path, budget: Budget) -> Result<OpenTable, ReadError> {
    let damaged = |reason: String| damaged(path, reason);
    let texts = check_unpacked(path, &budget)?;
    // They stay while cells are read that share them.
    budget.take(texts).map_err(|error| error.refuse(path))?;
    let mut workbook: Xlsx<_> =
        open_workbook(path).map_err(|error: XlsxError| damaged(error.to_string()))?;
    let hidden = |sheet: &Sheet| sheet.visible != SheetVisible::Visible;
    // Charts have no cells.
    let sheets = workbook.sheets_metadata().iter().filter(|it| it.typ != SheetType::ChartSheet);
    let (hidden, visible): (Vec<_>, Vec<_>) = sheets.cloned().partition(hidden);
    // What is hidden is read where nothing else is there.
    let names: Vec<String> = visible.into_iter().chain(hidden).map(|sheet| sheet.name).collect();
    let count = names.len();
    if count > MOST_SHEETS {
        return Err(damaged(format!("{count} sheets; {MOST_SHEETS} are the most")));
    }
    check_unshared(path).map_err(damaged)?;
    let mut read = |name: &String| {
        check_size(&mut workbook, name, &budget)
            .map_err(|error| damaged(error.to_string()))?
            .map_err(|error| error.refuse(path))?;
        workbook.worksheet_range(name).map_err(|error| damaged(error.to_string()))
    };
    let mut likeliest: Option<(Likeness, &String, Option<Range<Data>>)> = None;
    for (index, name) in names.iter().enumerate() {
        let range = read(name)?;
        let found = Likeness::of(&range);
        if found > likeliest.as_ref().map_or(Likeness::None, |(before, ..)| *before) {
            // Of two sheets at a time there may be no room for the cells.
            let is_it = found == Likeness::Log || index + 1 == count;
            likeliest = Some((found, name, is_it.then_some(range)));
        }
        if found == Likeness::Log {
            break;
        }
    }
    let Some((_, name, range)) = likeliest else {
        return Err(damaged("no sheet has a header and a row".to_owned()));
    };
    let range = range.map_or_else(|| read(name), Ok)?;
    let text = text_of(&range).map_err(|error| damaged(error.to_string()))?;
    drop((range, workbook));
    budget.give_back(texts);
    let (bytes, start) = Bytes::made(text);
    let OpenTable { head, rows } = table(path, bytes, &start, Some(b','), budget)?;
    let note = (count > 1).then(|| {
        format!("{}: the sheet `{}` of {count} is read", path.display(), on_one_line(name))
    });
    Ok(OpenTable { head, rows: Box::new(OfSheet { note, rows }) })
}

fn damaged(path: &Path, reason: String) -> ReadError {
    let remedy = "save it again as .xlsx, or as CSV";
    ReadError::Format { path: path.to_owned(), format: "XLSX", reason, remedy }
}

/// The rows of a sheet, and which one it is.
struct OfSheet {
    note: Option<String>,
    rows: Box<dyn Rows>,
}

impl Rows for OfSheet {
    fn read(self: Box<Self>, wanted: &Wanted<'_>) -> Result<Table, ReadError> {
        let mut table = self.rows.read(wanted)?;
        table.notes.extend(self.note);
        Ok(table)
    }
}

/// How much a sheet is like a log.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Likeness {
    /// It has not even two rows.
    None,
    /// It has rows: the first such is to say what is wrong with it.
    Rows,
    /// A row has two numbers or dates.
    Numbers,
    /// So it has, and a column of times.
    Log,
}

impl Likeness {
    fn of(range: &Range<Data>) -> Self {
        let is_value = |cell: &&Data| match cell {
            Data::Float(_) | Data::Int(_) | Data::DateTime(_) => true,
            Data::String(text) => parse_time(text.trim().as_bytes(), b';').is_ok(),
            _ => false,
        };
        let mut rows = range.rows();
        match range.height() {
            ..2 => Self::None,
            _ if !rows.any(|row| row.iter().filter(is_value).count() > 1) => Self::Rows,
            _ if has_times(range) => Self::Log,
            _ => Self::Numbers,
        }
    }
}

/// Whether a row in the upper part of a sheet names a column of times.
fn has_times(range: &Range<Data>) -> bool {
    /// Rows above a table.
    const ABOVE: usize = 100;
    let names_a_time = |row: &[Data]| {
        let name = |value: &Data| Header::parse(cell(value).trim());
        let headers: Vec<Header> = row.iter().map(name).collect();
        let head = Head { path: PathBuf::new(), headers, header_row: 1, unread: Vec::new() };
        find_time_column(&head).is_some()
    };
    range.rows().take(ABOVE).any(names_a_time)
}

/// Memory for a byte of a part that lists names: relationships, formats, names of ranges (measured: 4 to 9
/// times their size).
const PART_SIZE: u64 = 10;

/// Memory of an element that is not ended yet, beside its name: where it begins, with what a list that
/// grows has to spare.
const ELEMENT_SIZE: u64 = 2 * size_of::<usize>() as u64;

/// How many elements begin in a piece of a part.
fn begun(piece: &[u8]) -> u64 {
    let behind = piece.iter().skip(1).chain([&b' ']);
    piece
        .iter()
        .zip(behind)
        .fold(0, |count, (mark, behind)| count + u64::from(*mark == b'<' && *behind != b'/'))
}

/// How often `mark` stands in `part`.
fn count_of(part: &[u8], mark: &[u8]) -> u64 {
    part.windows(mark.len()).filter(|text| *text == mark).count() as u64
}

/// Memory of a text that cells share beside its letters: itself, and what the allocator adds.
const TEXT_SIZE: u64 = size_of::<String>() as u64 + 32;

/// Sheets of a workbook, at most: those before that of the log are read in vain.
const MOST_SHEETS: usize = 100;

/// The file unpacked; what cannot be is refused by whoever reads it.
fn archive(path: &Path) -> Option<ZipArchive<File>> {
    File::open(path).ok().and_then(|file| ZipArchive::new(file).ok())
}

/// Refuses sheets that share a part, which no program writes: each would be unpacked again.
fn check_unshared(path: &Path) -> Result<(), String> {
    let Some(mut archive) = archive(path) else { return Ok(()) };
    let mut sheets = Vec::new();
    if let Ok(part) = archive.by_name("xl/workbook.xml") {
        // What is longer was refused with its sheets.
        part.take(MOST_SHEETS as u64 * 10_000).read_to_end(&mut sheets).unwrap_or_default();
    }
    let mut seen = BTreeSet::new();
    // Ids may be two of one part.
    let parts = archive.file_names().filter_map(Result::ok).filter(|name| is_sheet(name)).count();
    let ids = || ids_of_parts(&sheets);
    if ids().all(|id| seen.insert(id)) && ids().count() <= parts {
        Ok(())
    } else {
        Err("two of its sheets are one part of the file".to_owned())
    }
}

/// Whether a part of this name is a sheet, with cells or a chart.
fn is_sheet(name: &str) -> bool {
    let name = name.to_ascii_lowercase();
    ["worksheets/", "chartsheets/", "dialogsheets/", "macrosheets/"]
        .iter()
        .any(|folder| name.contains(folder))
        && !name.contains("_rels/")
}

/// The ids of parts that `sheets` names, as `r:id="rId3"`.
fn ids_of_parts(sheets: &[u8]) -> impl Iterator<Item = &[u8]> {
    const NAMED: &[u8] = b":id=";
    let named = sheets.windows(NAMED.len()).enumerate().filter(|(_, text)| *text == NAMED);
    named.filter_map(|(at, _)| {
        let (mark, behind) = sheets.get(at + NAMED.len()..)?.split_first()?;
        behind.split(|byte| byte == mark).next()
    })
}

/// Asks for as much memory as all of the workbook takes unpacked: a text, or what is blank, is read
/// into memory whole. What each part says of its size is not trusted. Returns the memory of the texts
/// that cells share. Refuses sheets and texts that cannot be unpacked, or whose checksum is another.
fn check_unpacked(path: &Path, budget: &Budget) -> Result<u64, ReadError> {
    let check = |bytes: u64| budget.check(bytes).map_err(|error| error.refuse(path));
    let Some(mut archive) = archive(path) else { return Ok(0) };
    let (mut unpacked, mut piece, mut texts) = (0, vec![0; PIECE], 0);
    let mut elements = 0;
    for index in 0..archive.len() {
        let Ok(mut part) = archive.by_index(index) else { continue };
        let name = part.name().map(|name| name.to_ascii_lowercase()).unwrap_or_default();
        let (is_texts, is_styles) =
            (name.ends_with("sharedstrings.xml"), name.ends_with("styles.xml"));
        let is_sheet = is_sheet(&name);
        let mut kept = Vec::new();
        loop {
            let bytes = match part.read(&mut piece) {
                Ok(0) => break,
                Ok(bytes) => bytes,
                Err(error) if is_sheet || is_texts => {
                    return Err(damaged(path, format!("its part `{name}` is broken: {error}")));
                }
                Err(_) => break,
            };
            // Sheets are read cell by cell; of all else a library keeps what it names.
            unpacked += bytes as u64 * if is_sheet || is_texts { 1 } else { PART_SIZE };
            elements += begun(piece.get(..bytes).unwrap_or_default());
            check(unpacked + elements * ELEMENT_SIZE)?;
            if is_styles || is_texts {
                kept.extend_from_slice(piece.get(..bytes).unwrap_or_default());
            }
        }
        if is_texts {
            let listed = stated_texts(&kept).max(count_of(&kept, b"<si"));
            texts = listed.saturating_mul(TEXT_SIZE).saturating_add(kept.len() as u64);
            check(texts)?;
        }
        if is_styles {
            check(size_of_styles(&kept))?;
        }
    }
    Ok(texts)
}

/// How many texts their list says that there are (`count`, `uniqueCount`): calamine 0.38 takes memory
/// for them before it has seen one.
fn stated_texts(part: &[u8]) -> u64 {
    const STATED: &[u8] = b"ount";
    let stated = part.windows(STATED.len()).enumerate().filter(|(_, text)| *text == STATED);
    let number = |(at, _): (usize, &[u8])| {
        let behind = part.get(at + STATED.len()..)?;
        let is_between = |byte: &&u8| byte.is_ascii_whitespace() || b"=\"'".contains(*byte);
        let digits = behind.iter().skip_while(is_between).take_while(|byte| byte.is_ascii_digit());
        let digits: Vec<u8> = digits.copied().collect();
        let digits = std::str::from_utf8(&digits).ok().filter(|digits| !digits.is_empty())?;
        Some(digits.parse().unwrap_or(u64::MAX))
    };
    stated.filter_map(number).max().unwrap_or(0)
}

/// At most so many bytes that calamine 0.38 takes for the styles of cells, each of which has a copy of
/// its format: as many as there are, of the longest one.
fn size_of_styles(part: &[u8]) -> u64 {
    let styles = count_of(part, b"xf");
    let longest = part.split(|byte| *byte == b'"').map(<[u8]>::len).max().unwrap_or(0) as u64;
    styles.saturating_mul(longest)
}

/// Bytes that are unpacked at a time.
const PIECE: usize = 1 << 16;

/// Asks for the memory of a sheet, between whose first and last cell the crate calamine 0.38
/// keeps all others, those that are not there as well.
fn check_size(
    workbook: &mut Xlsx<BufReader<File>>,
    name: &str,
    budget: &Budget,
) -> Result<Result<(), TooLarge>, XlsxError> {
    /// Memory of a cell: itself, its place and a short text.
    const CELL_SIZE: u64 = 96;
    let mut cells = workbook.worksheet_cells_reader(name)?;
    let (mut count, mut texts) = (0, 0);
    let (mut rows, mut columns) = (Span::default(), Span::default());
    while let Some(cell) = cells.next_cell()? {
        let (row, column) = cell.get_position();
        rows.add(row);
        columns.add(column);
        count += 1;
        // Each cell has a copy of a text that many share, and stands in the table once more.
        if let DataRef::SharedString(text) = cell.get_value() {
            texts += 2 * text.len() as u64;
        }
        if let Err(error) = budget.check(count * CELL_SIZE + texts) {
            return Ok(Err(error));
        }
    }
    let cells = rows.length().saturating_mul(columns.length()).saturating_mul(CELL_SIZE);
    Ok(budget.check(cells.saturating_add(texts)))
}

/// The least and the greatest of some numbers.
#[derive(Default)]
struct Span(Option<(u32, u32)>);

impl Span {
    fn add(&mut self, place: u32) {
        let (least, greatest) = self.0.unwrap_or((place, place));
        self.0 = Some((least.min(place), greatest.max(place)));
    }

    fn length(&self) -> u64 {
        self.0.map_or(0, |(least, greatest)| u64::from(greatest - least) + 1)
    }
}

/// The cells of a sheet, each row on the line of its number.
fn text_of(range: &Range<Data>) -> std::io::Result<Vec<u8>> {
    let first = range.start().map_or(0, |(row, _)| row as usize);
    let mut text = "\n".repeat(first).into_bytes();
    for row in range.rows() {
        // What begins with `#` is no remark in a sheet.
        let mut line = csv::WriterBuilder::new().comment(Some(b'#')).from_writer(Vec::new());
        line.write_record(row.iter().map(cell)).map_err(std::io::Error::other)?;
        let line = line.into_inner().map_err(|error| std::io::Error::other(error.to_string()))?;
        let empty = row.iter().all(|cell| matches!(cell, Data::Empty));
        text.extend_from_slice(if empty { b"\n" } else { &line });
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
        // As `5e-324` where zeros would be hundreds of digits.
        Data::Float(value) if *value != 0.0 && !(1e-5..1e16).contains(&value.abs()) => {
            format!("{value:e}")
        }
        Data::Float(value) => value.to_string(),
        Data::Int(value) => value.to_string(),
        Data::Bool(value) => u8::from(*value).to_string(),
        Data::DateTime(time) => {
            /// Days of the first of March 1900: before it times of day are shown, and no dates.
            const FIRST_DATES: f64 = 61.0;
            let text = if time.is_datetime() && time.as_f64() >= FIRST_DATES {
                date_of_days(days_of(time))
            } else {
                passed_of_days(time.as_f64())
            };
            text.unwrap_or_else(|| one_line(data))
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
        // Noon of the first of March 2024, and a millisecond before the midnight behind it.
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
    fn a_sheet_with_times_is_likelier_than_one_with_numbers() {
        let sheet = |rows: &[&[&str]]| {
            let mut range = Range::new((0, 0), (4, 2));
            for (row, cells) in (0..).zip(rows) {
                for (column, text) in (0..).zip(*cells) {
                    let number = text.parse().map(Data::Float);
                    let value = number.unwrap_or_else(|_| Data::String((*text).to_owned()));
                    range.set_value((row, column), value);
                }
            }
            range
        };
        let log = sheet(&[&["Rig 3"], &["time_s", "u", "y"], &["0", "1", "2"]]);
        let levels = sheet(&[&["No", "Level"], &["1", "0.5"]]);
        let words = sheet(&[&["made", "by"], &["some", "body"]]);
        let all = [&log, &levels, &words].map(Likeness::of);
        assert!(all == [Likeness::Log, Likeness::Numbers, Likeness::Rows]);
        assert!(Likeness::of(&Range::empty()) == Likeness::None);
        assert!(all.is_sorted_by(|a, b| a > b));
    }

    #[test]
    fn a_date_is_text_and_no_number() {
        let text = |value, kind| cell(&Data::DateTime(ExcelDateTime::new(value, kind, false)));
        let noon = 45_352.5 + 0.25 / 86_400.0;
        let date = text(noon, ExcelDateTimeType::DateTime);
        assert!(date.starts_with("2024-03-01T12:00:00.25"), "{date}");
        assert_eq!(text(1.0 + 0.25 / 86_400.0, ExcelDateTimeType::TimeDelta), "24:00:00.250000");
        let just_before = (3_600.0 - 1e-9) / 86_400.0;
        assert_eq!(text(just_before, ExcelDateTimeType::TimeDelta), "1:00:00.000000");
        assert_eq!(text(just_before, ExcelDateTimeType::DateTime), "1:00:00.000000");
        assert_eq!(cell(&Data::Float(0.5)), "0.5");
    }
}
