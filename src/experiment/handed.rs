//! Logs that a program already has in memory.

use std::path::Path;
use std::rc::Rc;

use super::error::ReadError;
use super::joint::Joint;
use super::layout::unknown_joint;
use super::memory::Budget;
use super::read::{Experiment, Failure, Place, ReadOptions, read_log};
use super::source::{Source, Sum};
use super::table::{Head, Header, OpenTable, Table, Values, Wanted};

/// A log in memory: columns of equal length, with the names that a file would have.
#[derive(Clone, Debug, PartialEq)]
pub struct HandedLog {
    /// What messages call it, and its trials where there are several logs.
    pub name: String,
    /// Its columns, in order.
    pub columns: Vec<HandedColumn>,
}

/// A column in memory.
#[derive(Clone, Debug, PartialEq)]
pub struct HandedColumn {
    /// Its name, with a unit in brackets where it has one: `boom.output [deg]`.
    pub name: String,
    /// One value per row.
    pub values: HandedValues,
}

/// The values of a column in memory.
#[derive(Clone, Debug, PartialEq)]
pub enum HandedValues {
    /// Numbers; what is missing is NaN.
    Numbers(Vec<f64>),
    /// Texts, as of a column that names the trials.
    Texts(Vec<String>),
}

impl Experiment {
    /// The experiment of logs in memory: what [`Experiment::read`] finds in files with these
    /// columns, the row of a value being its number from 1.
    ///
    /// # Examples
    /// ```
    /// use tauscope::experiment::{Experiment, HandedColumn, HandedLog, HandedValues, ReadOptions};
    ///
    /// let column = |name: &str, numbers: Vec<f64>| HandedColumn {
    ///     name: name.to_owned(),
    ///     values: HandedValues::Numbers(numbers),
    /// };
    /// let columns = vec![
    ///     column("time_s", vec![0.0, 0.1, 0.2]),
    ///     column("boom.input [V]", vec![0.0, 1.0, 1.0]),
    ///     column("boom.output [deg]", vec![0.0, 0.0, 0.5]),
    /// ];
    /// let log = HandedLog { name: "bench".to_owned(), columns };
    /// let experiment = Experiment::of_logs(vec![log], &ReadOptions::default());
    /// assert_eq!(experiment.joints[0].input_unit.as_deref(), Some("V"));
    /// ```
    pub fn of_logs(logs: Vec<HandedLog>, options: &ReadOptions) -> Self {
        let mut experiment = Self { options: options.clone(), ..Self::default() };
        let budget = Budget::new(options.memory);
        let is_one = logs.len() == 1;
        for log in logs {
            let log = Rc::new(log);
            let place = Place {
                open: &|| open(&log, budget.rest()),
                source: &|| Ok(source_of(&log)),
                file: None,
                stem: Some(&*log.name).filter(|_| !is_one),
            };
            experiment.add(read_log(&place, options, &budget), Path::new(&log.name));
        }
        experiment.skip_logs_without();
        experiment
    }

    /// The experiment of joints in memory, which messages call `name`; those that `options`
    /// does not name are left out.
    pub fn of_joints(joints: Vec<Joint>, name: &str, options: &ReadOptions) -> Self {
        let mut experiment = Self { options: options.clone(), ..Self::default() };
        experiment.sources.push(source(Path::new(name), &joints));
        let names: Vec<String> = joints.iter().map(|joint| joint.name.clone()).collect();
        for wanted in options.joints.iter().filter(|wanted| !names.contains(wanted)) {
            let error = unknown_joint(wanted, &names).in_file(Path::new(name));
            experiment.failures.push(Failure { joint: Some(wanted.clone()), error });
        }
        let is_kept =
            |joint: &Joint| options.joints.is_empty() || options.joints.contains(&joint.name);
        experiment.joints = joints.into_iter().filter(is_kept).collect();
        experiment
    }
}

/// What stands for the file: the hash of all numbers.
fn source(path: &Path, joints: &[Joint]) -> Source {
    let mut sum = Sum::default();
    for trial in joints.iter().flat_map(|joint| &joint.trials) {
        add(&mut sum, trial.input());
        add(&mut sum, trial.output());
    }
    sum.source(path)
}

/// Adds numbers as they lie in memory.
fn add(sum: &mut Sum, values: &[f64]) {
    for value in values {
        sum.add(&value.to_le_bytes());
    }
}

