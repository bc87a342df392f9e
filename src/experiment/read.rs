//! Logs into an [`Experiment`]; what cannot be read is listed beside what can.

use std::collections::HashMap;
use std::path::{Path, PathBuf};

use serde::Serialize;

use super::clock::is_period;
use super::columns::ColumnMap;
use super::error::{ReadError, ReadErrorKind};
use super::format::{self, is_named_like_a_log};
use super::grid::Repair;
use super::joint::Joint;
use super::layout::{JointLayout, Layout};
use super::log::Log;
use super::memory::{Budget, MemoryLimit};
use super::names::on_one_line;
use super::repairs::mend_all;
use super::source::{Source, source_of};
use super::survey::Survey;
use super::table::{Head, OpenTable};
use super::time_column::{find_time_column, note_on_times};
use super::trial::Trial;
use crate::units::SamplePeriod;

/// How logs are read.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct ReadOptions {
    /// The columns of a foreign log.
    pub columns: ColumnMap,
    /// The joints to keep; all when empty.
    pub joints: Vec<String>,
    /// Whether the joints that are not kept are read, too, as [`Experiment::others`].
    #[serde(skip)]
    pub others: bool,
    /// What may be done to gaps and to uneven sampling.
    pub repair: Repair,
    /// How much memory they may take.
    #[serde(skip)]
    pub memory: MemoryLimit,
}

/// Everything that was measured, of one file or many.
#[derive(Debug, Default)]
pub struct Experiment {
    /// The files that were read, in the order given.
    pub sources: Vec<Source>,
    /// The joints, in the order of the logs. Files with the same joint add trials to it.
    pub joints: Vec<Joint>,
    /// Joints that were not asked for, of which only is known what they draw from a pump that all
    /// share; one that cannot be read is left out.
    pub others: Vec<Joint>,
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
    /// where the file names its trials itself. A file that is given twice, also by a link, is read
    /// once.
    pub fn read(paths: &[PathBuf], options: &ReadOptions) -> Self {
        let mut experiment = Self { options: options.clone(), ..Self::default() };
        let budget = Budget::new(options.memory);
        let mut stems: Vec<String> = Vec::new();
        let mut known: HashMap<PathBuf, &Path> = HashMap::new();
        for path in paths {
            if let Some(first) = path.canonicalize().ok().and_then(|file| known.insert(file, path))
            {
                let (twice, first) = (path.display(), first.display());
                experiment.notes.push(format!("{twice}: is the same file as {first}; read once"));
                continue;
            }
            let stem = (paths.len() > 1).then(|| unique_stem(path, &stems));
            let place = Place {
                open: &|| format::open(path, budget.rest()),
                source: &|| source_of(path),
                file: Some(path),
                stem: stem.as_deref(),
            };
            experiment.add(read_log(&place, options, &budget), path);
            stems.extend(stem);
        }
        experiment.skip_logs_without();
        experiment
    }

    /// That a log lacks a joint which is asked for is no failure where another log has it: how many do is
    /// said.
    pub(super) fn skip_logs_without(&mut self) {
        let is_mapped = !self.options.columns.joints.is_empty();
        let is_absent = |kind: &ReadErrorKind| match kind {
            ReadErrorKind::NoSuchJoint => true,
            ReadErrorKind::MissingColumn => is_mapped,
            _ => false,
        };
        let is_read = |name: &&String| self.joints.iter().any(|joint| joint.name == **name);
        for name in self.options.joints.iter().filter(is_read) {
            let before = self.failures.len();
            self.failures.retain(|failure| {
                failure.joint.as_ref() != Some(name) || !is_absent(&failure.error.kind)
            });
            let (without, all) = (before - self.failures.len(), self.sources.len());
            if without > 0 {
                let note = format!(
                    "joint `{name}`: {without} of {all} logs do not have it and are skipped"
                );
                self.notes.push(note);
            }
        }
    }

