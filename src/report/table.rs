//! Tables with typed columns, as CSV and as Parquet, and tables of texts, for the terminal and for pages.

use std::fmt;
use std::io::Write;

use comfy_table::{CellAlignment, presets};
use serde_json::{Map, Value};

/// What a column holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Kind {
    /// Text.
    Text,
    /// Whole numbers.
    Whole,
    /// Numbers of samples: mostly whole, and then written without a point.
    Samples,
    /// Any numbers.
    Real,
    /// Any numbers, written without an exponent.
    Plain,
}

/// A table whose columns have a name and a type; numbers may be missing.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct DataTable {
    columns: Vec<(String, Kind)>,
    /// A cell for each column.
    rows: Vec<Vec<Value>>,
}

impl Kind {
    /// The cell as text of CSV: a number as the shortest text that is read as it.
    fn text(self, cell: &Value) -> String {
        match self {
            Self::Text => cell.as_str().unwrap_or_default().to_owned(),
            Self::Whole => cell.as_i64().map_or_else(String::new, |number| number.to_string()),
            Self::Samples | Self::Real | Self::Plain => match cell.as_f64() {
                None => String::new(),
                Some(number) if self == Self::Plain => number.to_string(),
                Some(number) if self == Self::Samples && number.fract() == 0.0 => {
                    number.to_string()
                }
                Some(number) => Value::from(number).to_string(),
            },
        }
    }
}

impl DataTable {
    /// A table without rows.
    pub(crate) fn new<'a>(columns: impl IntoIterator<Item = (&'a str, Kind)>) -> Self {
        let columns = columns.into_iter().map(|(name, kind)| (name.to_owned(), kind));
        Self { columns: columns.collect(), rows: Vec::new() }
    }

    /// Adds a row: the value of each column by its name, missing where there is none.
    pub(crate) fn push(&mut self, row: &Map<String, Value>) {
        let cells = self.columns.iter().map(|(name, _)| row.get(name).cloned());
        self.rows.push(cells.map(Option::unwrap_or_default).collect());
    }

    /// Adds a row, cell by cell.
    pub(super) fn push_cells(&mut self, cells: impl IntoIterator<Item = Value>) {
        self.rows.push(cells.into_iter().collect());
    }

    /// Writes the table as CSV, missing numbers as empty cells.
    ///
    /// # Errors
    /// When `out` cannot be written.
    pub(crate) fn write_csv(&self, out: impl Write) -> csv::Result<()> {
        write_csv(&self.columns, self.rows.iter(), out)
    }
}

/// Writes rows as they come.
pub(super) fn write_csv(
    columns: &[(String, Kind)],
    rows: impl Iterator<Item: AsRef<[Value]>>,
    out: impl Write,
) -> csv::Result<()> {
    let mut writer = csv::Writer::from_writer(out);
    writer.write_record(columns.iter().map(|(name, _)| name))?;
    for row in rows {
        let cells = columns.iter().zip(row.as_ref());
        writer.write_record(cells.map(|((_, kind), cell)| kind.text(cell)))?;
    }
    Ok(writer.flush()?)
}

#[cfg(feature = "parquet")]
mod parquet_file {
    use std::io::{Error, Result, Write};
    use std::sync::Arc;

    use arrow_array::{ArrayRef, Float64Array, Int64Array, RecordBatch, StringArray};
    use parquet::arrow::ArrowWriter;
    use parquet::arrow::arrow_writer::ArrowWriterOptions;
    use parquet::basic::{Compression, ZstdLevel};
    use parquet::errors::ParquetError;
    use parquet::file::properties::WriterProperties;

    use serde_json::Value;

    use super::{DataTable, Kind};

    impl DataTable {
        /// Writes the table as Parquet, compressed with zstd, missing numbers as nulls.
        ///
        /// # Errors
        /// When `out` cannot be written.
        pub(crate) fn write_parquet(&self, out: impl Write + Send) -> Result<()> {
            self.write(out).map_err(Error::other)
        }

        fn write(&self, out: impl Write + Send) -> std::result::Result<(), ParquetError> {
            let columns = self.columns.iter().enumerate().map(|(place, (name, kind))| {
                let cells = self.rows.iter().filter_map(|row| row.get(place));
                (name, kind.array(cells), *kind != Kind::Text)
            });
            let batch = RecordBatch::try_from_iter_with_nullable(columns)?;
            let properties = WriterProperties::builder()
                .set_created_by(concat!("tauscope ", env!("CARGO_PKG_VERSION")).to_owned())
                .set_compression(Compression::ZSTD(ZstdLevel::default()));
            let options = ArrowWriterOptions::new()
                .with_properties(properties.build())
                .with_skip_arrow_metadata(true)
                .with_schema_root("table".to_owned());
            let mut file = ArrowWriter::try_new_with_options(out, batch.schema(), options)?;
            file.write(&batch)?;
            file.close().map(drop)
        }
    }

