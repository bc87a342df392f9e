//! A log as columns of numbers, whatever the format of its file.
//!
//! It does not know what the columns mean, only which are wanted: [`super::layout`] assigns them to
//! joints.

use std::collections::HashSet;
use std::fmt;

use super::error::{ReadError, ReadErrorKind};
use super::grid::Repair;
use super::memory::Budget;
use super::names::{listed, on_one_line, shown};
use super::source::Source;
use super::unit;

/// Name and unit of a column.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Header {
    pub(super) name: String,
    pub(super) unit: Option<String>,
    /// The cell as it stands in the file, on one line.
    pub(super) text: String,
    /// Columns of one clock are sampled together; each clock has rows of its own.
    pub(super) clock: usize,
}

impl Header {
    /// A name that has no unit in it.
    #[cfg(any(feature = "mat", feature = "mcap"))]
    pub(super) fn plain(name: &str, clock: usize) -> Self {
        let name = on_one_line(name).into_owned();
        Self { text: name.clone(), name, unit: None, clock }
    }

    /// Splits `boom.output [deg]` and `angle (deg)` into a name and a unit.
    pub(super) fn parse(cell: &str) -> Self {
        let text = &*on_one_line(cell);
        let (name, unit) = unit::parted(text);
        let ended = unit::of_native(name).filter(|_| unit.is_none());
        let (name, unit) = ended.map_or((name, unit), |(name, unit)| (name, Some(unit)));
        Self { name: name.to_owned(), unit, text: text.to_owned(), clock: 0 }
    }
}

/// What columns a log has.
#[derive(Clone, Debug)]
pub(super) struct Head {
    pub(super) headers: Vec<Header>,
    /// Line of the header in the file; 0 where the file has no lines.
    pub(super) header_row: u64,
    /// What else it has, which cannot be read, for messages.
    pub(super) unread: Vec<String>,
}

impl Head {
    /// Of a file that has no lines.
    pub(super) fn without_lines(headers: Vec<Header>) -> Self {
        Self { headers, header_row: 0, unread: Vec::new() }
    }

    /// Refuses columns whose names are none: each page, table and path of an output would bear them.
    pub(super) fn check_names(
        &self,
        mut columns: impl Iterator<Item = usize>,
    ) -> Result<(), ReadError> {
        columns.try_for_each(|column| check_name(&self.text(column), self.header_row))
    }

    /// Refuses a table without a header.
    pub(super) fn check_is_header(&self) -> Result<(), ReadError> {
        let is_number = |header: &Header| header.text.replace(',', ".").parse::<f64>().is_ok();
        if self.headers.len() < 2 || !self.headers.iter().all(is_number) {
            return Ok(());
        }
        let text = "the first row has numbers instead of names of columns; write a header above it, as in \
                    `time_s,boom.input,boom.output`";
        Err(ReadError::content(text).in_row(self.header_row))
    }

    /// That two columns are named so.
    pub(super) fn two_columns(&self, name: &str) -> ReadError {
        let text = format!("two columns are named `{name}`; rename one of them");
        ReadError::content(text).in_row(self.header_row).in_column(name)
    }

    /// A column's header as it stands in the file.
    pub(super) fn text(&self, column: usize) -> String {
        self.headers.get(column).map_or_else(String::new, |header| header.text.clone())
    }

    /// The names of all columns, for messages.
    pub(super) fn names(&self) -> String {
        let names = listed(self.headers.iter().map(|header| header.text.as_str()));
        if self.unread.is_empty() {
            return names;
        }
        let unread = listed(self.unread.iter().map(String::as_str));
        format!("{names}; topics that cannot be read: {unread}")
    }
}

/// The longest name of a column or a trial, in bytes: recordings and reports repeat it hundreds of
/// times.
pub(super) const LONGEST_NAME: usize = 1000;

/// Refuses a name that is longer than any.
fn check_name(name: &str, row: u64) -> Result<(), ReadError> {
    if name.len() <= LONGEST_NAME {
        return Ok(());
    }
    let start = shown(name);
    let text = format!(
        "the name `{start}` is longer than {LONGEST_NAME} bytes, the most of a name; shorten it"
    );
    Err(ReadError::content(text).in_row(row))
}

/// The columns of a log, and what reads those that are wanted.
pub(super) type Opened = (Head, ReadRows);

