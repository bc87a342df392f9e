//! Rows of a table of text as they come, and the words below it.

use super::super::cell::{DecimalMarks, Time, parse_cell, parse_time};
use super::super::spelling::{are_units, is_over_lines, is_remark};
use super::lines::Place;
use crate::experiment::error::ReadError;
use crate::experiment::memory::NUMBER_SIZE;
use crate::experiment::names::shown;
use crate::experiment::source::Source;
use crate::experiment::table::{BadCell, Column, Labels, Table, Wanted};

/// Rows of words that may stand below a table, and bytes that each may have.
const MOST_REMARKS: usize = 20;
const LONGEST_REMARK: usize = 1 << 16;

/// The last column of a log of LabVIEW, which rows without a comment do not have.
const COMMENT: &str = "Comment";

/// Rows as they come.
pub(super) struct Gathered<'w> {
    wanted: &'w Wanted<'w>,
    delimiter: u8,
    marks: DecimalMarks,
    /// Whether times are dates or times of day, as the first one shows.
    are_times_in_words: Option<bool>,
    rows: Vec<u32>,
    columns: Vec<Column>,
    labels: Labels,
    pub(super) notes: Vec<String>,
    /// Rows of words, which belong to the table if rows of numbers follow.
    held_back: Vec<(csv::ByteRecord, Place)>,
    /// Cells of each row, which the first one shows.
    width: Option<usize>,
}

impl<'w> Gathered<'w> {
    pub(super) fn new(wanted: &'w Wanted<'w>, delimiter: u8) -> Self {
        let columns = vec![Column::default(); wanted.numeric.len()];
        Self {
            wanted,
            delimiter,
            marks: DecimalMarks::of(wanted.numeric.len(), delimiter),
            are_times_in_words: None,
            rows: Vec::new(),
            columns,
            labels: Labels::default(),
            notes: Vec::new(),
            held_back: Vec::new(),
            width: None,
        }
    }

    /// Says which rows below the header were left out that are no units.
    pub(super) fn note_above(&mut self, above: &[(csv::ByteRecord, Place)]) {
        for (record, Place { row, .. }) in above.iter().filter(|(record, _)| !are_units(record)) {
            let says = says(record);
            self.notes.push(format!(
                "row {row}, below the header, is left out: it holds no number and no time (`{says}`)"
            ));
        }
    }

    /// Takes a row, or holds it back where it may be words below the table. A row that is wrong because it is cut
    /// off is left out.
    pub(super) fn add(&mut self, record: &csv::ByteRecord, place: Place) -> Result<(), ReadError> {
        let is_held = record.as_slice().len() <= LONGEST_REMARK;
        let may_be_last = is_held && !self.rows.is_empty() && self.held_back.len() < MOST_REMARKS;
        if may_be_last && is_remark(record, self.delimiter) {
            self.held_back.push((record.clone(), place));
            return Ok(());
        }
        for (record, place) in std::mem::take(&mut self.held_back) {
            self.take(&record, place)?;
        }
        let taken = self.take(record, place);
        let is_short = record.len() < self.wanted.head.headers.len();
        if place.is_open && is_short && !is_over_lines(record) && taken.is_err() {
            self.notes.push(format!("the last row, {}, is cut off and left out", place.row));
            return Ok(());
        }
        taken
    }

    fn take(&mut self, record: &csv::ByteRecord, place: Place) -> Result<(), ReadError> {
        let wanted = self.wanted;
        self.check_width(record, place)?;
        self.check_quotation(record, place)?;
        let row = place.row;
        let cell = |index: usize| record.get(index).unwrap_or_default().trim_ascii();
        let label = wanted.label.map_or(&b""[..], cell);
        let size = (wanted.numeric.len() + 1) * NUMBER_SIZE + label.len();
        wanted.budget.take_values(1, size)?;
        let index = self.rows.len();
        self.rows.push(u32::try_from(row).unwrap_or(u32::MAX));
        for (at, (column, header)) in self.columns.iter_mut().zip(wanted.numeric).enumerate() {
            let cell = cell(*header);
            let parsed = if wanted.time == Some(*header) {
                let time = time_in(cell, self.delimiter, &mut self.are_times_in_words);
                column.are_dates = self.are_times_in_words == Some(true);
                time
            } else {
                parse_cell(cell, self.delimiter)
            };
            column.push(self.marks.agreed(cell, parsed, at, (row, index)), row);
        }
        if wanted.label.is_some() {
            self.labels.push(&String::from_utf8_lossy(label), row, wanted.budget)?;
        }
        Ok(())
    }