    /// Adds what was read of the log at `path`, whose name stands before what is said of it; a note that begins
    /// with a joint is said of that.
    pub(super) fn add(&mut self, log: Result<Self, ReadError>, path: &Path) {
        let log = log.unwrap_or_else(|error| Self {
            failures: vec![Failure { joint: None, error }],
            ..Self::default()
        });
        let whose = |note: String| {
            if note.starts_with("joint `") { note } else { format!("{}: {note}", path.display()) }
        };
        self.sources.extend(log.sources);
        self.notes.extend(log.notes.into_iter().map(whose));
        let contradictions = add_joints(&mut self.joints, log.joints);
        let failures = log.failures.into_iter().chain(contradictions);
        let in_file = |failure: Failure| Failure { error: failure.error.in_file(path), ..failure };
        self.failures.extend(failures.map(in_file));
        // One whose units differ from log to log still has an input.
        add_joints(&mut self.others, log.others);
    }
}

/// Adds `joints` to the `known` ones, trials to those of a joint that is there; what differs
/// comes back.
fn add_joints(known: &mut Vec<Joint>, joints: Vec<Joint>) -> Vec<Failure> {
    let mut failures = Vec::new();
    let names = known.iter().map(|joint| joint.name.clone());
    let mut places: HashMap<String, usize> = names.zip(0..).collect();
    for joint in joints {
        let place = *places.entry(joint.name.clone()).or_insert(known.len());
        match known.get_mut(place) {
            None => known.push(joint),
            Some(known) => {
                let merged = merge(known, joint);
                failures.extend(merged.err().map(|error| failed((known.name.clone(), error))));
            }
        }
    }
    failures
}

/// Adds the trials of `joint` to those of the same joint in earlier logs.
fn merge(known: &mut Joint, joint: Joint) -> Result<(), ReadError> {
    let units = |joint: &Joint| (joint.input_unit.clone(), joint.output_unit.clone());
    if units(known) != units(&joint) || known.covariates != joint.covariates {
        let describe = |joint: &Joint| {
            let unit = |unit: &Option<String>| unit.clone().unwrap_or_else(|| "no unit".to_owned());
            let mut parts = vec![unit(&joint.input_unit), unit(&joint.output_unit)];
            parts.extend(joint.covariates.iter().map(|s| format!("{} {}", s.name, unit(&s.unit))));
            parts.join(", ")
        };
        let (name, found, expected) = (&joint.name, describe(&joint), describe(known));
        let text =
            format!("joint `{name}` is in [{found}] here but in [{expected}] in an earlier log");
        return Err(ReadError::content(text));
    }
    // The clocks of logs that both count from 1970 are one.
    let origin_s = known.trials.first().map_or(0.0, Trial::origin_s);
    let on_one_clock = |trial: Trial| match trial.origin_s() {
        later if later != 0.0 && origin_s != 0.0 => trial.counted_from(origin_s - later),
        _ => trial,
    };
    let later = joint.trials.into_iter().map(on_one_clock);
    known.trials = std::mem::take(&mut known.trials).into_iter().chain(later).collect();
    Ok(())
}

fn unique_stem(path: &Path, taken: &[String]) -> String {
    let stem = path.file_stem().unwrap_or_default().to_string_lossy();
    let stem = on_one_line(&stem).into_owned();
    if !taken.contains(&stem) {
        return stem;
    }
    let mut number = 2;
    while taken.contains(&format!("{stem}~{number}")) {
        number += 1;
    }
    format!("{stem}~{number}")
}