/// Reads the columns that are wanted; fails where the file or a row is wrong. A bad cell spoils its column only:
/// see [`Column::error`].
pub(super) type ReadRows = Box<dyn FnOnce(&Wanted<'_>) -> Result<Table, ReadError>>;

/// A log whose columns are known, with the memory that its values may take.
pub(super) struct OpenTable {
    pub(super) head: Head,
    read_rows: ReadRows,
    budget: Budget,
}

/// What is to be read of a file.
pub(super) struct Wanted<'a> {
    pub(super) head: &'a Head,
    /// Columns of numbers, by their places among the headers.
    pub(super) numeric: &'a [usize],
    /// The column that names the trials.
    pub(super) label: Option<usize>,
    /// The column of the times, which may be dates.
    pub(super) time: Option<usize>,
    /// The clock whose rows are wanted.
    #[cfg_attr(not(feature = "mcap"), expect(dead_code, reason = "for other formats"))]
    pub(super) clock: usize,
    /// What memory is left for them.
    pub(super) budget: &'a Budget,
    /// Whether a last line that has no end is left out, since the log may still grow.
    pub(super) grows: bool,
}

impl OpenTable {
    pub(super) fn new((head, read_rows): Opened, budget: Budget) -> Self {
        Self { head, read_rows, budget }
    }

    /// Reads the columns `numeric` as numbers, `time` among them, and `label` as text, in the rows of `clock`.
    pub(super) fn read(
        self,
        numeric: &[usize],
        [label, time]: [Option<usize>; 2],
        clock: usize,
        repair: Repair,
    ) -> Result<Table, ReadError> {
        let Self { head, read_rows, budget } = self;
        let (head, budget, grows) = (&head, &budget, repair.as_it_stands);
        let table = read_rows(&Wanted { head, numeric, label, time, clock, budget, grows })?;
        if table.rows.is_empty() {
            return Err(ReadError::header_only());
        }
        let labels = table.trials.last().map_or(table.rows.len(), |last| last.end);
        if labels != table.rows.len() {
            let label = head.text(label.unwrap_or_default());
            return Err(ReadError::unequal_columns(label, labels, table.rows.len()));
        }
        Ok(table)
    }
}

/// The columns that were asked for.
pub(super) struct Table {
    /// Where the file was read to its end; whoever reads the log looks at it again where it was not.
    pub(super) source: Option<Source>,
    /// What messages call each row: its line of the file, or its number from 1 where that has no lines.
    pub(super) rows: Vec<u32>,
    pub(super) columns: Vec<Column>,
    /// Runs of rows with the same label; empty without a label column.
    pub(super) trials: Vec<TrialRows>,
    /// What the reader of the log should know.
    pub(super) notes: Vec<String>,
}

impl Table {
    /// Turns the rows round: the last is the first.
    pub(super) fn turn(&mut self) {
        let rows = self.rows.len();
        self.rows.reverse();
        // What ends at a bad cell is refused anyhow.
        for column in self.columns.iter_mut().filter(|column| column.error.is_none()) {
            column.values.reverse();
        }
        self.trials.reverse();
        for trial in &mut self.trials {
            (trial.start, trial.end) = (rows - trial.end, rows - trial.start);
        }
    }

    /// The rows of a file that has no lines, whose columns are `values`, by their places among the headers.
    pub(super) fn of_values(
        wanted: &Wanted<'_>,
        values: impl Fn(usize) -> Result<Values, ReadError>,
    ) -> Result<Self, ReadError> {
        let mut columns = Vec::new();
        for column in wanted.numeric {
            columns.push(match values(*column)? {
                Values::Numbers(numbers) => Column::of(numbers),
                Values::Texts(_) => Column::not_numbers("text"),
                Values::Other(kind) => Column::not_numbers(&kind),
            });
        }
        let mut labels = Vec::new();
        if let Some(column) = wanted.label {
            let of_number = |x: f64| if x.is_nan() { String::new() } else { x.to_string() };
            labels = match values(column)? {
                Values::Numbers(numbers) => numbers.into_iter().map(of_number).collect(),
                Values::Texts(texts) => texts,
                Values::Other(kind) => {
                    let text = format!(
                        "it holds {kind}, not a label per row; save it as numbers or as a cell array of texts, \
                         or read all as one trial with `--trial none`"
                    );
                    return Err(ReadError::content(text).in_column(wanted.head.text(column)));
                }
            };
        }
        Ok(Self::counted(wanted, columns, Labels::of(labels, wanted.budget)?))
    }

