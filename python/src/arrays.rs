//! Numbers from Python: each array is copied once, before the interpreter is let go.

use numpy::PyReadonlyArray1;
use pyo3::prelude::*;
use tauscope::experiment::{
    Experiment, HandedColumn, HandedLog, HandedValues, Joint, ReadOptions, Record, Trial,
    TrialError,
};
use tauscope::units::SamplePeriod;

use crate::TauscopeError;
use crate::frame::Frame;

/// A column of a table: numbers, or texts.
#[derive(FromPyObject)]
pub(crate) enum Values<'py> {
    /// An array of float64.
    Numbers(PyReadonlyArray1<'py, f64>),
    /// A list of str.
    Texts(Vec<String>),
}

/// The columns of a table.
#[derive(FromPyObject)]
pub(crate) enum Columns<'py> {
    /// As they lie in the memory of others.
    Frame(PyRef<'py, Frame>),
    /// Their names and values.
    Plain(Vec<(String, Values<'py>)>),
}

/// A table: its name and its columns.
pub(crate) type Table<'py> = (String, Columns<'py>);

/// A trial: its name, input and output.
pub(crate) type ArrayTrial<'py> = (String, PyReadonlyArray1<'py, f64>, PyReadonlyArray1<'py, f64>);

/// A joint: its name, the units of input and output, and its trials.
pub(crate) type ArrayJoint<'py> = (String, Option<String>, Option<String>, Vec<ArrayTrial<'py>>);

/// Logs in memory.
pub(crate) enum Logs {
    Tables(Vec<HandedLog>),
    Joints(Vec<Joint>),
}

/// What messages call arrays.
const ARRAYS: &str = "arrays";

impl Logs {
    pub(crate) fn of_tables(tables: Vec<Table<'_>>) -> Self {
        let column = |(name, values): (String, Values<'_>)| {
            let values = match values {
                Values::Numbers(numbers) => HandedValues::Numbers(copied(&numbers)),
                Values::Texts(texts) => HandedValues::Texts(texts),
            };
            HandedColumn { name, values }
        };
        let table = |(name, columns): Table<'_>| {
            let columns = match columns {
                Columns::Frame(frame) => frame.columns(),
                Columns::Plain(columns) => columns.into_iter().map(column).collect(),
            };
            HandedLog { name, columns }
        };
        Self::Tables(tables.into_iter().map(table).collect())
    }

    pub(crate) fn of_joints(joints: Vec<ArrayJoint<'_>>, period_s: f64) -> PyResult<Self> {
        let period = SamplePeriod::from_seconds(period_s).ok_or_else(|| {
            TauscopeError::new_err(format!("sample_period is {period_s}: expected seconds above 0"))
        })?;
        let joints = joints.into_iter().map(|joint| joint_of(joint, period));
        Ok(Self::Joints(joints.collect::<PyResult<_>>()?))
    }

    pub(crate) fn experiment(self, options: &ReadOptions) -> Experiment {
        match self {
            Self::Tables(tables) => Experiment::of_logs(tables, options),
            Self::Joints(joints) => Experiment::of_joints(joints, ARRAYS, options),
        }
    }
}

fn copied(array: &PyReadonlyArray1<'_, f64>) -> Vec<f64> {
    array.as_slice().map_or_else(|_| array.as_array().to_vec(), <[f64]>::to_vec)
}

fn joint_of(
    (name, input_unit, output_unit, trials): ArrayJoint<'_>,
    period: SamplePeriod,
) -> PyResult<Joint> {
    let trial = |(label, input, output): ArrayTrial<'_>| {
        let trial = Trial::new(label, 0.0, period, copied(&input), copied(&output));
        trial.map_err(|error| refused(&name, &error))
    };
    let trials = trials.into_iter().map(trial).collect::<PyResult<Record>>()?;
    Ok(Joint { input_unit, output_unit, ..Joint::new(name, trials) })
}

fn refused(joint: &str, error: &TrialError) -> PyErr {
    let refused = TauscopeError::new_err(format!("joint `{joint}`: {error}"));
    let row = match error {
        TrialError::NotFinite { sample, .. } => Some(*sample),
        _ => None,
    };
    Python::attach(|py| crate::host::placed(py, refused, row.map(|row| row as u64), None))
}