/// Files as they are; of a folder its logs, known by their endings (`.csv`, `.xlsx`, `.parquet`,
/// `.mat`, `.mcap` and others), sorted by name.
///
/// Hidden files (`.*`) are left out. Truth files (`*.truth.csv`) are no logs and are left out: of a folder, and beside logs, as
/// a shell's pattern `*.csv` names both.
///
/// Beside the files, the folders that cannot be listed ([`ReadErrorKind::Io`]) or hold no log
/// ([`ReadErrorKind::Empty`]).
pub fn expand_folders(paths: &[PathBuf]) -> (Vec<PathBuf>, Vec<Failure>) {
    let (mut files, mut failures) = (Vec::new(), Vec::new());
    for path in paths {
        match logs_in(path).map_err(ReadError::from) {
            _ if !path.is_dir() => files.push(path.clone()),
            Ok(logs) if !logs.is_empty() => files.extend(logs),
            found => {
                let error = found.err().unwrap_or_else(|| no_log(path)).in_file(path);
                failures.push(Failure { joint: None, error });
            }
        }
    }
    if !files.iter().all(|file| is_truth(file)) {
        files.retain(|file| !is_truth(file));
    }
    (files, failures)
}

/// The logs in a folder, sorted.
fn logs_in(folder: &Path) -> std::io::Result<Vec<PathBuf>> {
    let paths = folder.read_dir()?.map(|entry| Ok(entry?.path()));
    let mut logs = paths.collect::<std::io::Result<Vec<PathBuf>>>()?;
    logs.retain(|file| is_log(file));
    logs.sort();
    Ok(logs)
}

/// That a folder holds no log.
fn no_log(folder: &Path) -> ReadError {
    let text = match folders_with_logs(folder).first() {
        Some(first) => format!(", but in folders within it; name those, as `{}`", first.display()),
        None => format!("; logs end in {}", format::endings()),
    };
    ReadError::new(ReadErrorKind::Empty, format!("no log in this folder{text}"))
}

/// A note on each of the folders in `paths` that has logs in folders of its own, which
/// [`expand_folders`] leaves out.
pub(crate) fn notes_on_subfolders(paths: &[PathBuf]) -> Vec<String> {
    let mut notes = Vec::new();
    for path in paths.iter().filter(|path| logs_in(path).is_ok_and(|logs| !logs.is_empty())) {
        if let Some(first) = folders_with_logs(path).first() {
            let (path, first) = (path.display(), first.display());
            notes.push(format!(
                "{path}: logs in folders within it are left out; name them to read them, as `{first}`"
            ));
        }
    }
    notes
}

/// The folders in `path` that hold logs, sorted; none where it cannot be listed.
fn folders_with_logs(path: &Path) -> Vec<PathBuf> {
    let holds_logs = |inner: &PathBuf| logs_in(inner).is_ok_and(|logs| !logs.is_empty());
    let entries = path.read_dir().into_iter().flatten().flatten().map(|entry| entry.path());
    let mut inner: Vec<PathBuf> = entries.filter(holds_logs).collect();
    inner.sort();
    inner
}

fn is_log(path: &Path) -> bool {
    let name = lower_name(path);
    // As a shell's pattern does: `._run.csv` is what macOS says of a log, and none.
    let is_hidden = name.starts_with('.');
    !is_hidden && is_named_like_a_log(&name) && !is_truth(path) && path.is_file()
}

fn is_truth(path: &Path) -> bool {
    lower_name(path).ends_with(".truth.csv")
}

fn lower_name(path: &Path) -> String {
    path.file_name().unwrap_or_default().to_string_lossy().to_lowercase()
}

/// Where a log is, and how it is opened, as often as it takes.
pub(super) struct Place<'a> {
    pub(super) open: &'a dyn Fn() -> Result<OpenTable, ReadError>,
    /// All of it, for its hash.
    pub(super) source: &'a dyn Fn() -> Result<Source, ReadError>,
    /// Its file, beside which a mapping may be kept.
    pub(super) file: Option<&'a Path>,
    /// What its trials are named after, where there are several logs.
    pub(super) stem: Option<&'a str>,
}

