//! Tables with typed columns, as CSV and as Parquet.

use std::io::Write;

use serde::Serialize;
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
}

/// A table whose columns have a name and a type; numbers may be missing.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct DataTable {
    columns: Vec<Column>,
}

#[derive(Clone, Debug, PartialEq)]
struct Column {
    name: String,
    kind: Kind,
    values: Values,
}

#[derive(Clone, Debug, PartialEq)]
enum Values {
    Text(Vec<String>),
    Whole(Vec<Option<i64>>),
    Real(Vec<Option<f64>>),
}

/// A cell of a row.
pub(super) enum Cell<'a> {
    Text(&'a str),
    Whole(usize),
    Real(Option<f64>),
}

impl Column {
    fn new(name: &str, kind: Kind) -> Self {
        let values = match kind {
            Kind::Text => Values::Text(Vec::new()),
            Kind::Whole => Values::Whole(Vec::new()),
            Kind::Samples | Kind::Real => Values::Real(Vec::new()),
        };
        Self { name: name.to_owned(), kind, values }
    }

    fn push(&mut self, value: Option<&Value>) {
        match &mut self.values {
            Values::Text(texts) => {
                texts.push(value.and_then(Value::as_str).unwrap_or_default().to_owned());
            }
            Values::Whole(numbers) => numbers.push(value.and_then(Value::as_i64)),
            Values::Real(numbers) => numbers.push(value.and_then(Value::as_f64)),
        }
    }

    /// The cell as text of CSV.
    fn write_cell(&self, row: usize, out: &mut csv::Writer<impl Write>) -> csv::Result<()> {
        match &self.values {
            Values::Text(texts) => out.write_field(texts.get(row).map_or("", String::as_str)),
            Values::Whole(numbers) => out.write_field(
                numbers.get(row).copied().flatten().map_or_else(String::new, |n| n.to_string()),
            ),
            Values::Real(numbers) => {
                let number = numbers.get(row).copied().flatten();
                out.write_field(number.map_or_else(String::new, |number| self.number(number)))
            }
        }
    }

    /// The shortest text that is read as this number.
    fn number(&self, number: f64) -> String {
        let is_whole = self.kind == Kind::Samples && number.fract() == 0.0;
        if is_whole { number.to_string() } else { Value::from(number).to_string() }
    }
}

impl DataTable {
    /// A table without rows.
    pub(crate) fn new<'a>(columns: impl IntoIterator<Item = (&'a str, Kind)>) -> Self {
        let columns = columns.into_iter().map(|(name, kind)| Column::new(name, kind));
        Self { columns: columns.collect() }
    }

    /// Adds a row: the value of each column by its name, missing where there is none.
    pub(crate) fn push(&mut self, row: &Map<String, Value>) {
        for column in &mut self.columns {
            let value = row.get(&column.name);
            column.push(value);
        }
    }

    /// Adds a row, cell by cell.
    pub(super) fn push_cells<'a>(&mut self, cells: impl IntoIterator<Item = Cell<'a>>) {
        for (column, cell) in self.columns.iter_mut().zip(cells) {
            match (&mut column.values, cell) {
                (Values::Text(texts), Cell::Text(text)) => texts.push(text.to_owned()),
                (Values::Whole(numbers), Cell::Whole(number)) => {
                    numbers.push(i64::try_from(number).ok());
                }
                (Values::Real(numbers), Cell::Real(number)) => numbers.push(number),
                (_, _) => column.push(None),
            }
        }
    }

    /// Adds what has the columns for its fields.
    ///
    /// # Errors
    /// When it has no fields.
    pub(crate) fn push_fields(&mut self, row: impl Serialize) -> serde_json::Result<()> {
        if let Value::Object(row) = serde_json::to_value(row)? {
            self.push(&row);
        }
        Ok(())
    }

    /// Number of rows.
    pub(crate) fn rows(&self) -> usize {
        self.columns.first().map_or(0, |column| match &column.values {
            Values::Text(texts) => texts.len(),
            Values::Whole(numbers) => numbers.len(),
            Values::Real(numbers) => numbers.len(),
        })
    }

    /// Writes the table as CSV, missing numbers as empty cells.
    ///
    /// # Errors
    /// When `out` cannot be written.
    pub(crate) fn write_csv(&self, out: impl Write) -> csv::Result<()> {
        let mut writer = csv::Writer::from_writer(out);
        writer.write_record(self.columns.iter().map(|column| &column.name))?;
        for row in 0..self.rows() {
            for column in &self.columns {
                column.write_cell(row, &mut writer)?;
            }
            writer.write_record(None::<&[u8]>)?;
        }
        Ok(writer.flush()?)
    }
}

