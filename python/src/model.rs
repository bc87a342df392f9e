//! Models: read from their text, and simulated.

use std::path::Path;

use numpy::{PyArray1, PyReadonlyArray1};
use pyo3::prelude::*;
use tauscope::JointModel;
use tauscope::model::{ModelFile, Surroundings, simulate_input};

use crate::TauscopeError;
use crate::function::Function;

/// The effects that a text may name besides those of the catalogue.
type Functions<'py> = Vec<PyRef<'py, Function>>;

fn parsed(text: &str, name: &str, functions: &Functions<'_>) -> PyResult<ModelFile> {
    let effects: Vec<_> = functions.iter().map(|function| function.effect()).collect();
    ModelFile::parse_with(text, Path::new(name), &effects).map_err(|error| {
        let causes =
            std::iter::successors(Some(&error as &(dyn std::error::Error + 'static)), |error| {
                error.source()
            });
        let said: Vec<String> = causes.map(ToString::to_string).collect();
        TauscopeError::new_err(said.join(": "))
    })
}

fn joint<'a>(file: &'a ModelFile, joint: &str) -> PyResult<&'a JointModel> {
    let known = || file.names().collect::<Vec<_>>().join(", ");
    file.joint(joint).ok_or_else(|| {
        TauscopeError::new_err(format!("the model has no joint `{joint}`; it has {}", known()))
    })
}

/// The names of the joints of a model file with this text.
#[pyfunction]
pub(crate) fn check(text: &str, name: &str, functions: Functions<'_>) -> PyResult<Vec<String>> {
    Ok(parsed(text, name, &functions)?.names().map(str::to_owned).collect())
}

/// An effect: its id, stage, summary, and the values of its parameters.
type Described = (String, String, String, Vec<(String, f64)>);

/// Gain, delay and effects of a joint.
#[pyfunction]
pub(crate) fn describe(
    text: &str,
    of: &str,
    functions: Functions<'_>,
) -> PyResult<(f64, f64, Vec<Described>)> {
    let file = parsed(text, "model", &functions)?;
    let model = joint(&file, of)?;
    let effects = model.components().iter().map(|component| {
        let spec = component.effect().spec();
        let names = spec.parameters.iter().map(|parameter| parameter.name.to_owned());
        let values = component.parameters().iter().map(|value| value.value);
        let stage = spec.stage.id().to_owned();
        (spec.id.to_owned(), stage, spec.summary.to_owned(), names.zip(values).collect())
    });
    Ok((model.gain.value, model.delay.value, effects.collect()))
}

/// The output of a joint for an input that is sampled every `period_s` seconds.
#[pyfunction]
#[expect(clippy::too_many_arguments, reason = "they are named in Python")]
pub(crate) fn simulate<'py>(
    py: Python<'py>,
    text: &str,
    of: &str,
    input: PyReadonlyArray1<'py, f64>,
    period_s: f64,
    output: f64,
    start_s: f64,
    others: Option<PyReadonlyArray1<'py, f64>>,
    radians_per_output_unit: f64,
    trial: &str,
    functions: Functions<'py>,
) -> PyResult<Bound<'py, PyArray1<f64>>> {
    let file = parsed(text, "model", &functions)?;
    let model = joint(&file, of)?.in_trial(trial).into_owned();
    let input = input.as_array().to_vec();
    let others = others.map(|others| others.as_array().to_vec()).unwrap_or_default();
    let simulated = py.detach(|| {
        let surroundings = Surroundings {
            others: &others,
            radians_per_output_unit,
            start_s,
            ..Surroundings::default()
        };
        simulate_input(&model, &input, period_s, output, &surroundings).output
    });
    Function::check(&functions)?;
    Ok(PyArray1::from_vec(py, simulated))
}

/// The text of a model file with other values for parameters of a joint, by their names: `gain`,
/// `dead_band.lower`. What is written beside them stays.
#[pyfunction]
pub(crate) fn refitted(
    text: &str,
    of: &str,
    values: Vec<(String, f64)>,
    functions: Functions<'_>,
) -> PyResult<String> {
    let file = parsed(text, "model", &functions)?;
    let model = joint(&file, of)?;
    let names = model.names();
    if let Some((unknown, _)) = values.iter().find(|(name, _)| !names.contains(name)) {
        let known = names.join(", ");
        return Err(TauscopeError::new_err(format!(
            "the model has no parameter `{unknown}`; it has {known}"
        )));
    }
    let value = |(name, old): (&String, f64)| {
        values.iter().find(|(known, _)| known == name).map_or(old, |(_, value)| *value)
    };
    let old = model.values();
    let new: Vec<f64> =
        names.iter().zip(&old).map(|(name, old)| value((name, old.value))).collect();
    let revised = file.refitted(of, &model.with_values(&new));
    let revised = revised.map_err(|error| TauscopeError::new_err(error.to_string()))?;
    Ok(revised.text().to_owned())
}