    /// The rows of a file that has no lines, counted from 1: as many as the times are, else as its longest column
    /// has.
    pub(super) fn counted(wanted: &Wanted<'_>, columns: Vec<Column>, labels: Labels) -> Self {
        let time = wanted.numeric.iter().position(|column| Some(*column) == wanted.time);
        let times = time.and_then(|time| columns.get(time)).filter(|times| times.error.is_none());
        let lengths = columns.iter().map(|column| column.values.len());
        let longest = lengths.chain([labels.rows]).max().unwrap_or_default();
        let rows = (1..).take(times.map_or(longest, |times| times.values.len())).collect();
        Self { source: None, rows, columns, trials: labels.runs, notes: Vec::new() }
    }
}

/// The values of a column of a file that has no lines.
pub(super) enum Values {
    /// Missing ones are NaN.
    Numbers(Vec<f64>),
    Texts(Vec<String>),
    /// What it holds instead.
    #[cfg_attr(not(feature = "mat"), expect(dead_code, reason = "for other formats"))]
    Other(String),
}

impl Default for Values {
    fn default() -> Self {
        Self::Numbers(Vec::new())
    }
}

/// A run of rows with the same label.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct TrialRows {
    pub(super) label: String,
    pub(super) start: usize,
    pub(super) end: usize,
}

/// One column of numbers; a missing value is NaN.
#[derive(Clone, Debug, Default)]
pub(super) struct Column {
    pub(super) values: Vec<f64>,
    /// Whether they are dates or times of day, in seconds whatever the unit of the column.
    pub(super) are_dates: bool,
    /// The first bad cell and its row. The values end before it.
    pub(super) error: Option<(u64, BadCell)>,
}

impl Column {
    /// A column that holds `kind`.
    pub(super) fn not_numbers(kind: &str) -> Self {
        Self { error: Some((0, BadCell::Kind(kind.to_owned()))), ..Self::default() }
    }

    /// Numbers in the order of their rows, counted from 1, as they are: none is copied.
    pub(super) fn of(values: Vec<f64>) -> Self {
        let mut column = Self { values, ..Self::default() };
        let is_bad = |value: &f64| value.is_infinite() || value.abs() > LARGEST;
        if let Some(row) = column.values.iter().position(is_bad) {
            column.error = Some((row as u64 + 1, BadCell::TooLarge(column.values[row])));
            column.values.truncate(row);
        }
        column
    }

    /// Its largest number, where that is too small to be squared and is not zero.
    pub(super) fn too_small(&self) -> Option<f64> {
        let largest = self.values.iter().fold(0.0_f64, |largest, value| largest.max(value.abs()));
        (largest > 0.0 && largest < SMALLEST).then_some(largest)
    }

    /// Adds the cell of a row, as long as there was no bad one.
    pub(super) fn push(&mut self, cell: Result<f64, BadCell>, row: u64) {
        match cell {
            _ if self.error.is_some() => {}
            Ok(value) if value.abs() <= LARGEST || value.is_nan() => self.values.push(value),
            Ok(value) => self.error = Some((row, BadCell::TooLarge(value))),
            Err(bad) => self.error = Some((row, bad)),
        }
    }
}

/// A cell that is neither a finite number nor missing.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum BadCell {
    /// The whole column holds something else.
    Kind(String),
    Text(String),
    /// A number with another decimal mark than cells before it.
    DecimalMark(String),
    /// A number whose comma or point may stand between thousands, in a column of whole numbers.
    Thousands(String),
    /// Its squares, and sums of products of them, are beyond double precision.
    TooLarge(f64),
}

impl fmt::Display for BadCell {
    /// What is wrong, and what to do about it.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Kind(found) => write!(
                f,
                "it holds {found}, not numbers; choose another column, or write it as numbers"
            ),
            Self::Text(text) => {
                let is_number = text.replace(',', ".").parse::<f64>().is_ok();
                let remedy = if text.contains(',') && is_number {
                    "write decimals with a point"
                } else {
                    "write a number, or none at all"
                };
                write!(f, "`{}` is not a number; {remedy}", shown(text))
            }
            Self::DecimalMark(text) => write!(
                f,
                "`{}` beside cells with the other decimal mark; write all decimals with a point, and \
                 nothing between thousands",
                shown(text)
            ),
            Self::Thousands(text) => write!(
                f,
                "`{}` may mean a number with three decimals or one in the thousands, since other \
                 cells of the column are whole numbers; write decimals with a point, and nothing \
                 between thousands",
                shown(text)
            ),
            Self::TooLarge(value) if value.is_infinite() => {
                f.write_str("the value is infinite; remove the row or mend the value")
            }
            Self::TooLarge(value) => write!(
                f,
                "{value:e} is too large: its square is beyond double precision; write it in a \
                 larger unit, or leave the cell empty if the number marks a missing value"
            ),
        }
    }
}

