//! What the numbers of a model were fitted to, and how well they are known.

use std::collections::BTreeMap;

use serde::Deserialize;
use toml_edit::{Array, InlineTable, Item, Table};

use super::edit::{number, set_text};
use super::revision::RevisionErrors;

/// What `add` and `improve` leave beside a model: table `fitted` of a joint. It says where the
/// numbers come from, and a report shows it without fitting again. Nothing is computed from it.
#[derive(Clone, Debug, Default, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Fitted {
    /// The logs that the model was fitted to.
    pub logs: Vec<LogHash>,
    /// Unit of the input, where the logs state it.
    pub input_unit: Option<String>,
    /// Unit of the output, likewise.
    pub output_unit: Option<String>,
    /// Standard deviation of the noise of the sensor, in output units.
    pub sensor_noise: Option<f64>,
    /// The verdict on the model, an id as in JSON.
    pub verdict: Option<String>,
    /// The errors of the model before its first revision.
    pub start: Option<RevisionErrors>,
    /// The parameters by name, that of an effect after its id: `dead_band.upper`.
    #[serde(default)]
    pub parameters: BTreeMap<String, FittedParameter>,
}

/// A log, by the name of its file and by its bytes.
#[derive(Clone, Debug, Default, PartialEq, Eq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct LogHash {
    /// Name of the file, without its folder.
    pub file: String,
    /// SHA-256 of its bytes, as lower-case hexadecimal.
    pub sha256: String,
}

/// What is known of a parameter besides its value.
#[derive(Clone, Debug, Default, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FittedParameter {
    /// Its standard error; none where it was fixed, or is not determined by the logs.
    pub std_error: Option<f64>,
    /// Its unit.
    pub unit: String,
}

impl Fitted {
    /// The table as it is written.
    pub(super) fn table(&self) -> Table {
        let mut table = Table::new();
        let logs = self.logs.iter().map(|log| {
            let fields = [("file", log.file.as_str()), ("sha256", log.sha256.as_str())];
            fields.into_iter().collect::<InlineTable>()
        });
        table.insert("logs", toml_edit::value(logs.collect::<Array>()));
        for (key, unit) in [("input_unit", &self.input_unit), ("output_unit", &self.output_unit)] {
            if let Some(unit) = unit {
                set_text(&mut table, key, unit);
            }
        }
        insert_number(&mut table, "sensor_noise", self.sensor_noise);
        if let Some(verdict) = &self.verdict {
            set_text(&mut table, "verdict", verdict);
        }
        if let Some(start) = &self.start {
            let mut errors = Table::new();
            insert_errors(&mut errors, start);
            table.insert("start", toml_edit::value(errors.into_inline_table()));
        }
        let mut parameters = Table::new();
        for (name, parameter) in &self.parameters {
            let mut known = Table::new();
            insert_number(&mut known, "std_error", parameter.std_error);
            set_text(&mut known, "unit", &parameter.unit);
            parameters.insert(name, toml_edit::value(known.into_inline_table()));
        }
        table.insert("parameters", Item::Table(parameters));
        table
    }
}

/// Writes the errors of a revision.
pub(super) fn insert_errors(table: &mut Table, errors: &RevisionErrors) {
    let RevisionErrors {
        train_rmse,
        validation_rmse,
        rmse_raw,
        rmse_free,
        fit_percent,
        lack_of_fit,
    } = errors;
    let numbers = [
        ("validation_rmse", validation_rmse),
        ("train_rmse", train_rmse),
        ("rmse_raw", rmse_raw),
        ("rmse_free", rmse_free),
        ("fit_percent", fit_percent),
    ];
    for (key, value) in numbers {
        insert_number(table, key, *value);
    }
    if let Some(text) = lack_of_fit {
        set_text(table, "lack_of_fit", text);
    }
}

/// Puts a number under `key` where there is one that a file can hold.
fn insert_number(table: &mut Table, key: &str, value: Option<f64>) {
    if let Some(value) = value.filter(|value| value.is_finite()) {
        table.insert(key, Item::Value(number(value)));
    }
}
