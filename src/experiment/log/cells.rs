//! A table that was read, and how its columns, rows and cells are spoken of.

use crate::experiment::error::ReadError;
use crate::experiment::memory::Budget;
use crate::experiment::table::{BadCell, Column, Head, Table, TrialRows};

/// A table that was read, with what is needed to speak of its cells.
pub(in crate::experiment) struct Log<'a> {
    pub(in crate::experiment) head: &'a Head,
    pub(in crate::experiment) numeric: &'a [usize],
    pub(in crate::experiment) table: &'a Table,
    pub(in crate::experiment) budget: &'a Budget,
}

impl Log<'_> {
    /// The trials' rows, named: the whole file is trial `1` unless it says otherwise.
    pub(in crate::experiment) fn trials(&self, stem: Option<&str>) -> Vec<TrialRows> {
        let mut trials = self.table.trials.clone();
        if trials.is_empty() {
            let label = stem.unwrap_or("1").to_owned();
            return vec![TrialRows { label, start: 0, end: self.table.rows.len() }];
        }
        for trial in &mut trials {
            if let Some(stem) = stem {
                trial.label = format!("{stem}/{}", trial.label);
            }
        }
        trials
    }

    /// Takes the memory of `count` values of `size` bytes each.
    pub(super) fn take(&self, count: usize, size: usize) -> Result<(), ReadError> {
        let taken = self.budget.take_values(count, size);
        taken.map_err(|error| error.refuse(&self.head.path))
    }

    pub(super) fn column(&self, index: usize) -> Option<&Column> {
        let place = self.numeric.binary_search(&index).ok()?;
        self.table.columns.get(place)
    }

    pub(super) fn header(&self, column: usize) -> String {
        self.head.headers.get(column).map(|header| header.name.clone()).unwrap_or_default()
    }

    pub(super) fn row(&self, index: usize) -> u64 {
        self.table.rows.number(index)
    }

    /// The first bad cell of a column.
    pub(super) fn bad_cell(&self, column: usize) -> Option<ReadError> {
        let (row, bad) = self.column(column)?.error.clone()?;
        let (path, column) = (self.head.path.clone(), self.header(column));
        Some(match bad {
            BadCell::Kind(found) => ReadError::NotNumbers { path, column, found },
            BadCell::Text(text) => ReadError::NotANumber { path, row, column, text },
            BadCell::Thousands(text) => ReadError::Thousands { path, row, column, text },
            BadCell::DecimalMark(text) => ReadError::DecimalMarks { path, row, column, text },
            BadCell::Infinite => ReadError::Infinite { path, row, column },
            BadCell::TooLarge(value) => ReadError::BeyondPrecision { path, row, column, value },
        })
    }
}
