//! A log of one joint, clean, and what a messy one is.

use std::fmt::Write as _;

use tauscope::experiment::ColumnMap;

/// A row of the log: when, what drove the joint, what it did.
#[derive(Clone, Copy)]
pub(crate) struct Row {
    pub(crate) time: f64,
    pub(crate) input: f64,
    pub(crate) output: f64,
}

pub(crate) const ROWS: usize = 1800;
pub(crate) const PERIOD: f64 = 0.01;

/// A number between −1 and 1 that looks random, the same each time.
pub(crate) fn noise(k: usize) -> f64 {
    ((k as f64 * 12.9898).sin() * 43_758.545_3).fract()
}

/// A joint at 100 Hz that follows its steps 14 samples late.
pub(crate) fn clean() -> Vec<Row> {
    let level = |k: usize| [0.0, 1.5, -1.0, 0.5, -2.0][k / 90 % 5];
    let mut angle = 20.0;
    let row = |k: usize| {
        angle += 0.1 * level(k.saturating_sub(14));
        Row { time: PERIOD * k as f64, input: level(k), output: angle + 0.005 * noise(k) }
    };
    (0..ROWS).map(row).collect()
}

/// The clean log with other times.
pub(crate) fn timed(time: impl Fn(usize) -> f64) -> Vec<Row> {
    clean().into_iter().enumerate().map(|(k, row)| Row { time: time(k), ..row }).collect()
}

/// A table with this header, delimiter and a way to write numbers.
pub(crate) fn table(
    header: &str,
    rows: &[Row],
    delimiter: &str,
    number: impl Fn(f64) -> String,
) -> String {
    let mut text = format!("{header}\n");
    for row in rows {
        let cells = [row.time, row.input, row.output].map(&number);
        writeln!(text, "{}", cells.join(delimiter)).unwrap();
    }
    text
}

pub(crate) fn plain(rows: &[Row]) -> String {
    table(HEADER, rows, ",", |value| format!("{value:.6}"))
}

pub(crate) const HEADER: &str = "time_s,boom.input,boom.output";

/// What a messy log is, and what becomes of it.
pub(crate) struct Messy {
    pub(crate) name: &'static str,
    pub(crate) bytes: Vec<u8>,
    pub(crate) columns: ColumnMap,
    pub(crate) expected: Expected,
}

pub(crate) enum Expected {
    /// Read, with delays that differ by no more than so many seconds, and a note that says this.
    Read { within_s: f64, says: &'static str },
    /// Refused with all of this in the message.
    Refused(&'static [&'static str]),
}

pub(crate) fn messy(name: &'static str, bytes: impl Into<Vec<u8>>, expected: Expected) -> Messy {
    Messy { name, bytes: bytes.into(), columns: ColumnMap::default(), expected }
}

/// Read as the clean log is, to the last digit but for rounding.
pub(crate) const SAME: Expected = Expected::Read { within_s: 1e-6, says: "" };

pub(crate) fn read(within_s: f64, says: &'static str) -> Expected {
    Expected::Read { within_s, says }
}

/// `text` with another cell at this row and column.
pub(crate) fn cell(text: &str, row: usize, column: usize, with: &str) -> String {
    let mut lines: Vec<String> = text.lines().map(str::to_owned).collect();
    let mut cells: Vec<&str> = lines[row - 1].split(',').collect();
    cells[column] = with;
    lines[row - 1] = cells.join(",");
    lines.join("\n") + "\n"
}
