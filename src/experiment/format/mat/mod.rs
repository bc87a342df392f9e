//! MATLAB: the variables of a `.mat` file as columns.
//!
//! | variable | columns |
//! |---|---|
//! | vector `u` | `u` |
//! | matrix `y` with a row per sample | `y(1)`, `y(2)`, … |
//! | field of a structure | `boom.input`; of an array of them `out.signals(2).values` |
//!
//! What is no column of numbers or of text keeps its name, so that messages can tell what it
//! is. Numbers alone (1 × 1) are parameters, and no columns.

mod v5;
mod v73;

use std::path::Path;

use super::super::ReadError;
use super::super::table::{Column, Head, Header, Labels, OpenTable, Rows, Table, Wanted};

/// A variable, or a field of one.
struct Variable {
    name: String,
    /// Rows, columns, and so on.
    dims: Vec<usize>,
    content: Content,
}

enum Content {
    Numbers(Numbers),
    /// One text per row.
    Texts(Vec<String>),
    /// What is neither.
    Other(&'static str),
}

/// Numbers, column after column.
enum Numbers {
    Read(Vec<f64>),
    Stored(hdf5_pure::Dataset),
}

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
}

/// Opens the log and lists its variables.
pub(super) fn open(path: &Path) -> Result<OpenTable, ReadError> {
    let start = super::start_of(path)?;
    let variables =
        if super::is_matlab_73(&start) { v73::variables(path)? } else { v5::variables(path)? };
    let mut headers = Vec::new();
    let mut places = Vec::new();
    for (index, variable) in variables.iter().enumerate() {
        let (rows, columns) = variable.shape();
        for column in 0..columns {
            headers.push(variable.header(column, columns));
            places.push(Place { variable: index, column, rows });
        }
    }
    let rows = Box::new(Unread { variables, places });
    let head = Head { path: path.to_owned(), headers, header_row: 0 };
    Ok(OpenTable { head, rows })
}

fn damaged(path: &Path, reason: &impl ToString) -> ReadError {
    ReadError::Format {
        path: path.to_owned(),
        format: "MATLAB",
        reason: reason.to_string(),
        remedy: "save it again, with `save -v7` if it is of another version",
    }
}

impl Variable {
    /// Rows and columns; nothing where it is a number alone.
    fn shape(&self) -> (usize, usize) {
        /// A log has fewer columns; a matrix that lies on its side has more.
        const MOST_COLUMNS: usize = 1000;
        match (&self.content, self.dims.as_slice()) {
            (Content::Texts(texts), _) => (texts.len(), 1),
            (Content::Other(_), _) => (0, 1),
            (_, [1, 1] | []) => (0, 0),
            (_, [1, length] | [length, 1] | [length]) => (*length, 1),
            (_, [rows, columns]) if *columns <= MOST_COLUMNS => (*rows, *columns),
            _ => (0, 1),
        }
    }

    fn header(&self, column: usize, columns: usize) -> Header {
        let name = match columns {
            1 => self.name.clone(),
            _ => format!("{}({})", self.name, column + 1),
        };
        Header { text: name.clone(), name, unit: None, clock: 0 }
    }
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
            labels.push(text, row, wanted.path())?;
        }
        Table::counted(wanted.path(), rows, columns, &labels)
    }
}

impl Unread {
    /// The rows of the columns that are wanted, which must be as many in each.
    fn rows(&self, wanted: &Wanted<'_>) -> Result<usize, ReadError> {
        let name = |index: usize| wanted.head.headers.get(index).map_or("", |header| &header.name);
        let mut first: Option<(usize, usize)> = None;
        for index in wanted.numeric.iter().chain(&wanted.label).copied() {
            let Some((variable, place)) = self.place(index) else { continue };
            if matches!(variable.content, Content::Other(_)) {
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
                cut(&dataset.read_f64().map_err(|error| damaged(path, &error))?)
            }
            Content::Texts(_) => Column::not_numbers("text"),
            Content::Other(kind) => Column::not_numbers(kind),
        })
    }

    fn labels(&self, header: usize, path: &Path) -> Result<Vec<String>, ReadError> {
        if let Some((Variable { content: Content::Texts(texts), .. }, _)) = self.place(header) {
            return Ok(texts.clone());
        }
        let values = self.column(header, path)?.values;
        Ok(values.iter().map(ToString::to_string).collect())
    }
}
