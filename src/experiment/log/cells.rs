//! A table that was read, with what is needed to mend it and to speak of its columns, rows and cells.

use std::collections::HashSet;
use std::ops::Range;

use crate::experiment::error::ReadError;
use crate::experiment::grid::Repair;
use crate::experiment::layout::{JointLayout, Layout};
use crate::experiment::memory::Budget;
use crate::experiment::origin::Counting;
use crate::experiment::table::{Column, Head, Table, TrialRows};

/// The values of an output as they are mended, and what is said of it.
pub(in crate::experiment) type Mended = (Vec<f64>, Option<String>);

/// A table that was read, with what is needed to mend it and to speak of its cells.
pub(in crate::experiment) struct Log<'a> {
    pub(in crate::experiment) head: &'a Head,
    pub(in crate::experiment) layout: &'a Layout,
    /// The columns that were read, by their places among the headers.
    numeric: &'a [usize],
    pub(in crate::experiment) table: Table,
    pub(super) budget: &'a Budget,
    /// What may be done to it.
    pub(in crate::experiment) options: Repair,
    /// Seconds of each row.
    pub(in crate::experiment) times: Vec<f64>,
    /// How they count, where they are read from a column of times.
    pub(super) counting: Option<Counting>,
    /// What a reader of the log should know.
    pub(in crate::experiment) notes: Vec<String>,
}

impl<'a> Log<'a> {
    /// The log with the columns `numeric` in `table`, as it stands; a file without labels is one trial, named
    /// `1` or by its `stem`.
    pub(in crate::experiment) fn new(
        head: &'a Head,
        layout: &'a Layout,
        numeric: &'a [usize],
        mut table: Table,
        budget: &'a Budget,
        (options, stem): (Repair, Option<&str>),
    ) -> Self {
        if table.trials.is_empty() {
            let label = stem.unwrap_or("1").to_owned();
            table.trials.push(TrialRows { label, start: 0, end: table.rows.len() });
        } else if let Some(stem) = stem {
            for trial in &mut table.trials {
                trial.label = format!("{stem}/{}", trial.label);
            }
        }
        let (times, counting, notes) = (Vec::new(), None, Vec::new());
        Self { head, layout, numeric, table, budget, options, times, counting, notes }
    }

    /// Mends each output that needs it: by its values anew, and what is said of them where their joint is among
    /// the results. Of joints with the same output the first counts.
    pub(in crate::experiment) fn mend_outputs(
        &mut self,
        mend: impl Fn(&Self, &JointLayout) -> Option<Mended>,
    ) {
        let (layout, mut seen) = (self.layout, HashSet::new());
        for joint in layout.joints.iter().chain(&layout.others) {
            if !seen.insert(joint.output.column) {
                continue;
            }
            let Some((values, note)) = mend(self, joint) else { continue };
            if let Some(column) = self.column_mut(joint.output.column) {
                column.values = values;
            }
            let note = note.filter(|_| layout.joints.contains(joint));
            self.notes.extend(note.map(|note| joint.note(&note)));
        }
    }

    /// The rows of each trial.
    pub(in crate::experiment) fn spans(&self) -> Vec<Range<usize>> {
        self.table.trials.iter().map(|trial| trial.start..trial.end).collect()
    }

    /// The numbers of a column that was read.
    pub(super) fn values(&self, column: usize) -> &[f64] {
        self.column(column).map_or(&[], |column| &column.values)
    }

    /// The numbers in a column, trial by trial; none where it ends at a bad cell.
    pub(in crate::experiment) fn parts(&self, column: usize) -> Option<Vec<&[f64]>> {
        let values = &self.column(column)?.values;
        self.spans().into_iter().map(|rows| values.get(rows)).collect()
    }

    /// The times of the rows of a trial.
    pub(in crate::experiment) fn times_of(&self, trial: usize) -> Option<&[f64]> {
        let rows = self.table.trials.get(trial)?;
        self.times.get(rows.start..rows.end)
    }

    pub(in crate::experiment) fn column(&self, index: usize) -> Option<&Column> {
        self.table.columns.get(self.numeric.binary_search(&index).ok()?)
    }

    pub(in crate::experiment) fn column_mut(&mut self, index: usize) -> Option<&mut Column> {
        let place = self.numeric.binary_search(&index).ok()?;
        self.table.columns.get_mut(place)
    }

    /// The name of a column.
    pub(super) fn header(&self, column: usize) -> String {
        self.head.headers.get(column).map(|header| header.name.clone()).unwrap_or_default()
    }

    /// What messages call a row.
    pub(in crate::experiment) fn row(&self, index: usize) -> u64 {
        self.table.rows.get(index).map_or(0, |row| u64::from(*row))
    }

    /// The first bad cell of a column, or that it is not as long as the others.
    pub(super) fn bad_cell(&self, column: usize) -> Option<ReadError> {
        let (values, rows) = (self.column(column)?, self.table.rows.len());
        match &values.error {
            Some((row, bad)) => {
                let error = ReadError::content(bad.to_string());
                Some(error.in_row(*row).in_column(self.header(column)))
            }
            None if values.values.len() == rows => None,
            None => {
                let name = self.head.text(column);
                Some(ReadError::unequal_columns(name, values.values.len(), rows))
            }
        }
    }
}
