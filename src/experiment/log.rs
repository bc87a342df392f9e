//! The numbers of a log as joints: cells checked, trials cut and put on a uniform grid.

use super::error::ReadError;
use super::joint::{Joint, Signal, Trial};
use super::layout::{JointLayout, TimeSource};
use super::sampling::{Fault, Grid, Repair, Signals};
use super::table::{BadCell, Column, Head, Table, TrialRows};

/// A table that was read, with what is needed to speak of its cells.
pub(super) struct Log<'a> {
    pub(super) head: &'a Head,
    pub(super) numeric: &'a [usize],
    pub(super) table: &'a Table,
}

impl Log<'_> {
    /// The trials' rows, named: the whole file is trial `1` unless it says otherwise.
    pub(super) fn trials(&self, stem: Option<&str>) -> Vec<TrialRows> {
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

    pub(super) fn grids(
        &self,
        time: TimeSource,
        trials: &[TrialRows],
        repair: Repair,
    ) -> Result<Vec<Grid>, ReadError> {
        let (column, scale) = match time {
            TimeSource::Times(column, scale) => (column, scale),
            TimeSource::SampleNumbers(column, period) => (column, period.seconds()),
            TimeSource::Rows(period) => {
                let grid =
                    |trial: &TrialRows| Grid::of_rows(trial.end - trial.start, period, repair);
                return Ok(trials.iter().map(grid).collect());
            }
        };
        let values = self.column(column).map_or(&[][..], |column| &column.values);
        let times: Vec<f64> = values.iter().map(|value| value * scale).collect();
        self.check_times(column, &times)?;
        let lay = |trial: &TrialRows| {
            let times = times.get(trial.start..trial.end).unwrap_or_default();
            Grid::lay(times, repair).map_err(|fault| self.time_error(fault, trial, times))
        };
        trials.iter().map(lay).collect()
    }

    /// Every row needs a time.
    fn check_times(&self, column: usize, times: &[f64]) -> Result<(), ReadError> {
        if let Some(error) = self.bad_cell(column) {
            return Err(error);
        }
        match times.iter().position(|time| time.is_nan()) {
            Some(index) => Err(ReadError::NoTimeInRow {
                path: self.head.path.clone(),
                row: self.row(index),
                column: self.header(column),
            }),
            None => Ok(()),
        }
    }

    fn time_error(&self, fault: Fault, trial: &TrialRows, times: &[f64]) -> ReadError {
        let path = self.head.path.clone();
        let at = |row: usize| times.get(row).copied().unwrap_or(f64::NAN);
        match fault {
            Fault::NotIncreasing { row } => ReadError::TimeNotIncreasing {
                path,
                row: self.row(trial.start + row),
                previous: at(row - 1),
                time: at(row),
            },
            Fault::NotUniform { row, step, period } => {
                ReadError::NotUniform { path, row: self.row(trial.start + row), step, period }
            }
            Fault::TooMany { samples, period } => {
                let trial = trial.label.clone();
                ReadError::TooManySamples { path, trial, samples, period }
            }
            Fault::SingleRow => ReadError::SingleRow {
                path,
                row: self.row(trial.start),
                trial: trial.label.clone(),
            },
        }
    }

    pub(super) fn joint(
        &self,
        layout: &JointLayout,
        trials: &[TrialRows],
        grids: &[Grid],
        repair: Repair,
    ) -> Result<Joint, ReadError> {
        self.check_joint(layout, repair)?;
        let mut joint = Joint {
            name: layout.name.clone(),
            input_unit: layout.input.signal.unit.clone(),
            output_unit: layout.output.signal.unit.clone(),
            covariates: layout.covariates.iter().map(|c| c.signal.clone()).collect::<Vec<Signal>>(),
            trials: Vec::new(),
        };
        for (rows, grid) in trials.iter().zip(grids) {
            let pieces = grid.pieces(&self.signals(layout, rows));
            let labels = part_labels(&rows.label, pieces.len(), trials);
            for (label, piece) in labels.into_iter().zip(pieces) {
                let Signals { input, output, covariates } = piece.signals;
                let trial = Trial::new(label, piece.start_s, grid.period(), input, output)
                    .and_then(|trial| trial.with_covariates(covariates));
                joint.trials.push(trial.map_err(|source| ReadError::Trial {
                    path: self.head.path.clone(),
                    joint: layout.name.clone(),
                    source,
                })?);
            }
        }
        if joint.trials.is_empty() {
            let (path, joint) = (self.head.path.clone(), layout.name.clone());
            return Err(ReadError::NoSamples { path, joint });
        }
        Ok(joint)
    }

    /// Refuses bad cells, and missing ones unless they may be filled.
    fn check_joint(&self, layout: &JointLayout, repair: Repair) -> Result<(), ReadError> {
        let needed = [layout.input.column, layout.output.column];
        let further = layout.covariates.iter().map(|covariate| covariate.column);
        if let Some(error) = needed.into_iter().chain(further).find_map(|c| self.bad_cell(c)) {
            return Err(error);
        }
        let empty = |column: &usize| {
            self.column(*column).is_some_and(|c| c.values.iter().all(|value| value.is_nan()))
        };
        if let Some(column) = needed.into_iter().find(empty) {
            let (path, column) = (self.head.path.clone(), self.header(column));
            return Err(ReadError::NeverMeasured { path, column });
        }
        if repair.fill_s.is_some() {
            return Ok(());
        }
        let first_missing = |column: usize| {
            let values = &self.column(column)?.values;
            values.iter().position(|value| value.is_nan()).map(|index| (index, column))
        };
        match needed.into_iter().filter_map(first_missing).min() {
            Some((index, column)) => Err(ReadError::Missing {
                path: self.head.path.clone(),
                row: self.row(index),
                column: self.header(column),
            }),
            None => Ok(()),
        }
    }

    fn signals(&self, layout: &JointLayout, rows: &TrialRows) -> Signals {
        let cut = |column: usize| {
            let values = self.column(column).map_or(&[][..], |column| &column.values);
            values.get(rows.start..rows.end).unwrap_or_default().to_vec()
        };
        Signals {
            input: cut(layout.input.column),
            output: cut(layout.output.column),
            covariates: layout.covariates.iter().map(|c| cut(c.column)).collect(),
        }
    }

    fn column(&self, index: usize) -> Option<&Column> {
        let place = self.numeric.binary_search(&index).ok()?;
        self.table.columns.get(place)
    }

    fn header(&self, column: usize) -> String {
        self.head.headers.get(column).map(|header| header.name.clone()).unwrap_or_default()
    }

    fn row(&self, index: usize) -> u64 {
        self.table.rows.number(index)
    }

    /// The first bad cell of a column.
    fn bad_cell(&self, column: usize) -> Option<ReadError> {
        let (row, bad) = self.column(column)?.error.clone()?;
        let (path, column) = (self.head.path.clone(), self.header(column));
        Some(match bad {
            BadCell::Kind(found) => ReadError::NotNumbers { path, column, found },
            BadCell::Text(text) => ReadError::NotANumber { path, row, column, text },
            BadCell::Infinite => ReadError::Infinite { path, row, column },
        })
    }
}

/// Names of the parts of a trial that was split: `a#1`, `a#2`, with as many marks as it
/// takes to meet no other trial.
fn part_labels(label: &str, parts: usize, trials: &[TrialRows]) -> Vec<String> {
    if parts == 1 {
        return vec![label.to_owned()];
    }
    let mut stem = format!("{label}#");
    while trials.iter().any(|trial| trial.label.starts_with(&stem)) {
        stem.push('#');
    }
    (1..=parts).map(|part| format!("{stem}{part}")).collect()
}
