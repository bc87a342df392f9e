//! Which column of a table is time, trial, and which signal of which joint.

use std::collections::{HashMap, HashSet};

use super::columns::{ColumnMap, JointColumns};
use super::error::{ReadError, ReadErrorKind};
use super::joint::Signal;
use super::names::{did_you_mean, listed, nearest_name};
use super::table::{Head, Header};
use super::time_column::{TimeSource, find_any, find_time_column, rest_of_times, times};
use super::unit;
use crate::units::SamplePeriod;

/// Name of a column of sample numbers.
const SAMPLE_NAME: &str = "sample";
/// Names of a column that names the trial.
const TRIAL_NAMES: [&str; 3] = ["trial", "test", "run"];

/// Stands for "no column names the trial".
const NO_TRIAL: &str = "none";

/// A signal of a joint and the column that holds it.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct SignalColumn {
    pub(super) signal: Signal,
    pub(super) column: usize,
    /// The clock it is sampled by.
    pub(super) clock: usize,
}

/// The columns of one joint.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct JointLayout {
    pub(super) name: String,
    pub(super) input: SignalColumn,
    pub(super) output: SignalColumn,
    pub(super) covariates: Vec<SignalColumn>,
}

impl JointLayout {
    /// `text` as said of the joint.
    pub(super) fn note(&self, text: &str) -> String {
        format!("joint `{}`: {text}", self.name)
    }

    /// All columns of the joint.
    pub(super) fn columns(&self) -> impl Iterator<Item = usize> {
        [&self.input, &self.output].into_iter().chain(&self.covariates).map(|signal| signal.column)
    }
}

/// What every column of a log means.
pub(super) struct Layout {
    pub(super) time: TimeSource,
    /// A column of times that are not used, since a period was given; they say whether the newest row is
    /// first.
    pub(super) unused_time: Option<usize>,
    /// Further columns of the name of the times, which must say the same: some programs write one for each
    /// signal.
    pub(super) time_again: Vec<usize>,
    /// A column of what the times have beyond whole seconds, and its unit in seconds.
    pub(super) time_rest: Option<(usize, f64)>,
    pub(super) trial: Option<usize>,
    pub(super) joints: Vec<JointLayout>,
    /// Joints that were not asked for.
    pub(super) others: Vec<JointLayout>,
    /// Joints whose columns are not complete: name and reason.
    pub(super) incomplete: Vec<(String, ReadError)>,
}

impl Layout {
    /// Finds the columns of `map`, and those with native names, in `head`.
    ///
    /// `period` stands in for a time column.
    pub(super) fn find(
        head: &Head,
        map: &ColumnMap,
        period: Option<SamplePeriod>,
    ) -> Result<Self, ReadError> {
        let columns = Columns::of(head);
        if !map.names().any(|name| columns.find(name).is_ok()) {
            head.check_is_header()?;
        }
        let trial = match map.trial.as_deref() {
            Some(NO_TRIAL) => None,
            Some(name) => Some(columns.find(name)?),
            None => find_trial(head),
        };
        let time = find_time(&columns, map, period)?;
        let time_again = named_alike(head, time);
        let is_period = matches!(time, TimeSource::Rows(_));
        let mut layout = Self {
            time,
            unused_time: find_time_column(head).filter(|_| is_period),
            time_again,
            time_rest: time.column().and_then(|column| rest_of_times(head, column)),
            trial,
            joints: Vec::new(),
            others: Vec::new(),
            incomplete: Vec::new(),
        };
        let native = if map.joints.is_empty() { native_joints(head)? } else { Vec::new() };
        layout.add_joints(&columns, if map.joints.is_empty() { &native } else { &map.joints })?;
        Ok(layout)
    }

    /// The clock of its joints' outputs, which is one after [`Self::by_clock`].
    pub(super) fn clock(&self) -> usize {
        self.joints.first().map_or(0, |joint| joint.output.clock)
    }

    /// The joints apart by the clocks of their outputs; never nothing, so that the file is
    /// read even for no joint.
    pub(super) fn by_clock(self) -> Vec<Self> {
        let mut clocks: Vec<usize> = self.joints.iter().map(|joint| joint.output.clock).collect();
        let mut seen = HashSet::new();
        clocks.retain(|clock| seen.insert(*clock));
        if clocks.len() < 2 {
            return vec![self];
        }
        let of = |clock: usize| {
            let is_of = |joint: &&JointLayout| joint.output.clock == clock;
            let joints = self.joints.iter().filter(is_of).cloned().collect();
            let others = self.others.iter().filter(is_of).cloned().collect();
            let time_again = self.time_again.clone();
            Self { time_again, joints, others, incomplete: Vec::new(), ..self }
        };
        clocks.into_iter().map(of).collect()
    }

