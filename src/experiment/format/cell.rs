//! Cells of a text: numbers, times, and what stands for a missing value.

use super::date::{seconds_of_compact_date, seconds_of_date};
use crate::experiment::table::BadCell;

/// What programs write for a value that is missing, in lower case and without a sign: `\n` is a database's,
/// those with `ind` and `nan` the C libraries' of Windows.
const MISSING: &str = "na n/a nv null none nan - \\n nan(ind) nan(snan) 1.#ind 1.#qnan 1.#snan";

/// What spreadsheet programs write for a value that is none, after a `#`.
const NO_VALUES: [&str; 12] = [
    "N/A", "NV", "REF!", "BEZUG!", "DIV/0!", "VALUE!", "WERT!", "NAME?", "NUM!", "ZAHL!", "NULL!",
    "SPILL!",
];

/// Whether a cell says that it has no value.
pub(super) fn is_missing(text: &str) -> bool {
    let unsigned = text.strip_prefix('-').filter(|rest| !rest.is_empty()).unwrap_or(text);
    let no_value = text.strip_prefix('#').unwrap_or(text);
    MISSING.split(' ').any(|word| unsigned.eq_ignore_ascii_case(word))
        || NO_VALUES.iter().any(|word| no_value.eq_ignore_ascii_case(word))
}

/// The number in a cell; NaN where there is none. A comma may stand for the point where it
/// does not part the cells.
pub(super) fn parse_cell(cell: &[u8], delimiter: u8) -> Result<f64, BadCell> {
    if cell.is_empty() {
        return Ok(f64::NAN);
    }
    let text = std::str::from_utf8(cell).ok();
    let number = text.and_then(|text| text.parse::<f64>().ok());
    if number.is_none() && text.is_some_and(is_missing) {
        return Ok(f64::NAN);
    }
    let with_comma = || {
        let text = text.filter(|text| text.matches(',').count() == 1 && !text.contains('.'))?;
        // Between quotation marks, where commas part the cells, `1,200` may be a thousand and more.
        let is_thousands = delimiter == b',' && are_thousands(text);
        (!is_thousands).then(|| text.replace(',', ".").parse::<f64>().ok())?
    };
    let infinite = || text.filter(|text| is_infinite(text)).map(|_| f64::INFINITY);
    let found = number.or_else(with_comma).or_else(infinite);
    found.ok_or_else(|| BadCell::Text(String::from_utf8_lossy(cell).into_owned()))
}

/// Whether a cell is infinite as the C library of Windows writes it.
fn is_infinite(text: &str) -> bool {
    text.trim_start_matches(['+', '-']).eq_ignore_ascii_case("1.#inf")
}

/// Whether a comma of a number may stand between its thousands: three digits follow it, and one to
/// three that are no zero are before it.
fn are_thousands(text: &str) -> bool {
    let Some((whole, rest)) = text.split_once(',') else { return false };
    let whole = whole.trim_start_matches(['-', '+']);
    let are_digits = |text: &str| text.bytes().all(|byte| byte.is_ascii_digit());
    (1..=3).contains(&whole.len())
        && !whole.starts_with('0')
        && rest.len() == 3
        && are_digits(whole)
        && are_digits(rest)
}

/// A time as it is written.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Time {
    /// A number, in the unit of its column.
    Number(f64),
    /// A date and time of ISO 8601 as seconds since 1970, a time of day as seconds since midnight, or a
    /// time that has passed, in seconds.
    Written(f64),
}

/// The time in a cell.
pub(super) fn parse_time(cell: &[u8], delimiter: u8) -> Result<Time, BadCell> {
    // As a number it would be some thousand years, in steps that a double does not have.
    if let Some(seconds) = std::str::from_utf8(cell).ok().and_then(seconds_of_compact_date) {
        return Ok(Time::Written(seconds));
    }
    let number = parse_cell(cell, delimiter).map(Time::Number);
    let Err(BadCell::Text(text)) = &number else { return number };
    seconds_of_date(text).map(Time::Written).map_or(number, Ok)
}

/// Which marks stand between whole and decimal digits in the cells so far.
#[derive(Clone, Debug, Default)]
pub(super) struct DecimalMarks {
    /// The mark of the first cell that has one, which is that of all others.
    first: Option<u8>,
    /// Whether a mark stands where none stands between thousands.
    is_decimal: bool,
    /// What parts the cells: where commas do, no point stands between thousands.
    delimiter: u8,
    columns: Vec<WholeNumbers>,
}

/// What a column of whole numbers with marks between thousands has, as `998`, `999`, `1,000`.
#[derive(Clone, Debug, Default)]
struct WholeNumbers {
    /// Whether a number of three digits or more has no mark.
    without_mark: bool,
    /// The row and the index of the first cell whose mark may stand between thousands, and the cell.
    with_mark: Option<(u64, usize, String)>,
}

impl DecimalMarks {
    /// Of so many columns, parted by `delimiter`.
    pub(super) fn of(columns: usize, delimiter: u8) -> Self {
        let columns = vec![WholeNumbers::default(); columns];
        Self { delimiter, columns, ..Self::default() }
    }