pub(super) fn read_log(
    place: &Place<'_>,
    options: &ReadOptions,
    budget: &Budget,
) -> Result<Experiment, ReadError> {
    let table = (place.open)()?;
    let (layout, mut found) = match laid_out(&table.head, options) {
        Err(error) if error.has_no_joints() => laid_out_foreign(&table.head, place, options)?,
        found => found?,
    };
    let mut next = Some(table);
    let mut failed_clocks = Vec::new();
    for layout in layout.by_clock() {
        // Each clock has rows of its own, and is read in a pass of its own.
        let table = next.take().map_or_else(place.open, Ok)?;
        if let Err(error) = found.read_clock(table, &layout, place, options.repair, budget) {
            failed_clocks.push((layout.joints, error));
        }
    }
    if found.joints.is_empty() && !failed_clocks.is_empty() {
        return Err(failed_clocks.swap_remove(0).1);
    }
    // An error in one time column fails the joints that use it; joints with another one are read.
    for (joints, error) in failed_clocks {
        let Some((first, others)) = joints.split_first() else { return Err(error) };
        found.failures.push(failed((first.name.clone(), error)));
        for joint in others {
            let text = format!(
                "it is left out, too, because it has the same time column as joint `{}`, whose rows cannot be \
                 read",
                first.name
            );
            let error = ReadError::content(text);
            found.failures.push(failed((joint.name.clone(), error)));
        }
    }
    Ok(found)
}

/// What every column means, and the joints that are not to be had.
fn laid_out(head: &Head, options: &ReadOptions) -> Result<(Layout, Experiment), ReadError> {
    let period = sample_period(&options.columns)?;
    let mut layout = Layout::find(head, &options.columns, period)?;
    let unknown = layout.keep(&options.joints);
    head.check_names(layout.joints.iter().flat_map(JointLayout::columns))?;
    if !options.others {
        layout.others.clear();
    }
    let incomplete = std::mem::take(&mut layout.incomplete);
    let mut found = Experiment::default();
    found.failures.extend(incomplete.into_iter().chain(unknown).map(failed));
    let is_period_given = period.is_some() && options.columns.time.is_none();
    if let Some(unused) = find_time_column(head).filter(|_| is_period_given) {
        let name = head.headers.get(unused).map_or("", |header| &header.name);
        found.notes.push(format!("the times in `{name}` are not used: a sample period was given"));
    }
    let signals = layout.numeric_columns();
    let note = layout.time.column().and_then(|column| note_on_times(head, column, &signals));
    found.notes.extend(note);
    Ok((layout, found))
}

/// What every column means in a log without native names: as the mapping beside it says, else by names and
/// data.
fn laid_out_foreign(
    head: &Head,
    place: &Place<'_>,
    options: &ReadOptions,
) -> Result<(Layout, Experiment), ReadError> {
    let unusable = match place.file.map_or(Ok(None), ColumnMap::kept_beside) {
        Ok(Some((file, kept))) => match laid_out_as_kept(head, &file, kept, options) {
            // It was kept for another log of the folder.
            Err(error) if matches!(error.kind, ReadErrorKind::MissingColumn) => {
                let (file, column) = (file.display(), error.column().unwrap_or_default());
                Some(format!("`{file}` names the column `{column}`, which this log lacks"))
            }
            Err(error) => {
                let error = error.in_file(place.file.unwrap_or(&file));
                Some(format!("`{}`: {error}", file.display()))
            }
            laid_out => return laid_out,
        },
        Ok(None) => None,
        Err(error) => Some(error.to_string()),
    };
    let unusable = unusable.map(|why| format!("the mapping beside it is not used: {why}"));
    let survey = Survey::of_table((place.open)()?)?;
    let laid_out = laid_out_by_names(head, &survey, options);
    let (layout, mut found) = laid_out.map_err(|error| match &unusable {
        Some(why) if error.has_no_joints() => error.with(&format!("; {why}")),
        _ => error,
    })?;
    found.notes.extend(unusable);
    Ok((layout, found))
}

