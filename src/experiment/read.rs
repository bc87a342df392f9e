//! Logs into an [`Experiment`]; what cannot be read is listed beside what can.

use std::path::{Path, PathBuf};

use serde::Serialize;

use super::error::{listed, nearest_name};
use super::format::{self, is_named_like_a_log};
use super::layout::{JointLayout, Layout, TimeSource};
use super::sampling::{Fault, Grid, Repair, Signals};
use super::table::{BadCell, Column, Head, OpenTable, Table, TrialRows, source_of};
use super::{ColumnMap, Joint, ReadError, Signal, Source, Trial};
use crate::units::SamplePeriod;

/// How logs are read.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct ReadOptions {
    /// The columns of a foreign log.
    pub columns: ColumnMap,
    /// The joints to keep; all when empty.
    pub joints: Vec<String>,
    /// What may be done to gaps and to uneven sampling.
    pub repair: Repair,
}

/// Everything that was measured, of one file or many.
#[derive(Debug, Default)]
pub struct Experiment {
    /// The files that were read, in the order given.
    pub sources: Vec<Source>,
    /// The joints, in the order of the logs. Files with the same joint add trials to it.
    pub joints: Vec<Joint>,
    /// Files and joints that could not be read.
    pub failures: Vec<Failure>,
    /// How they were read.
    pub options: ReadOptions,
    /// What was done to the logs that their reader should know: trials that were split.
    pub notes: Vec<String>,
}

/// A file, or a joint in it, that could not be read.
#[derive(Debug)]
pub struct Failure {
    /// The joint, where the rest of the file could be read.
    pub joint: Option<String>,
    /// Why.
    pub error: ReadError,
}

impl Experiment {
    /// Reads `paths` in order. Never fails as a whole: see [`Experiment::failures`].
    ///
    /// With several files a trial is named after its file: `stem`, or `stem/trial`
    /// where the file names its trials itself.
    pub fn read(paths: &[PathBuf], options: &ReadOptions) -> Self {
        let mut experiment = Self { options: options.clone(), ..Self::default() };
        let mut stems: Vec<String> = Vec::new();
        for path in paths {
            let stem = (paths.len() > 1).then(|| unique_stem(path, &stems));
            match read_log(path, stem.as_deref(), options) {
                Ok(log) => experiment.add(log, path),
                Err(error) => experiment.failures.push(Failure { joint: None, error }),
            }
            stems.extend(stem);
        }
        experiment
    }

    pub(super) fn add(&mut self, log: Self, path: &Path) {
        self.sources.extend(log.sources);
        self.failures.extend(log.failures);
        self.notes.extend(log.notes);
        for joint in log.joints {
            match self.joints.iter_mut().find(|known| known.name == joint.name) {
                None => self.joints.push(joint),
                Some(known) => {
                    if let Err(error) = merge(known, joint, path) {
                        let joint = Some(known.name.clone());
                        self.failures.push(Failure { joint, error });
                    }
                }
            }
        }
    }
}

/// Adds the trials of `joint` to those of the same joint in earlier logs.
fn merge(known: &mut Joint, joint: Joint, path: &Path) -> Result<(), ReadError> {
    let units = |joint: &Joint| (joint.input_unit.clone(), joint.output_unit.clone());
    if units(known) != units(&joint) || known.covariates != joint.covariates {
        let describe = |joint: &Joint| {
            let unit = |unit: &Option<String>| unit.clone().unwrap_or_else(|| "no unit".to_owned());
            let mut parts = vec![unit(&joint.input_unit), unit(&joint.output_unit)];
            parts.extend(joint.covariates.iter().map(|s| format!("{} {}", s.name, unit(&s.unit))));
            parts.join(", ")
        };
        return Err(ReadError::UnitsDiffer {
            path: path.to_owned(),
            joint: joint.name.clone(),
            found: describe(&joint),
            expected: describe(known),
        });
    }
    known.trials.extend(joint.trials);
    Ok(())
}