    /// What was `parsed` of a cell of `column` in `row`, where its mark is that of the other cells:
    /// beside `3.98`, the comma of `1,100` may as well be between thousands.
    pub(super) fn agreed(
        &mut self,
        cell: &[u8],
        parsed: Result<f64, BadCell>,
        column: usize,
        (row, index): (u64, usize),
    ) -> Result<f64, BadCell> {
        // A time of day has a mark of its own.
        if parsed.is_err() || cell.contains(&b':') {
            return parsed;
        }
        let mark = cell.iter().copied().find(|byte| b".,".contains(byte));
        if mark.is_some_and(|mark| *self.first.get_or_insert(mark) != mark) {
            return Err(BadCell::DecimalMark(String::from_utf8_lossy(cell).into_owned()));
        }
        let (has_point, has_comma) = (mark == Some(b'.'), mark == Some(b','));
        // Once one is seen, all are.
        let Some(column) = self.columns.get_mut(column).filter(|_| !self.is_decimal) else {
            return parsed;
        };
        let may_part = has_comma || has_point && self.delimiter != b',';
        let text = String::from_utf8_lossy(cell);
        if may_part && are_thousands(&text.replace('.', ",")) {
            column.with_mark.get_or_insert_with(|| (row, index, text.into_owned()));
        } else if has_comma || has_point {
            self.is_decimal = true;
        } else if !column.without_mark {
            let digits = cell.trim_ascii_start().strip_prefix(b"-").unwrap_or(cell);
            column.without_mark = digits.len() > 2 && digits.iter().all(u8::is_ascii_digit);
        }
        parsed
    }

    /// The row, the index and the text of the first cell of `column` whose mark may stand between
    /// thousands, where nothing says that it does not: `1,000` after `999`, and no `0,5` anywhere.
    pub(super) fn doubtful(&self, column: usize) -> Option<&(u64, usize, String)> {
        let whole = self.columns.get(column).filter(|whole| whole.without_mark)?;
        whole.with_mark.as_ref().filter(|_| !self.is_decimal)
    }
}

/// Whether a cell holds a number with a comma between its thousands.
pub(super) fn is_of_thousands(cell: &[u8]) -> bool {
    std::str::from_utf8(cell).is_ok_and(are_thousands)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_cell_is_a_number_or_missing_or_wrong() {
        let parse = |cell: &[u8]| parse_cell(cell, b',');
        assert_eq!(parse(b"-1.5e3"), Ok(-1500.0));
        assert!(parse(b"").unwrap().is_nan());
        assert!(parse(b"NaN").unwrap().is_nan());
        assert_eq!(parse(b"inf"), Ok(f64::INFINITY));
        assert_eq!(parse(b"1e999"), Ok(f64::INFINITY));
        for word in [
            "NA",
            "n/a",
            "#N/A",
            "#NV",
            "NULL",
            "None",
            "-",
            "--",
            "\\N",
            "-nan(ind)",
            "1.#QNAN",
            "-1.#IND",
            "#REF!",
            "#DIV/0!",
            "DIV/0!",
        ] {
            assert!(parse(word.as_bytes()).unwrap().is_nan(), "{word}");
        }
        assert_eq!(parse(b"#1"), Err(BadCell::Text("#1".to_owned())));
        assert_eq!(parse(b"1.#INF"), Ok(f64::INFINITY));
        assert_eq!(parse_cell(b"-1,5", b';'), Ok(-1.5));
        assert_eq!(parse_cell(b"1,200", b';'), Ok(1.2));
        for (text, number) in [("1,5", 1.5), ("0,125", 0.125), ("-0,5e2", -50.0)] {
            assert_eq!(parse(text.as_bytes()), Ok(number));
        }
        assert!(parse(b"1,200").is_err() && parse(b"1,5,2").is_err());
        assert!(parse_cell(b"1.000,5", b';').is_err());
    }

    #[test]
    fn times_may_be_dates() {
        let time = |text: &str| match parse_time(text.as_bytes(), b';') {
            Ok(Time::Written(seconds)) => seconds,
            other => panic!("{text}: {other:?}"),
        };
        for text in [
            "2024-05-01T12:00:00.25Z",
            "2024-05-01 12:00:00,25",
            "2024-05-01T14:00:00.25+02:00",
            "2024/05/01 12:00:00.25",
            "01-May-2024 12:00:00.25",
            "2024-05-01 12:00:00.25 UTC",
            "2024-05-01 14:00:00.25 +0200",
            "2024-05-01 14:00:00.25 +02:00",
            "2024-05-01T14:00:00.25+02:00[Europe/Berlin]",
        ] {
            assert!((time(text) - 1_714_564_800.25).abs() < 1e-6, "{text}: {}", time(text));
        }
        for (text, seconds) in [
            ("12:00:00.5", 43_200.5),
            ("20240501120000250", 1_714_564_800.25),
            ("20240501120000.25", 1_714_564_800.25),
            ("26:00:00.25", 93_600.25),
            ("00:01.5", 1.5),
            ("1.5 sec", 1.5),
            ("1.5 s", 1.5),
            ("0 days 00:00:01.010000", 1.01),
            ("1 day, 0:00:02", 86_402.0),
            ("-1 days +23:59:59.5", -0.5),
        ] {
            assert!((time(text) - seconds).abs() < 1e-9, "{text}: {}", time(text));
        }
        for text in ["1:2", "0:75:00", "a:00:01", "5 days", "1:1e1.5"] {
            assert!(!matches!(parse_time(text.as_bytes(), b';'), Ok(Time::Written(_))), "{text}");
        }
        assert_eq!(parse_time(b"0.5", b';'), Ok(Time::Number(0.5)));
        assert!(parse_time(b"noon", b';').is_err());
    }
}
