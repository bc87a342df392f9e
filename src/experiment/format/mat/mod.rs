//! MATLAB: the variables of a `.mat` file as columns.
//!
//! | variable | columns |
//! |---|---|
//! | vector `u` | `u` |
//! | matrix `y` with a row per sample | `y(1)`, `y(2)`, … |
//! | field of a structure | `boom.input`; of an array of them `out.signals(2).values` |
//!
//! What is no column of numbers or of text keeps its name, so that messages can say what it
//! is. Numbers alone (1 × 1) are parameters, and no columns.

mod v5;
mod v73;
mod variable;

use std::path::Path;

use self::variable::{Content, Variable};
use super::first_bytes::{is_matlab_73, start_of};
use crate::experiment::error::ReadError;
use crate::experiment::memory::{Budget, NUMBER_SIZE};
use crate::experiment::table::{Head, Opened, Table, Values, Wanted};

/// The variables with the place of each header: its variable, and the column of that.
struct Unread {
    variables: Vec<Variable>,
    places: Vec<(usize, usize)>,
    /// Bytes of the file.
    size: u64,
}

/// Opens the log and lists its variables.
pub(super) fn open(path: &Path, budget: &Budget) -> Result<Opened, ReadError> {
    let start = start_of(path)?;
    let variables = if is_matlab_73(&start) { v73::variables } else { v5::variables };
    let variables = variables(path, budget)?;
    let (mut headers, mut places) = (Vec::new(), Vec::new());
    for (index, variable) in variables.iter().enumerate() {
        let (_, columns) = variable.shape();
        for column in 0..columns {
            headers.push(variable.header(column, columns));
            places.push((index, column));
        }
    }
    if variables.iter().all(|variable| variable.shape().0 == 0) {
        check_kinds(&variables)?;
    }
    let unread = Unread { variables, places, size: path.metadata()?.len() };
    Ok((Head::without_lines(headers), Box::new(move |wanted| unread.read(wanted))))
}

/// Refuses a file in which nothing has rows, and says of the first variable what it is.
fn check_kinds(variables: &[Variable]) -> Result<(), ReadError> {
    for variable in variables {
        if let Content::Other(kind) = &variable.content {
            let reason = format!("it has no column of numbers: `{}` is {kind}", variable.name);
            let remedy = "save each signal as a vector, with `save -v7`";
            return Err(ReadError::format("MATLAB", reason, remedy));
        }
    }
    Ok(())
}

impl Unread {
    fn read(&self, wanted: &Wanted<'_>) -> Result<Table, ReadError> {
        Table::of_values(wanted, |header| {
            let Some(&(variable, column)) = self.places.get(header) else {
                return Ok(Values::default());
            };
            let variable = &self.variables[variable];
            wanted.budget.take_values(variable.shape().0, NUMBER_SIZE)?;
            self.values(variable, column)
        })
    }

    /// The numbers or the texts of a column, or what is there instead.
    fn values(&self, variable: &Variable, column: usize) -> Result<Values, ReadError> {
        if let Some(kind) = variable.is_no_column() {
            return Ok(Values::Other(kind.to_owned()));
        }
        Ok(match &variable.content {
            Content::Numbers(values) => {
                let (rows, _) = variable.shape();
                let values = values.iter().skip(column * rows).take(rows);
                Values::Numbers(values.copied().collect())
            }
            Content::Stored(dataset) => Values::Numbers(v73::column(dataset, column, self.size)?),
            Content::Texts(texts) => Values::Texts(texts.clone()),
            Content::Other(kind) => Values::Other(kind.clone()),
        })
    }
}