/// The largest number of a log: products of squares of ten million of them are still numbers.
pub(crate) const LARGEST: f64 = 1e75;

/// What the largest number of a signal must reach: products of squares of smaller ones, and of
/// what is left of them by a model, are lost to zero.
const SMALLEST: f64 = 1e-75;

/// Memory of a trial beside the bytes of its label: its run of rows and the text with what their
/// allocations have to spare, once as they come, once in the table and once in the log; its label
/// among those seen; the numbers of its rows, their times and its grid (measured: 290 bytes before
/// the grid).
const TRIAL_SIZE: usize = 512;

/// Copies of a label that are held at once: among the runs and those seen, in the table and the log.
const LABEL_COPIES: usize = 4;

/// The labels of rows as they come, as runs.
#[derive(Debug, Default)]
pub(super) struct Labels {
    /// The runs of equal labels.
    pub(super) runs: Vec<TrialRows>,
    seen: HashSet<String>,
    rows: usize,
}

impl Labels {
    /// The labels of all rows, counted from 1.
    pub(super) fn of(
        labels: impl IntoIterator<Item = String>,
        budget: &Budget,
    ) -> Result<Self, ReadError> {
        let mut all = Self::default();
        labels.into_iter().zip(1..).try_for_each(|(label, row)| all.push(&label, row, budget))?;
        Ok(all)
    }

    /// Adds the label of the next row; a new trial is taken from `budget`.
    pub(super) fn push(&mut self, label: &str, row: u64, budget: &Budget) -> Result<(), ReadError> {
        let index = self.rows;
        self.rows += 1;
        let label = &*on_one_line(label);
        if let Some(run) = self.runs.last_mut().filter(|run| run.label == label) {
            run.end = self.rows;
            return Ok(());
        }
        check_name(label, row)?;
        budget.take_values(1, TRIAL_SIZE + LABEL_COPIES * label.len())?;
        let label = label.to_owned();
        if !self.seen.insert(label.clone()) {
            let text = format!(
                "trial `{label}` starts again here after another one; keep the rows of a trial together"
            );
            return Err(ReadError::new(ReadErrorKind::TrialNotContiguous, text).in_row(row));
        }
        self.runs.push(TrialRows { label, start: index, end: self.rows });
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_end_before_one_that_is_infinite() {
        let column = Column::of(vec![1.0, f64::NAN, f64::INFINITY, 2.0]);
        assert_eq!(column.values.len(), 2);
        assert_eq!(column.error, Some((3, BadCell::TooLarge(f64::INFINITY))));
    }

    #[test]
    fn a_table_that_is_turned_keeps_the_numbers_of_its_rows() {
        let column = |values: &[f64]| Column { values: values.to_vec(), ..Column::default() };
        let trial = |label: &str, start, end| TrialRows { label: label.to_owned(), start, end };
        let mut table = Table {
            source: None,
            rows: vec![3, 4, 6, 7],
            columns: vec![column(&[1.0, 2.0, 3.0, 4.0])],
            trials: vec![trial("b", 0, 1), trial("a", 1, 4)],
            notes: Vec::new(),
        };
        table.turn();
        assert_eq!(table.columns[0].values, [4.0, 3.0, 2.0, 1.0]);
        assert_eq!(table.trials, [trial("a", 0, 3), trial("b", 3, 4)]);
        assert_eq!(table.rows, [7, 6, 4, 3]);
    }

    #[test]
    fn each_trial_is_taken_from_the_memory_and_a_row_of_it_is_not() {
        use crate::experiment::MemoryLimit;

        let budget = Budget::new(MemoryLimit::of_bytes(3 * (TRIAL_SIZE + LABEL_COPIES) as u64));
        let mut labels = Labels::default();
        for (row, label) in ["a", "b", "b", "b", "c"].into_iter().enumerate() {
            labels.push(label, row as u64, &budget).unwrap();
        }
        assert_eq!(labels.runs.len(), 3);
        let refused = labels.push("d", 5, &budget);
        assert!(matches!(refused.unwrap_err().kind, ReadErrorKind::TooLarge));
    }
}