fn unique_stem(path: &Path, taken: &[String]) -> String {
    let stem = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
    if !taken.contains(&stem) {
        return stem;
    }
    let mut number = 2;
    while taken.contains(&format!("{stem}~{number}")) {
        number += 1;
    }
    format!("{stem}~{number}")
}

/// Files as they are; of a folder its logs (`.csv`, `.tsv`, `.txt`, `.parquet`, `.mat`,
/// `.mcap`), sorted by name.
///
/// Truth files (`*.truth.csv`) are no logs and are left out: of a folder, and beside logs, as
/// a shell's pattern `*.csv` names both.
///
/// Beside the files, the folders that cannot be listed ([`ReadError::Io`]) or hold no log
/// ([`ReadError::EmptyFolder`]).
pub fn expand_folders(paths: &[PathBuf]) -> (Vec<PathBuf>, Vec<Failure>) {
    let (mut files, mut failures) = (Vec::new(), Vec::new());
    for path in paths {
        match logs_in(path) {
            Ok(logs) => files.extend(logs),
            Err(error) => failures.push(Failure { joint: None, error }),
        }
    }
    if !files.iter().all(|file| is_truth(file)) {
        files.retain(|file| !is_truth(file));
    }
    (files, failures)
}

fn logs_in(path: &Path) -> Result<Vec<PathBuf>, ReadError> {
    if !path.is_dir() {
        return Ok(vec![path.to_owned()]);
    }
    let io_error = |source| ReadError::Io { path: path.to_owned(), source };
    let mut logs = Vec::new();
    for entry in path.read_dir().map_err(io_error)? {
        logs.push(entry.map_err(io_error)?.path());
    }
    logs.retain(|file| is_log(file));
    logs.sort();
    if logs.is_empty() {
        return Err(ReadError::EmptyFolder { path: path.to_owned() });
    }
    Ok(logs)
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

fn is_log(path: &Path) -> bool {
    is_named_like_a_log(&lower_name(path)) && !is_truth(path) && path.is_file()
}

fn is_truth(path: &Path) -> bool {
    lower_name(path).ends_with(".truth.csv")
}

fn lower_name(path: &Path) -> String {
    path.file_name().unwrap_or_default().to_string_lossy().to_lowercase()
}

fn read_log(
    path: &Path,
    stem: Option<&str>,
    options: &ReadOptions,
) -> Result<Experiment, ReadError> {
    let table = format::open(path)?;
    let (layout, mut found) = laid_out(&table.head, options)?;
    let mut next = Some(table);
    for layout in layout.by_clock() {
        // Each clock has rows of its own, and is read in a pass of its own.
        let table = next.take().map_or_else(|| format::open(path), Ok)?;
        found.read_clock(table, &layout, stem, options.repair)?;
    }
    Ok(found)
}

/// What every column means, and the joints that are not to be had.
pub(super) fn laid_out(
    head: &Head,
    options: &ReadOptions,
) -> Result<(Layout, Experiment), ReadError> {
    let period = sample_period(&head.path, &options.columns)?;
    let mut layout = Layout::find(head, &options.columns, period)?;
    let unknown = layout.keep(&head.path, &options.joints);
    let incomplete = std::mem::take(&mut layout.incomplete);
    let mut found = Experiment::default();
    found.failures.extend(incomplete.into_iter().chain(unknown).map(failed));
    Ok((layout, found))
}

fn failed((joint, error): (String, ReadError)) -> Failure {
    Failure { joint: Some(joint), error }
}

impl Experiment {
    /// Adds the joints of `layout`, which share their rows.
    fn read_clock(
        &mut self,
        table: OpenTable,
        layout: &Layout,
        stem: Option<&str>,
        repair: Repair,
    ) -> Result<(), ReadError> {
        let head = table.head.clone();
        if layout.joints.is_empty() {
            self.sources.push(source_of(&head.path)?);
            return Ok(());
        }
        let numeric = layout.numeric_columns();
        let table = table.read(&numeric, layout.trial, layout.clock())?;
        let log = Log { head: &head, numeric: &numeric, table: &table };
        self.add_log(&log, layout, stem, repair)
    }

    /// Adds the joints of `layout` with the numbers of `log`.
    pub(super) fn add_log(
        &mut self,
        log: &Log<'_>,
        layout: &Layout,
        stem: Option<&str>,
        repair: Repair,
    ) -> Result<(), ReadError> {
        let trials = log.trials(stem);
        let grids = log.grids(layout.time, &trials, repair)?;
        for joint in &layout.joints {
            match log.joint(joint, &trials, &grids, repair) {
                Ok(joint) => {
                    self.notes.extend(split_notes(&joint, &trials));
                    self.joints.push(joint);
                }
                Err(error) => self.failures.push(failed((joint.name.clone(), error))),
            }
        }
        self.notes.extend(log.table.notes.iter().cloned());
        if self.sources.is_empty() {
            self.sources.push(log.table.source.clone());
        }
        Ok(())
    }
}

/// A line on each trial of `joint` that was split at gaps.
fn split_notes(joint: &Joint, trials: &[TrialRows]) -> Vec<String> {
    let parts = |trial: &TrialRows| {
        let parts = joint.trials.iter().filter(|part| {
            let rest = part.label().strip_prefix(&trial.label);
            rest.is_some_and(|rest| rest.starts_with('#'))
        });
        let whole = joint.trials.iter().any(|part| part.label() == trial.label);
        let count = parts.count();
        let (name, label) = (&joint.name, &trial.label);
        (!whole && count > 1)
            .then(|| format!("joint `{name}`: trial `{label}` is split in {count} at long gaps"))
    };
    trials.iter().filter_map(parts).collect()
}

fn sample_period(path: &Path, map: &ColumnMap) -> Result<Option<SamplePeriod>, ReadError> {
    let Some(seconds) = map.sample_period_s else {
        return Ok(None);
    };
    let bad = || ReadError::BadPeriod { path: path.to_owned(), seconds };
    SamplePeriod::from_seconds(seconds).map(Some).ok_or_else(bad)
}

impl Layout {
    /// Keeps the joints named in `wanted`; those that are not there come back as errors.
    fn keep(&mut self, path: &Path, wanted: &[String]) -> Vec<(String, ReadError)> {
        if wanted.is_empty() {
            return Vec::new();
        }
        let names: Vec<String> = self.joints.iter().map(|joint| joint.name.clone()).collect();
        self.joints.retain(|joint| wanted.contains(&joint.name));
        self.incomplete.retain(|(name, _)| wanted.contains(name));
        let incomplete = &self.incomplete;
        let known = |name: &String| {
            names.contains(name) || incomplete.iter().any(|(incomplete, _)| incomplete == name)
        };
        let error = |name: &String| ReadError::UnknownJoint {
            path: path.to_owned(),
            joint: name.clone(),
            nearest: nearest_name(name, names.iter().map(String::as_str)),
            available: listed(names.iter().map(String::as_str)),
        };
        wanted.iter().filter(|name| !known(name)).map(|name| (name.clone(), error(name))).collect()
    }

    /// Indices of all columns that hold numbers, each once.
    pub(super) fn numeric_columns(&self) -> Vec<usize> {
        let mut columns: Vec<usize> = self.time.column().into_iter().collect();
        for joint in &self.joints {
            columns.extend([joint.input.column, joint.output.column]);
            columns.extend(joint.covariates.iter().map(|covariate| covariate.column));
        }
        columns.sort_unstable();
        columns.dedup();
        columns
    }
}

/// A table that was read, with what is needed to speak of its cells.
pub(super) struct Log<'a> {
    pub(super) head: &'a Head,
    pub(super) numeric: &'a [usize],
    pub(super) table: &'a Table,
}

impl Log<'_> {
    /// The trials' rows, named: the whole file is trial `1` unless it says otherwise.
    fn trials(&self, stem: Option<&str>) -> Vec<TrialRows> {
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

    fn grids(
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

    fn joint(
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
