//! Why a log could not be read: the file, the row, the column, what was found and what to do about it.

use std::error::Error;
use std::fmt;
use std::path::{Path, PathBuf};

/// The column of a time, and mappings: of each joint its name, its input and its output.
type Likely = (Option<String>, Vec<Vec<[String; 3]>>);

/// Why a log, or one joint of it, could not be read.
///
/// It is made where the fault is found; the reader of the log adds the name of the file.
#[derive(Debug)]
pub struct ReadError {
    /// What is wrong, as far as a program tells faults apart.
    pub kind: ReadErrorKind,
    path: PathBuf,
    row: u64,
    column: Option<String>,
    /// What was found, and what to do about it.
    text: String,
}

/// What is wrong with a log.
#[derive(Debug)]
#[non_exhaustive]
pub enum ReadErrorKind {
    /// The file cannot be opened or read.
    Io(std::io::Error),
    /// The file is not what its name or its first bytes say, it is damaged, or this build cannot read
    /// its format.
    Format,
    /// It would take more memory than it may.
    TooLarge,
    /// There is no log, no row or no number.
    Empty,
    /// A name, a cell, a row or a time is none that can be read or computed with, or contradicts others.
    Content,
    /// A column that is needed is not there.
    MissingColumn,
    /// No column belongs to a joint. What names and data suggest, though not for sure: the column of
    /// the time, and the name, the input and the output of each joint, the likeliest of several mappings
    /// first.
    NoJoints(Box<Likely>),
    /// A joint that is asked for is not there.
    NoSuchJoint,
    /// There is no time, and no sample period was given: the name of the first column, where it is one
    /// that programs give to an index without a name.
    NoTime(Option<String>),
    /// A cell is empty or NaN where nothing may be filled.
    Missing,
    /// A cell holds text where a time belongs.
    NotATime,
    /// No sample period follows from the times, or none that a log can have.
    Times,
    /// A time step differs from the median by more than 1 %.
    NotUniform {
        /// Time since the row before, in seconds.
        step: f64,
        /// Median time step, in seconds.
        period: f64,
    },
    /// The rows of one trial are not together.
    TrialNotContiguous,
    /// A trial would have more samples than can be handled.
    TooManySamples,
}

impl ReadError {
    pub(super) fn new(kind: ReadErrorKind, text: impl Into<String>) -> Self {
        Self { kind, path: PathBuf::new(), row: 0, column: None, text: text.into() }
    }

    /// Something in it is none that can be read or computed with.
    pub(super) fn content(text: impl Into<String>) -> Self {
        Self::new(ReadErrorKind::Content, text)
    }

    /// A file cannot be read as `format`, and why.
    pub(super) fn format(format: &str, reason: impl fmt::Display, remedy: &str) -> Self {
        Self::new(ReadErrorKind::Format, format!("cannot be read as {format}: {reason}; {remedy}"))
    }

    /// The file holds nothing.
    pub(super) fn empty() -> Self {
        Self::new(ReadErrorKind::Empty, "the file is empty; expected a header row and samples")
    }

    /// There is a header and no sample.
    pub(super) fn header_only() -> Self {
        Self::new(ReadErrorKind::Empty, "there is a header but no sample below it")
    }

    /// A column that is needed has another length than the times.
    pub(super) fn unequal_columns(column: String, found: usize, rows: usize) -> Self {
        let text = format!(
            "column `{column}` has {found} values but the log has {rows} rows; choose columns of one length"
        );
        Self::content(text).in_column(column)
    }

    /// It is about this row: the line of the file, counted from 1, as an editor shows it; where a file
    /// has no lines, the number of the sample. 0 stands for a header that has no line.
    pub(super) fn in_row(self, row: u64) -> Self {
        Self { row, ..self }
    }

    /// It is about the row with this index in its trial: see [`Self::in_trial`].
    pub(super) fn at_index(self, index: usize) -> Self {
        self.in_row(index as u64 + 1)
    }

    /// As one of the trial with this `label`, a row of which is called by `number`; what is wrong with all of
    /// the trial names it.
    pub(super) fn in_trial(self, label: &str, number: impl Fn(usize) -> u64) -> Self {
        let is_of_all = matches!(self.kind, ReadErrorKind::Empty | ReadErrorKind::TooManySamples);
        let text = if is_of_all { format!("trial `{label}` {}", self.text) } else { self.text };
        let index = self.row.checked_sub(1).and_then(|index| usize::try_from(index).ok());
        Self { text, row: index.map_or(0, number), ..self }
    }

    /// It is about this column.
    pub(super) fn in_column(self, column: impl Into<String>) -> Self {
        Self { column: Some(column.into()), ..self }
    }

    /// The log at `path` is the one that cannot be read, unless another is named.
    pub(super) fn in_file(self, path: &Path) -> Self {
        if self.path.as_os_str().is_empty() { Self { path: path.to_owned(), ..self } } else { self }
    }

    /// Says in what part of the file it is, where that cannot be read as it should be.
    #[cfg(feature = "mat")]
    pub(super) fn within(self, part: &str) -> Self {
        let text = match self.kind {
            ReadErrorKind::Format => self.text.replacen(": ", &format!(": {part}: "), 1),
            _ => self.text,
        };
        Self { text, ..self }
    }

    /// Says `more` after all else.
    pub(super) fn with(self, more: &str) -> Self {
        Self { text: self.text + more, ..self }
    }

    /// Whether no column belongs to a joint.
    pub(super) fn has_no_joints(&self) -> bool {
        matches!(self.kind, ReadErrorKind::NoJoints(_))
    }

    /// The row it is about: the line of the file, or the number of the sample where there are
    /// no lines.
    pub fn row(&self) -> Option<u64> {
        Some(self.row).filter(|row| *row > 0)
    }

    /// The name of the column it is about.
    pub fn column(&self) -> Option<&str> {
        self.column.as_deref()
    }
}

impl fmt::Display for ReadError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let path = Some(self.path.display().to_string()).filter(|path| !path.is_empty());
        let row = self.row().map(|row| format!("row {row}"));
        let column = self.column().map(|column| format!("`{column}`"));
        let column = column.filter(|column| !self.text.contains(column));
        let column = column.map(|column| format!("column {column}"));
        let place: Vec<String> = path.into_iter().chain(row).chain(column).collect();
        write!(f, "{}: {}", place.join(", "), self.text)
    }
}

impl Error for ReadError {
    fn source(&self) -> Option<&(dyn Error + 'static)> {
        match &self.kind {
            ReadErrorKind::Io(source) => Some(source),
            _ => None,
        }
    }
}

impl From<std::io::Error> for ReadError {
    fn from(source: std::io::Error) -> Self {
        Self::new(ReadErrorKind::Io(source), "cannot be read")
    }
}