/// What every column means as the mapping `kept` in `file` beside the log says.
fn laid_out_as_kept(
    head: &Head,
    file: &Path,
    kept: ColumnMap,
    options: &ReadOptions,
) -> Result<(Layout, Experiment), ReadError> {
    let given = &options.columns;
    let period = given.sample_period_s.or(kept.sample_period_s);
    let time = kept.time.filter(|_| given.sample_period_s.is_none());
    let columns = ColumnMap {
        time: given.time.clone().or(time),
        trial: given.trial.clone().or(kept.trial),
        sample_period_s: period,
        joints: kept.joints,
        estimate: given.estimate.clone(),
    };
    let (layout, mut found) = laid_out(head, &ReadOptions { columns, ..options.clone() })?;
    // Joints whose columns the log lacks are no reason to leave out the others.
    if let (true, Some(_)) = (layout.joints.is_empty(), found.failures.first()) {
        return Err(found.failures.remove(0).error);
    }
    let settings = if kept.estimate.is_empty() {
        ""
    } else {
        "; `--columns` with this file takes the settings of its joints, too"
    };
    let file = file.display();
    found.notes.push(format!("its columns are those that `{file}` names{settings}"));
    Ok((layout, found))
}

/// What every column means in a log without native names, where `survey` is sure of it.
fn laid_out_by_names(
    head: &Head,
    survey: &Survey,
    options: &ReadOptions,
) -> Result<(Layout, Experiment), ReadError> {
    let mut options = options.clone();
    if survey.is_sure {
        options.columns.joints.clone_from(&survey.map.joints);
    }
    let (layout, mut found) = laid_out(head, &options).map_err(|mut error| {
        if let ReadErrorKind::NoJoints(likely) = &mut error.kind {
            **likely = (survey.map.time.clone(), survey.named_joints());
        }
        error
    })?;
    let joints = options.columns.named_joints().into_iter();
    let joints = joints.map(|[name, u, y]| format!("{name} (input `{u}`, output `{y}`)"));
    let joints: Vec<String> = joints.collect();
    found.notes.push(format!("joints by the names of the columns: {}", joints.join(", ")));
    let further = survey.further_inputs.iter().filter(|_| survey.is_sure);
    found.notes.extend(further.map(|(joint, column)| {
        format!(
            "joint `{joint}`: `{column}` looks like an input of it, too, and is not used; of a valve with two \
             coils, log the difference of both as one column and name it with `--joint`"
        )
    }));
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
        place: &Place<'_>,
        repair: Repair,
        budget: &Budget,
    ) -> Result<(), ReadError> {
        let head = table.head.clone();
        if layout.joints.is_empty() {
            self.sources.push((place.source)()?);
            return Ok(());
        }
        let numeric = layout.numeric_columns();
        let columns = [layout.trial, layout.time_column()];
        let mut table = table.read(&numeric, columns, layout.clock(), repair)?;
        if table.source.is_none() {
            table.source = Some((place.source)()?);
        }
        let mut log = Log::new(&head, layout, &numeric, table, budget, (repair, place.stem));
        mend_all(&mut log)?;
        let grids = log.main_grids()?;
        self.notes.append(&mut log.notes);
        for joint in &log.layout.joints {
            match log.joint(joint, &grids) {
                Ok((read, notes)) => {
                    self.notes.extend(notes.iter().map(|note| joint.note(note)));
                    self.joints.push(read);
                }
                Err(error) => self.failures.push(failed((joint.name.clone(), error))),
            }
        }
        let others = log.layout.others.iter().map(|joint| log.joint(joint, &grids));
        self.others.extend(others.filter_map(Result::ok).map(|(joint, _)| joint));
        self.notes.append(&mut log.table.notes);
        if self.sources.is_empty() {
            self.sources.extend(log.table.source);
        }
        Ok(())
    }
}

fn sample_period(map: &ColumnMap) -> Result<Option<SamplePeriod>, ReadError> {
    let Some(seconds) = map.sample_period_s else {
        return Ok(None);
    };
    let period = Some(seconds).filter(|seconds| is_period(*seconds));
    period.and_then(SamplePeriod::from_seconds).map(Some).ok_or_else(|| {
        let text = format!("a sample period of {seconds} s is not one from 1e-9 to 1e8 s");
        ReadError::content(text)
    })
}