    /// Keeps the joints named in `wanted`, the others apart; those that are not there come back
    /// as errors.
    pub(super) fn keep(&mut self, wanted: &[String]) -> Vec<(String, ReadError)> {
        if wanted.is_empty() {
            return Vec::new();
        }
        let names: Vec<String> = self.joints.iter().map(|joint| joint.name.clone()).collect();
        let is_wanted = |joint: &JointLayout| wanted.contains(&joint.name);
        (self.joints, self.others) =
            std::mem::take(&mut self.joints).into_iter().partition(is_wanted);
        self.incomplete.retain(|(name, _)| wanted.contains(name));
        let mut unknown = Vec::new();
        for joint in wanted {
            if !names.contains(joint) && self.incomplete.iter().all(|(name, _)| name != joint) {
                unknown.push((joint.clone(), unknown_joint(joint, &names)));
            }
        }
        unknown
    }

    /// Indices of all columns that hold numbers, each once.
    pub(super) fn numeric_columns(&self) -> Vec<usize> {
        let mut columns: Vec<usize> = self.time_column().into_iter().collect();
        columns.extend(&self.time_again);
        columns.extend(self.time_rest.map(|(column, _)| column));
        let joints = self.joints.iter().chain(&self.others);
        columns.extend(joints.flat_map(JointLayout::columns));
        columns.sort_unstable();
        columns.dedup();
        columns
    }

    /// The column of the times, used or not.
    pub(super) fn time_column(&self) -> Option<usize> {
        self.time.column().or(self.unused_time)
    }

    fn add_joints(
        &mut self,
        columns: &Columns<'_>,
        joints: &[JointColumns],
    ) -> Result<(), ReadError> {
        let mut names: Vec<_> = joints.iter().map(|joint| &joint.name).collect();
        names.sort();
        if let Some([name, _]) = names.array_windows().find(|[one, other]| one == other) {
            let text = format!("two joints are named `{name}`; give each its own name");
            return Err(ReadError::content(text));
        }
        for joint in joints {
            match joint_layout(columns, joint) {
                Ok(layout) => self.joints.push(layout),
                Err(error) => self.incomplete.push((joint.name.clone(), error)),
            }
        }
        Ok(())
    }
}

/// That a joint is not among those of these `names`.
pub(super) fn unknown_joint(joint: &str, names: &[String]) -> ReadError {
    let names = || names.iter().map(String::as_str);
    let (nearest, all) = (did_you_mean(nearest_name(joint, names())), listed(names()));
    let text = format!("no joint `{joint}`{nearest}; the joints are: {all}");
    ReadError::new(ReadErrorKind::NoSuchJoint, text)
}

/// The joints whose columns have native names, each with its further signals.
fn native_joints(head: &Head) -> Result<Vec<JointColumns>, ReadError> {
    let mut names: Vec<&str> = Vec::new();
    let mut seen = HashSet::new();
    let mut covariates: HashMap<&str, Vec<(String, String)>> = HashMap::new();
    // `boom.output` is the signal `output` of the joint `boom`.
    let parted = head.headers.iter().filter_map(|header| header.name.rsplit_once('.'));
    for (name, signal) in parted.filter(|(name, signal)| !name.is_empty() && !signal.is_empty()) {
        if !["input", "output"].contains(&signal) {
            let column = (signal.to_owned(), format!("{name}.{signal}"));
            covariates.entry(name).or_default().push(column);
        } else if seen.insert(name) {
            names.push(name);
        }
    }
    if names.is_empty() {
        let text = format!(
            "no joint found; a joint needs the columns `<joint>.input` and `<joint>.output`; the columns \
             are: {}",
            head.names()
        );
        let kind = ReadErrorKind::NoJoints(Box::default());
        return Err(ReadError::new(kind, text).in_row(head.header_row));
    }
    let joint = |name: &str| {
        let (input, output) = (format!("{name}.input"), format!("{name}.output"));
        let covariates = covariates.remove(name).unwrap_or_default();
        JointColumns { covariates, ..JointColumns::new(name, &input, &output) }
    };
    Ok(names.into_iter().map(joint).collect())
}

fn joint_layout(columns: &Columns<'_>, joint: &JointColumns) -> Result<JointLayout, ReadError> {
    let covariate = |(name, column): &(String, String)| signal_column(columns, column, name, None);
    let input = signal_column(columns, &joint.input, "input", joint.input_unit.as_ref())?;
    let output = signal_column(columns, &joint.output, "output", joint.output_unit.as_ref())?;
    if input.column == output.column {
        let column = columns.head.text(input.column);
        let text = format!(
            "joint `{}` has column `{column}` for its input and for its output; give each its own",
            joint.name
        );
        return Err(ReadError::content(text).in_column(column));
    }
    Ok(JointLayout {
        name: joint.name.clone(),
        input,
        output,
        covariates: joint.covariates.iter().map(covariate).collect::<Result<_, _>>()?,
    })
}

