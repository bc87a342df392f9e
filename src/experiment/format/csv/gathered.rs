//! Rows of a table of text as they come, and the words below it.

use super::super::cell::{DecimalMarks, Time, parse_cell, parse_time};
use super::super::spelling::{are_units, is_remark};
use super::lines::Place;
use super::milliseconds::Milliseconds;
use crate::experiment::error::ReadError;
use crate::experiment::memory::Budget;
use crate::experiment::names::shown;
use crate::experiment::source::Source;
use crate::experiment::table::{BadCell, Column, Header, Labels, RowNumbers, Table, Wanted};

/// Rows of words that may stand below a table.
const MOST_REMARKS: usize = 20;

/// The last column of a log of LabVIEW, which rows without a comment do not have.
const COMMENT: &str = "Comment";

/// Memory of a number: itself, and what its vector has to spare.
const NUMBER_SIZE: usize = 2 * size_of::<f64>();

/// What is said of such times.
const IN_MILLISECONDS: &str = "the decimals of the times are milliseconds without leading zeros: \
     `.10` is 10 ms";

/// Rows as they come.
pub(super) struct Gathered {
    delimiter: u8,
    marks: DecimalMarks,
    /// Whether times are dates or times of day, as the first one shows.
    are_times_in_words: Option<bool>,
    milliseconds: Milliseconds,
    /// The column of times, among those of numbers.
    time: Option<usize>,
    pub(super) table: Table,
    labels: Option<Labels>,
    /// Rows of words and of zero bytes, which belong to the table if rows of numbers follow.
    held_back: Vec<(csv::ByteRecord, Place)>,
    /// The first row among those of numbers that says what the header or the rows of words below it say,
    /// where logs were put behind one another or a logger writes its header anew.
    repeat: Option<u64>,
    /// The rows of words below the header.
    above: Vec<csv::ByteRecord>,
    /// Cells of each row, which the first one shows.
    width: Option<usize>,
    budget: Budget,
}

impl Gathered {
    pub(super) fn new(wanted: &Wanted<'_>, delimiter: u8, budget: Budget) -> Self {
        let path = wanted.path().to_owned();
        let table = Table {
            source: Source { path, sha256: String::new(), bytes: 0 },
            rows: RowNumbers::default(),
            columns: vec![Column::default(); wanted.numeric.len()],
            trials: Vec::new(),
            notes: Vec::new(),
        };
        let labels = wanted.label.map(|_| Labels::default());
        let (marks, held_back) = (DecimalMarks::of(wanted.numeric.len(), delimiter), Vec::new());
        Self {
            delimiter,
            marks,
            are_times_in_words: None,
            milliseconds: Milliseconds::new(),
            time: wanted.numeric.iter().position(|column| wanted.time == Some(*column)),
            table,
            labels,
            held_back,
            repeat: None,
            above: Vec::new(),
            width: None,
            budget,
        }
    }

    pub(super) fn take(
        &mut self,
        record: &csv::ByteRecord,
        place: &Place,
        wanted: &Wanted<'_>,
    ) -> Result<(), ReadError> {
        self.check_width(wanted, place, record)?;
        self.check_quotation(wanted, place, record)?;
        let row = place.row;
        let cell = |index: usize| record.get(index).unwrap_or_default().trim_ascii();
        let label = wanted.label.map_or(&b""[..], cell);
        let numbers = wanted.numeric.len() + usize::from(self.milliseconds.is_open());
        let size = numbers * NUMBER_SIZE + label.len();
        self.budget.take_values(1, size).map_err(|error| error.refuse(wanted.path()))?;
        let index = self.table.rows.len();
        self.table.rows.push(row);
        for (place, (column, wanted_at)) in
            self.table.columns.iter_mut().zip(wanted.numeric).enumerate()
        {
            let cell = cell(*wanted_at);
            let parsed = if wanted.time == Some(*wanted_at) {
                let time = time_in(cell, self.delimiter, &mut self.are_times_in_words);
                column.are_dates = self.are_times_in_words == Some(true);
                time
            } else {
                parse_cell(cell, self.delimiter)
            };
            column.push(self.marks.agreed(cell, parsed, place, (row, index)), row);
            if self.time == Some(place) {
                self.milliseconds.take(cell, column.values.len());
            }
        }
        if let Some(labels) = &mut self.labels {
            let memory = (wanted.path(), &self.budget);
            labels.push(&String::from_utf8_lossy(label), row, memory)?;
        }
        Ok(())
    }

