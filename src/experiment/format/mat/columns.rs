//! The columns of a file: which variable holds each, and their values.

use std::path::Path;

use super::variable::{Content, Numbers, Variable, as_arrays};
use super::{v5, v73};
use crate::experiment::error::ReadError;
use crate::experiment::format::first_bytes::{is_matlab_73, start_of};
use crate::experiment::memory::Budget;
use crate::experiment::table::{Column, Head, Labels, OpenTable, Rows, Table, Wanted};

/// What a header stands for.
#[derive(Clone, Copy)]
struct Place {
    variable: usize,
    column: usize,
    rows: usize,
}

/// The variables with the place of each header.
struct Unread {
    variables: Vec<Variable>,
    places: Vec<Place>,
    budget: Budget,
}

/// Opens the log and lists its variables.
pub(in crate::experiment::format) fn open(
    path: &Path,
    budget: Budget,
) -> Result<OpenTable, ReadError> {
    let start = start_of(path)?;
    let variables = if is_matlab_73(&start) { v73::variables } else { v5::variables };
    let variables = variables(path, &budget)?;
    let mut headers = Vec::new();
    let mut places = Vec::new();
    for (index, variable) in variables.iter().enumerate() {
        let (rows, columns) = variable.shape();
        for column in 0..columns {
            headers.push(variable.header(column, columns));
            places.push(Place { variable: index, column, rows });
        }
    }
    if places.iter().all(|place| place.rows == 0) {
        check_objects(path, &variables)?;
    }
    let rows = Box::new(Unread { variables, places, budget });
    let head = Head { path: path.to_owned(), headers, header_row: 0, unread: Vec::new() };
    Ok(OpenTable { head, rows })
}

/// Refuses a file in which nothing has rows, and some are objects.
fn check_objects(path: &Path, variables: &[Variable]) -> Result<(), ReadError> {
    let class = |variable: &Variable| match &variable.content {
        Content::Object(class) => Some((variable.name.clone(), class.clone())),
        _ => None,
    };
    let Some((name, class)) = variables.iter().find_map(class) else { return Ok(()) };
    Err(ReadError::Format {
        path: path.to_owned(),
        format: "MATLAB",
        reason: format!(
            "`{name}` is an object of the class `{class}`, which MATLAB alone can read"
        ),
        remedy: as_arrays(&class),
    })
}

impl Rows for Unread {
    fn read(self: Box<Self>, wanted: &Wanted<'_>) -> Result<Table, ReadError> {
        let rows = self.rows(wanted)?;
        let column = |index: &usize| self.column(*index, wanted.path());
        let columns = wanted.numeric.iter().map(column).collect::<Result<_, _>>()?;
        let mut labels = Labels::default();
        let texts =
            wanted.label.map_or_else(|| Ok(Vec::new()), |l| self.labels(l, wanted.path()))?;
        for (text, row) in texts.iter().zip(1..) {
            labels.push(text, row, (wanted.path(), &self.budget))?;
        }
        Table::counted(wanted.path(), rows, columns, &labels)
    }

    fn rows_of(&self, column: usize) -> Option<usize> {
        self.place(column).map(|(_, place)| place.rows).filter(|rows| *rows > 0)
    }
}

impl Unread {
    /// The rows of the columns that are wanted, which must be as many in each.
    fn rows(&self, wanted: &Wanted<'_>) -> Result<usize, ReadError> {
        let name = |index: usize| wanted.head.headers.get(index).map_or("", |header| &header.name);
        let mut first: Option<(usize, usize)> = None;
        for index in wanted.numeric.iter().chain(&wanted.label).copied() {
            let Some((variable, place)) = self.place(index) else { continue };
            // What is no column spoils its own joint.
            if matches!(variable.content, Content::Object(_) | Content::Other(_)) || place.rows == 0
            {
                continue;
            }
            let (other, expected) = *first.get_or_insert((index, place.rows));
            if place.rows != expected {
                return Err(ReadError::UnequalColumns {
                    path: wanted.path().to_owned(),
                    column: name(index).to_owned(),
                    found: place.rows,
                    other: name(other).to_owned(),
                    expected,
                });
            }
        }
        Ok(first.map_or(0, |(_, rows)| rows))
    }

    fn place(&self, header: usize) -> Option<(&Variable, Place)> {
        let place = *self.places.get(header)?;
        Some((self.variables.get(place.variable)?, place))
    }

    /// The numbers of a column, or what is there instead.
    fn column(&self, header: usize, path: &Path) -> Result<Column, ReadError> {
        let Some((variable, place)) = self.place(header) else { return Ok(Column::default()) };
        let cut = |values: &[f64]| {
            let start = place.column * place.rows;
            Column::of(values.get(start..start + place.rows).unwrap_or_default().iter().copied())
        };
        Ok(match &variable.content {
            Content::Numbers(_) if place.rows == 0 => Column::not_numbers(
                "an array that has no row per sample (turn a matrix of rows on its side)",
            ),
            Content::Numbers(Numbers::Read(values)) => cut(values),
            Content::Numbers(Numbers::Stored(dataset)) => {
                Column::of(v73::column(dataset, place.column, path, &self.budget)?)
            }
            Content::Texts(_) => Column::not_numbers("text"),
            Content::Object(class) => Column::not_numbers(&format!(
                "an object of the class `{class}` of MATLAB ({})",
                as_arrays(class)
            )),
            Content::Other(kind) => Column::not_numbers(kind),
        })
    }

    /// The label of each row.
    fn labels(&self, header: usize, path: &Path) -> Result<Vec<String>, ReadError> {
        let refused = |found: &str| {
            let column =
                self.place(header).map_or_else(String::new, |(found, _)| found.name.clone());
            Err(ReadError::NoLabels { path: path.to_owned(), column, found: found.to_owned() })
        };
        match self.place(header) {
            Some((Variable { content: Content::Texts(texts), .. }, _)) => return Ok(texts.clone()),
            Some((Variable { content: Content::Object(class), .. }, _)) => {
                return refused(&format!("an object of the class `{class}`"));
            }
            Some((Variable { content: Content::Other(kind), .. }, _)) => return refused(kind),
            Some((_, Place { rows: 0, .. })) => {
                return refused("an array that has no row per sample");
            }
            _ => {}
        }
        let values = self.column(header, path)?.values;
        Ok(values.iter().map(ToString::to_string).collect())
    }
}