    /// Refuses a row of more or fewer cells than the first one. That one may have a mark after its last
    /// cell which the header does not have, or the other way round; such a mark makes no cell.
    fn check_width(&mut self, record: &csv::ByteRecord, place: Place) -> Result<(), ReadError> {
        let (headers, found) = (&self.wanted.head.headers, record.len());
        let (expected, last) = (headers.len(), headers.last().map(|header| header.name.as_str()));
        let ends_blank = record.iter().next_back().is_some_and(|cell| cell.trim_ascii().is_empty());
        let is_odd =
            found == expected + 1 && ends_blank || found + 1 == expected && last == Some("");
        let width = *self.width.get_or_insert(if is_odd { found } else { expected });
        let is_as_wide = found == width && (width != expected + 1 || ends_blank);
        if is_as_wide || found + 1 == expected && last == Some(COMMENT) {
            return Ok(());
        }
        let hint = if place.lines > 1 { "; is a quotation mark never closed?" } else { "" };
        let text = format!(
            "{found} cells, but the header has {width}; give every row a cell per column{hint}"
        );
        Err(ReadError::content(text).in_row(place.row))
    }

    /// Refuses a row one cell of which holds further rows: a quotation mark in it is never closed, or far
    /// after.
    fn check_quotation(&self, record: &csv::ByteRecord, place: Place) -> Result<(), ReadError> {
        let Place { row, lines, .. } = place;
        let marks = self.wanted.head.headers.len().saturating_sub(1);
        if lines < 2 || marks == 0 {
            return Ok(());
        }
        let is_row = |line: &[u8]| line.split(|byte| *byte == self.delimiter).nth(marks).is_some();
        // The first line of a cell is the rest of its own row.
        let holds_rows = |cell: &[u8]| cell.split(|byte| *byte == b'\n').skip(1).any(is_row);
        if !record.iter().any(holds_rows) {
            return Ok(());
        }
        let text = format!(
            "a cell that begins with a quotation mark goes over {lines} lines, which look like rows; \
             close it, or remove the mark"
        );
        Err(ReadError::content(text).in_row(row))
    }

    /// The table of all rows, which were read from this file. What was held back is no row of it.
    pub(super) fn finish(mut self, source: Option<Source>) -> Table {
        self.note_held_back();
        for (place, column) in self.columns.iter_mut().enumerate() {
            if let Some((row, index, cell)) = self.marks.doubtful(place) {
                column.values.truncate(*index);
                column.error = Some((*row, BadCell::Thousands(cell.clone())));
            }
        }
        let Self { rows, columns, labels, notes, .. } = self;
        Table { source, rows, columns, trials: labels.runs, notes }
    }

    fn note_held_back(&mut self) {
        let Some((first, Place { row, .. })) = self.held_back.first() else { return };
        let what = format!("no number and no time (`{}`)", says(first));
        self.notes.push(match self.held_back.len() {
            1 => format!("the last row, {row}, is left out: it holds {what}"),
            count => {
                format!("the last {count} rows, from {row} on, are left out: they hold {what}")
            }
        });
    }
}

/// The time in a cell, where it is written as the first one is: in words (`Some(true)`) or as a number.
fn time_in(cell: &[u8], delimiter: u8, in_words: &mut Option<bool>) -> Result<f64, BadCell> {
    let (time, is_in_words) = match parse_time(cell, delimiter)? {
        Time::Number(missing) if missing.is_nan() => return Ok(missing),
        Time::Number(value) => (value, false),
        Time::Written(seconds) => (seconds, true),
    };
    if *in_words.get_or_insert(is_in_words) == is_in_words {
        return Ok(time);
    }
    Err(BadCell::Text(String::from_utf8_lossy(cell).into_owned()))
}

/// The first cell of a row that says something.
fn says(record: &csv::ByteRecord) -> String {
    let cells = record.iter().map(String::from_utf8_lossy);
    let first = cells.map(|cell| cell.trim().to_owned()).find(|cell| !cell.is_empty());
    shown(&first.unwrap_or_default())
}