    /// Refuses a row of more or fewer cells than the first one. That one may have a mark behind its last
    /// cell which the header does not have, or the other way round; such a mark makes no cell.
    fn check_width(
        &mut self,
        wanted: &Wanted<'_>,
        place: &Place,
        record: &csv::ByteRecord,
    ) -> Result<(), ReadError> {
        let (headers, found) = (&wanted.head.headers, record.len());
        let expected = headers.len();
        let last = headers.last().map(|header| header.name.as_str());
        let ends_blank = record.iter().next_back().is_some_and(|cell| cell.trim_ascii().is_empty());
        let has_one_more = found == expected + 1 && ends_blank;
        let has_one_less = found + 1 == expected && last == Some("");
        let is_odd = has_one_more || has_one_less;
        let width = *self.width.get_or_insert(if is_odd { found } else { expected });
        let is_as_wide = found == width && (width != expected + 1 || ends_blank);
        let lacks_comment = found + 1 == expected && last == Some(COMMENT);
        if is_as_wide || lacks_comment {
            return Ok(());
        }
        let (path, row, lines) = (wanted.path().to_owned(), place.row, place.lines);
        Err(ReadError::UnequalRow { path, row, found, expected: width, lines })
    }

    /// Refuses a row one cell of which holds further rows: a quotation mark in it is never closed, or far
    /// behind.
    fn check_quotation(
        &self,
        wanted: &Wanted<'_>,
        place: &Place,
        record: &csv::ByteRecord,
    ) -> Result<(), ReadError> {
        if place.lines < 2 {
            return Ok(());
        }
        let marks = wanted.head.headers.len().saturating_sub(1);
        let is_row = |line: &[u8]| {
            // A row of `marks + 1` cells.
            marks > 0 && line.split(|byte| *byte == self.delimiter).nth(marks).is_some()
        };
        // The first line of a cell is the rest of its own row.
        let holds_rows = |cell: &[u8]| cell.split(|byte| *byte == b'\n').skip(1).any(is_row);
        if !record.iter().any(holds_rows) {
            return Ok(());
        }
        let (path, row, lines) = (wanted.path().to_owned(), place.row, place.lines);
        Err(ReadError::OpenQuotation { path, row, lines })
    }

    /// Says which rows below the header were left out that are no units.
    pub(super) fn note_above(&mut self, above: &[(csv::ByteRecord, Place)], wanted: &Wanted<'_>) {
        self.above = above.iter().map(|(record, _)| record.clone()).collect();
        for (record, place) in above.iter().filter(|(record, _)| !are_units(record)) {
            let (path, row) = (wanted.path().display(), place.row);
            let says = says(record);
            self.table.notes.push(format!(
                "{path}: row {row}, below the header, is left out: it holds no number and no time \
                 (`{says}`)"
            ));
        }
    }

    /// Holds a row back that may be words below the table, or what a power cut left; whether it does.
    pub(super) fn holds_back(
        &mut self,
        record: &csv::ByteRecord,
        place: &Place,
        wanted: &Wanted<'_>,
    ) -> Result<bool, ReadError> {
        let is_held = !self.table.rows.is_empty()
            && self.held_back.len() < MOST_REMARKS
            && (is_remark(record, self.delimiter) || has_zero_bytes(record));
        if is_held {
            let memory = self.budget.take(memory_of(record));
            memory.map_err(|error| error.refuse(wanted.path()))?;
            self.held_back.push((record.clone(), *place));
        }
        Ok(is_held)
    }