/// Opens a log in memory.
fn open(log: &Rc<HandedLog>, budget: Budget) -> Result<OpenTable, ReadError> {
    if log.columns.is_empty() {
        return Err(ReadError::empty());
    }
    let headers = log.columns.iter().map(|column| Header::parse(&column.name)).collect();
    let log = Rc::clone(log);
    let read_rows = move |wanted: &Wanted<'_>| {
        Table::of_values(wanted, |place| {
            Ok(match log.columns.get(place).map(|column| &column.values) {
                Some(HandedValues::Numbers(numbers)) => Values::Numbers(numbers.clone()),
                Some(HandedValues::Texts(texts)) => Values::Texts(texts.clone()),
                None => Values::default(),
            })
        })
    };
    Ok(OpenTable::new((Head::without_lines(headers), Box::new(read_rows)), budget))
}

fn source_of(log: &HandedLog) -> Source {
    let mut sum = Sum::default();
    for HandedColumn { name, values } in &log.columns {
        sum.add(name.as_bytes());
        match values {
            HandedValues::Numbers(numbers) => add(&mut sum, numbers),
            HandedValues::Texts(texts) => texts.iter().for_each(|text| sum.add(text.as_bytes())),
        }
    }
    sum.source(Path::new(&log.name))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn log(rows: usize, bad: f64) -> HandedLog {
        let numbers = |name: &str, of: &dyn Fn(usize) -> f64| HandedColumn {
            name: name.to_owned(),
            values: HandedValues::Numbers((0..rows).map(of).collect()),
        };
        let trials = (0..rows).map(|row| if row < 40 { "a" } else { "b" }.to_owned()).collect();
        HandedLog {
            name: "bench".to_owned(),
            columns: vec![
                numbers("time_s", &|k| 0.01 * k as f64),
                numbers("boom.input [V]", &|k| f64::from(u8::from(k % 20 > 9))),
                numbers("boom.output [deg]", &|k| if k == 55 { bad } else { k as f64 }),
                HandedColumn { name: "trial".to_owned(), values: HandedValues::Texts(trials) },
            ],
        }
    }

    #[test]
    fn columns_in_memory_are_read_as_those_of_a_file() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("bench.csv");
        let mut text = "time_s,boom.input [V],boom.output [deg],trial\n".to_owned();
        for k in 0..80 {
            use std::fmt::Write as _;
            let (input, trial) = (u8::from(k % 20 > 9), if k < 40 { "a" } else { "b" });
            writeln!(text, "{:?},{input},{k},{trial}", 0.01 * f64::from(k)).unwrap();
        }
        std::fs::write(&path, text).unwrap();
        let options = ReadOptions::default();
        let expected = Experiment::read(&[path], &options);
        let found = Experiment::of_logs(vec![log(80, 55.0)], &options);
        assert_eq!(found.joints, expected.joints);
        assert_eq!(found.joints[0].trials.len(), 2);
        let joints = Experiment::of_joints(found.joints, "arrays", &options);
        assert_eq!(joints.joints, expected.joints);
        assert_eq!(joints.sources[0].bytes, 2 * 8 * 80);
    }

    #[test]
    fn a_bad_value_is_named_by_its_row_and_column() {
        let options = ReadOptions::default();
        for bad in [1e80, f64::INFINITY] {
            let found = Experiment::of_logs(vec![log(80, bad)], &options);
            let error = &found.failures[0].error;
            assert_eq!(error.row(), Some(56), "{error}");
            assert_eq!(error.column(), Some("boom.output"));
        }
        let mut uneven = log(80, 0.0);
        uneven.columns[1].values = HandedValues::Numbers(vec![0.0]);
        let found = Experiment::of_logs(vec![uneven], &options);
        assert_eq!(found.failures[0].error.column(), Some("boom.input [V]"));
    }

    #[test]
    fn a_joint_that_is_not_there_is_a_failure_of_its_own() {
        let options = ReadOptions { joints: vec!["bom".to_owned()], ..ReadOptions::default() };
        let joints = Experiment::of_logs(vec![log(80, 0.0)], &ReadOptions::default()).joints;
        let found = Experiment::of_joints(joints, "arrays", &options);
        assert!(found.joints.is_empty());
        assert!(found.failures[0].error.to_string().contains("boom"));
    }
}