fn signal_column(
    columns: &Columns<'_>,
    column: &str,
    name: &str,
    unit: Option<&String>,
) -> Result<SignalColumn, ReadError> {
    let column = columns.find(column)?;
    let header = columns.head.headers.get(column);
    let stated = header.and_then(|header| header.unit.as_ref());
    let named = || header.and_then(|header| unit::of_signal(&header.name));
    let unit = unit.or(stated).cloned().or_else(named);
    let signal = Signal { name: name.to_owned(), unit };
    let clock = header.map_or(0, |header| header.clock);
    Ok(SignalColumn { signal, column, clock })
}

fn find_time(
    columns: &Columns<'_>,
    map: &ColumnMap,
    period: Option<SamplePeriod>,
) -> Result<TimeSource, ReadError> {
    let head = columns.head;
    if let Some(name) = &map.time {
        // Of several of a name each must say the same.
        if let Some(column) = columns.first(name) {
            return times(head, column, None);
        }
        // `t [ms]` says the unit of a column `t`.
        let (bare, unit) = unit::parted(name);
        let column = columns.first(bare).map_or_else(|| columns.find(name), Ok)?;
        return times(head, column, unit.as_deref());
    }
    // A period that was asked for stands above a time column: the user knows why.
    if let Some(period) = period {
        let numbers =
            find_any(head, &[SAMPLE_NAME]).map(|column| TimeSource::SampleNumbers(column, period));
        return Ok(numbers.unwrap_or(TimeSource::Rows(period)));
    }
    if let Some(column) = find_time_column(head) {
        return times(head, column, None);
    }
    let text = format!("no time column (`time_s`, `t_s`, `time` or `t`); found {}", head.names());
    let kind = ReadErrorKind::NoTime(index_column(head));
    Err(ReadError::new(kind, text).in_row(head.header_row))
}

/// The name of the first column, where it is that of an index which has none: pandas writes nothing or
/// `__index_level_0__`, and reads `Unnamed: 0`.
fn index_column(head: &Head) -> Option<String> {
    let text = head.headers.first()?.text.as_str();
    let is_index = text.is_empty() || text == "__index_level_0__" || text.starts_with("Unnamed: 0");
    is_index.then(|| text.to_owned())
}

/// Columns among which a name is looked for that is nearly the one that is missing: each joint
/// of a log may lack one.
const MOST_COMPARED: usize = 1000;

/// The columns of a log by their names: logs may have very many.
struct Columns<'a> {
    head: &'a Head,
    /// The first column of each name, and whether there are several.
    by_name: HashMap<&'a str, (usize, bool)>,
}

impl<'a> Columns<'a> {
    fn of(head: &'a Head) -> Self {
        let mut by_name = HashMap::new();
        // A whole header stands above a name, and this above one without the unit at its end.
        let kinds: [fn(&Header) -> Option<&str>; 3] = [
            |header| unit::without(&header.name),
            |header| Some(&header.name),
            |header| Some(&header.text),
        ];
        for name in kinds {
            let mut named: HashMap<&str, (usize, bool)> = HashMap::new();
            for (index, header) in head.headers.iter().enumerate() {
                let Some(name) = name(header) else { continue };
                named.entry(name).and_modify(|found| found.1 = true).or_insert((index, false));
            }
            by_name.extend(named);
        }
        Self { head, by_name }
    }

    /// The first column of this name.
    fn first(&self, wanted: &str) -> Option<usize> {
        self.by_name.get(wanted).map(|(index, _)| *index)
    }

    /// The column whose whole header is `wanted`, else the one whose name it is, else the one
    /// whose name it is but for a unit at its end.
    fn find(&self, wanted: &str) -> Result<usize, ReadError> {
        let head = self.head;
        match self.by_name.get(wanted) {
            Some((index, false)) => Ok(*index),
            Some((_, true)) => Err(head.two_columns(wanted)),
            None => {
                let few = Some(&head.headers).filter(|headers| headers.len() <= MOST_COMPARED);
                let names = few.into_iter().flatten().map(|header| header.name.as_str());
                let text = format!(
                    "column `{wanted}` is missing{}; the columns are: {}",
                    did_you_mean(nearest_name(wanted, names)),
                    head.names()
                );
                let error = ReadError::new(ReadErrorKind::MissingColumn, text);
                Err(error.in_row(head.header_row).in_column(wanted))
            }
        }
    }
}

/// The column that a name such as `trial` says names the trials.
pub(super) fn find_trial(head: &Head) -> Option<usize> {
    find_any(head, &TRIAL_NAMES)
}

/// The other columns that are named as that of the times is.
fn named_alike(head: &Head, time: TimeSource) -> Vec<usize> {
    let TimeSource::Times(column, _) = time else { return Vec::new() };
    let text = head.headers.get(column).map_or("", |header| &header.text);
    let alike = head.headers.iter().enumerate().filter(|(_, header)| header.text == text);
    alike.map(|(index, _)| index).filter(|index| *index != column).collect()
}