    /// Takes the rows that were held back, as more follows, but for those that say what the header says.
    pub(super) fn release(&mut self, wanted: &Wanted<'_>) -> Result<(), ReadError> {
        for (record, place) in self.take_held_back() {
            if self.repeats_head(&record, wanted) {
                self.repeat.get_or_insert(place.row);
            } else {
                self.take(&record, &place, wanted)?;
            }
        }
        Ok(())
    }

    /// Whether a row says what the header or a row of words below it says.
    fn repeats_head(&self, record: &csv::ByteRecord, wanted: &Wanted<'_>) -> bool {
        let headers = &wanted.head.headers;
        let is_name = |(cell, header): (&[u8], &Header)| {
            String::from_utf8_lossy(cell).trim() == header.text.trim()
        };
        let is_header = record.len() == headers.len() && record.iter().zip(headers).all(is_name);
        is_header || self.above.contains(record)
    }

    /// The rows that were held back, and are no longer.
    pub(super) fn take_held_back(&mut self) -> Vec<(csv::ByteRecord, Place)> {
        let held_back = std::mem::take(&mut self.held_back);
        self.budget.give_back(held_back.iter().map(|(record, _)| memory_of(record)).sum());
        held_back
    }

    /// Says that words below the table, which were held back, are no rows of it.
    pub(super) fn leave_out(&mut self, wanted: &Wanted<'_>) {
        let Some((first, place)) = self.held_back.first() else { return };
        let (rows, hold) = match self.held_back.len() {
            1 => (format!("the last row, {}, is left out", place.row), "it holds"),
            count => {
                let rows = format!("the last {count} rows, from {} on, are left out", place.row);
                (rows, "they hold")
            }
        };
        let what = if has_zero_bytes(first) {
            "bytes of zero, as a power cut leaves them".to_owned()
        } else {
            format!("no number and no time (`{}`)", says(first))
        };
        let path = wanted.path().display();
        self.table.notes.push(format!("{path}: {rows}: {hold} {what}"));
    }

    fn note_once(&mut self, note: String) {
        if !self.table.notes.contains(&note) {
            self.table.notes.push(note);
        }
    }

    /// What came so far, of this much of the file.
    pub(super) fn table_of(&mut self, source: Source) -> &Table {
        self.table.source = source;
        for (place, column) in self.table.columns.iter_mut().enumerate() {
            if let Some((row, index, cell)) = self.marks.doubtful(place) {
                column.values.truncate(*index);
                column.error = Some((*row, BadCell::Thousands(cell.clone())));
            }
        }
        let time = self.time.and_then(|time| self.table.columns.get_mut(time));
        if time.is_some_and(|time| self.milliseconds.apply(&mut time.values)) {
            let note = format!("{}: {IN_MILLISECONDS}", self.table.source.path.display());
            self.note_once(note);
        }
        if let Some(row) = self.repeat {
            let path = self.table.source.path.display();
            let note = format!("{path}: row {row} repeats the header: such rows are left out");
            self.note_once(note);
        }
        self.table.trials = self.labels.as_ref().map_or_else(Vec::new, Labels::runs);
        &self.table
    }
}

/// Whether a row holds what stands in a file whose last bytes were not written before the power went.
fn has_zero_bytes(record: &csv::ByteRecord) -> bool {
    record.as_slice().contains(&0)
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

/// Memory of a row that is kept: its text, and the ends of its cells with what a list that grows has to
/// spare.
pub(super) fn memory_of(record: &csv::ByteRecord) -> u64 {
    const CELL: u64 = 2 * size_of::<usize>() as u64;
    record.as_slice().len() as u64 + CELL * record.len() as u64
}