    impl Kind {
        /// Cells as a column: numbers where there are any.
        fn array<'a>(self, cells: impl Iterator<Item = &'a Value>) -> ArrayRef {
            match self {
                Self::Text => {
                    let texts = cells.map(|cell| cell.as_str().unwrap_or_default());
                    Arc::new(StringArray::from_iter_values(texts))
                }
                Self::Whole => Arc::new(cells.map(Value::as_i64).collect::<Int64Array>()),
                Self::Samples | Self::Real | Self::Plain => {
                    Arc::new(cells.map(Value::as_f64).collect::<Float64Array>())
                }
            }
        }
    }
}

/// Rows of texts below a header; columns of numbers are aligned to the right.
#[derive(Clone, Debug, Default)]
pub(crate) struct TextTable {
    pub(super) header: Vec<String>,
    pub(super) rows: Vec<Vec<String>>,
    /// Columns of numbers.
    pub(super) numbers: Vec<usize>,
}

impl TextTable {
    pub(super) fn new<const N: usize>(header: [&str; N], numbers: &[usize]) -> Self {
        let header = header.map(str::to_owned).to_vec();
        Self { header, rows: Vec::new(), numbers: numbers.to_vec() }
    }

    pub(super) fn row<const N: usize>(&mut self, cells: [String; N]) {
        self.rows.push(cells.into());
    }

    /// A table with a row for each of `rows`.
    pub(crate) fn of<const N: usize>(
        header: [&str; N],
        numbers: &[usize],
        rows: impl IntoIterator<Item = [String; N]>,
    ) -> Self {
        let rows = rows.into_iter().map(Vec::from).collect();
        Self { rows, ..Self::new(header, numbers) }
    }

    /// Its rows as columns; the first of them is the header.
    pub(super) fn turned(self) -> Self {
        let cell = |row: &Vec<String>, column: usize| row.get(column).cloned().unwrap_or_default();
        let turned = |column: usize| {
            std::iter::once(&self.header).chain(&self.rows).map(|row| cell(row, column)).collect()
        };
        let mut rows = (0..self.header.len()).map(turned);
        Self { header: rows.next().unwrap_or_default(), rows: rows.collect(), numbers: Vec::new() }
    }

    /// Whether a column holds numbers.
    pub(super) fn is_number(&self, column: usize) -> bool {
        self.numbers.contains(&column)
    }
}

impl TextTable {
    /// As Markdown, whose cells are `escaped`.
    pub(crate) fn markdown(&self, escaped: impl Fn(&str) -> String) -> String {
        let row = |cells: &Vec<String>| {
            let cells = cells.iter().map(|cell| escaped(cell));
            format!("| {} |\n", cells.collect::<Vec<_>>().join(" | "))
        };
        let rules = (0..self.header.len()).map(|c| if self.is_number(c) { "--:" } else { "---" });
        let rules = format!("|{}|\n", rules.collect::<Vec<_>>().join("|"));
        row(&self.header) + &rules + &self.rows.iter().map(row).collect::<String>()
    }
}

impl fmt::Display for TextTable {
    /// With borders, as wide as its cells.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut table = comfy_table::Table::new();
        table.load_style(presets::UTF8_BORDERS_ONLY).set_header(&self.header).add_rows(&self.rows);
        for (number, column) in table.column_iter_mut().enumerate() {
            if self.is_number(number) {
                column.set_cell_alignment(CellAlignment::Right);
            }
        }
        table.fmt(f)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_of_samples_are_written_without_a_point() {
        let kinds =
            [("a", Kind::Samples), ("b", Kind::Real), ("c", Kind::Whole), ("d", Kind::Text)];
        let mut table = DataTable::new(kinds);
        for row in [
            serde_json::json!({"a": 12.0, "b": 12.0, "c": 3, "d": "x,y"}),
            serde_json::json!({"a": 12.25, "b": 1e-7, "c": null}),
        ] {
            table.push(row.as_object().unwrap());
        }
        let mut bytes = Vec::new();
        table.write_csv(&mut bytes).unwrap();
        let text = String::from_utf8(bytes).unwrap();
        assert_eq!(text, "a,b,c,d\n12,12.0,3,\"x,y\"\n12.25,1e-7,,\n");
    }
}

#[cfg(test)]
mod text_table_tests {
    use super::*;

    #[test]
    fn numbers_are_aligned_to_the_right() {
        let mut table = TextTable::new(["joint", "steps"], &[1]);
        table.row(["boom".to_owned(), "7".to_owned()]);
        let lines: Vec<String> = table.to_string().lines().map(str::to_owned).collect();
        assert_eq!(lines[1..4], ["│ joint   steps │", "╞═══════════════╡", "│ boom        7 │"]);
    }

    #[test]
    fn rows_are_turned_into_columns() {
        let table = TextTable::of(
            ["model", "raw"],
            &[1],
            [["a", "1"], ["b", "2"]].map(|row| row.map(str::to_owned)),
        );
        let turned = table.turned();
        assert_eq!(turned.header, ["model", "a", "b"]);
        assert_eq!(turned.rows, [["raw", "1", "2"]]);
    }
}