#[cfg(feature = "parquet")]
mod parquet_file {
    use std::io::{Error, Result, Write};
    use std::sync::Arc;

    use parquet::basic::{Compression, LogicalType, Repetition, Type as Physical};
    use parquet::data_type::{ByteArray, ByteArrayType, DataType, DoubleType, Int64Type};
    use parquet::errors::ParquetError;
    use parquet::file::properties::WriterProperties;
    use parquet::file::writer::{SerializedColumnWriter, SerializedFileWriter};
    use parquet::schema::types::Type;

    use super::{Column, DataTable, Values};

    impl DataTable {
        /// Writes the table as Parquet, compressed with zstd, missing numbers as nulls.
        ///
        /// # Errors
        /// When `out` cannot be written.
        pub(crate) fn write_parquet(&self, out: impl Write + Send) -> Result<()> {
            self.write(out).map_err(Error::other)
        }

        fn write(&self, out: impl Write + Send) -> std::result::Result<(), ParquetError> {
            let fields = self.columns.iter().map(|column| column.field().map(Arc::new));
            let fields = fields.collect::<std::result::Result<_, _>>()?;
            let schema = Type::group_type_builder("table").with_fields(fields).build()?;
            let properties = WriterProperties::builder()
                .set_created_by(concat!("tauscope ", env!("CARGO_PKG_VERSION")).to_owned())
                .set_compression(Compression::ZSTD(parquet::basic::ZstdLevel::default()));
            let properties = Arc::new(properties.build());
            let mut file = SerializedFileWriter::new(out, Arc::new(schema), properties)?;
            let mut rows = file.next_row_group()?;
            for column in &self.columns {
                if let Some(writer) = rows.next_column()? {
                    column.write(writer)?;
                }
            }
            rows.close()?;
            file.close().map(drop)
        }
    }

    impl Column {
        fn field(&self) -> std::result::Result<Type, ParquetError> {
            let (physical, logical, repetition) = match &self.values {
                Values::Text(_) => {
                    (Physical::BYTE_ARRAY, Some(LogicalType::String), Repetition::REQUIRED)
                }
                Values::Whole(_) => (Physical::INT64, None, Repetition::OPTIONAL),
                Values::Real(_) => (Physical::DOUBLE, None, Repetition::OPTIONAL),
            };
            Type::primitive_type_builder(&self.name, physical)
                .with_logical_type(logical)
                .with_repetition(repetition)
                .build()
        }

        fn write(
            &self,
            mut writer: SerializedColumnWriter<'_>,
        ) -> std::result::Result<(), ParquetError> {
            match &self.values {
                Values::Text(texts) => {
                    let texts: Vec<ByteArray> =
                        texts.iter().map(|text| text.as_str().into()).collect();
                    writer.typed::<ByteArrayType>().write_batch(&texts, None, None)?;
                }
                Values::Whole(numbers) => optional::<Int64Type>(&mut writer, numbers)?,
                Values::Real(numbers) => optional::<DoubleType>(&mut writer, numbers)?,
            }
            writer.close()
        }
    }

    /// Writes the numbers that are there, and where they are.
    fn optional<T: DataType<T: Copy>>(
        writer: &mut SerializedColumnWriter<'_>,
        numbers: &[Option<T::T>],
    ) -> std::result::Result<(), ParquetError> {
        let present: Vec<T::T> = numbers.iter().copied().flatten().collect();
        let levels: Vec<i16> = numbers.iter().map(|number| i16::from(number.is_some())).collect();
        writer.typed::<T>().write_batch(&present, Some(&levels), None).map(drop)
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
        table.push_fields(serde_json::json!({"a": 12.0, "b": 12.0, "c": 3, "d": "x,y"})).unwrap();
        table.push_fields(serde_json::json!({"a": 12.25, "b": 1e-7, "c": null})).unwrap();
        let mut bytes = Vec::new();
        table.write_csv(&mut bytes).unwrap();
        let text = String::from_utf8(bytes).unwrap();
        assert_eq!(text, "a,b,c,d\n12,12.0,3,\"x,y\"\n12.25,1e-7,,\n");
        assert_eq!(table.rows(), 2);
    }
}
