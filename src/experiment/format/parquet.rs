//! Parquet: columns of numbers, times or text, with a row number for messages.
//!
//! A column in a structure is called by its path, `boom.input`, as is a flat one of that name.
//! The types are those of Arrow, which writers note beside Parquet's own: durations, for which
//! Parquet has no type, and times of 96 bits are among them.

use std::fmt::Display;
use std::fs::File;
use std::path::Path;

use arrow_array::cast::AsArray as _;
use arrow_array::types::Float64Type;
use arrow_array::{Array as _, ArrayRef};
use arrow_cast::cast;
use arrow_schema::{ArrowError, DataType, TimeUnit};
use parquet::arrow::ProjectionMask;
use parquet::arrow::arrow_reader::{
    ArrowReaderMetadata, ArrowReaderOptions, ParquetRecordBatchReaderBuilder,
};
use parquet::basic::Compression;
use parquet::file::metadata::RowGroupMetaData;

use crate::experiment::error::ReadError;
use crate::experiment::memory::{Budget, NUMBER_SIZE};
use crate::experiment::table::{Column, Head, Header, Labels, Opened, Table, Wanted};

/// Rows that are read at once, at most.
const BATCH: u64 = 8192;

/// Copies of a batch at a time: its own, with what a list that grows has to spare, and those as labels.
const COPIES: u64 = 8;

/// What is done with some values of a column, and with which of them are missing.
type Take<'a> = dyn FnMut(&ArrayRef, &[bool]) -> Result<(), ReadError> + 'a;

/// A file whose footer was read.
struct Unread {
    file: File,
    metadata: ArrowReaderMetadata,
    /// The type of each column.
    types: Vec<DataType>,
}

/// Opens the log and reads its schema.
pub(super) fn open(path: &Path, _: &Budget) -> Result<Opened, ReadError> {
    let file = File::open(path)?;
    let size = file.metadata()?.len();
    // A schema of Arrow that doesn't fit the file, as of a tool that copies it along, is left aside.
    let load = |skip| {
        let options = ArrowReaderOptions::new().with_skip_arrow_metadata(skip);
        ArrowReaderMetadata::load(&file, options)
    };
    let metadata = load(false).or_else(|_| load(true)).map_err(damaged)?;
    if !metadata.metadata().row_groups().iter().all(|group| lies_within(group, size)) {
        return Err(damaged("a column lies outside of the file"));
    }
    let fields = metadata.schema().flattened_fields().into_iter();
    let types: Vec<DataType> = fields.map(|field| field.data_type().clone()).collect();
    let types: Vec<DataType> = types.into_iter().filter(|kind| !kind.is_nested()).collect();
    let columns = metadata.parquet_schema().columns();
    let headers = columns.iter().zip(&types);
    let headers = headers.map(|(column, kind)| header(&column.path().string(), kind)).collect();
    let unread = Unread { file, metadata, types };
    Ok((Head::without_lines(headers), Box::new(move |wanted| unread.read(wanted))))
}

/// Whether the columns of a group of rows lie in a file of `size` bytes, as they are said to.
fn lies_within(group: &RowGroupMetaData, size: u64) -> bool {
    group.columns().iter().all(|column| {
        let start = column.dictionary_page_offset().unwrap_or_else(|| column.data_page_offset());
        let ends = u64::try_from(start).ok().zip(u64::try_from(column.compressed_size()).ok());
        let end = ends.and_then(|(start, length)| start.checked_add(length));
        end.is_some_and(|end| end <= size) && group.num_rows() >= 0
    })
}

fn damaged(error: impl Display) -> ReadError {
    let remedy = "write it again: a file that is not complete cannot be read";
    ReadError::format("Parquet", error, remedy)
}

/// A time or a duration is in the unit of its type, whatever its name says.
fn header(name: &str, kind: &DataType) -> Header {
    let mut header = Header::parse(name);
    let (DataType::Timestamp(unit, _)
    | DataType::Time32(unit)
    | DataType::Time64(unit)
    | DataType::Duration(unit)) = kind
    else {
        return header;
    };
    let unit = match unit {
        TimeUnit::Second => "s",
        TimeUnit::Millisecond => "ms",
        TimeUnit::Microsecond => "us",
        TimeUnit::Nanosecond => "ns",
    };
    header.unit = Some(unit.to_owned());
    header
}

impl Unread {
    fn read(&self, wanted: &Wanted<'_>) -> Result<Table, ReadError> {
        wanted.budget.take_values(self.rows(), wanted.numeric.len() * NUMBER_SIZE)?;
        let mut columns = Vec::new();
        for index in wanted.numeric {
            columns.push(self.numbers(*index, wanted)?);
        }
        let (mut labels, mut row) = (Labels::default(), 0);
        if let Some(index) = wanted.label {
            self.each_batch(index, wanted, &mut |batch, missing| {
                for (text, missing) in texts(batch).map_err(damaged)?.iter().zip(missing) {
                    row += 1;
                    labels.push(if *missing { "" } else { text }, row, wanted.budget)?;
                }
                Ok(())
            })?;
        }
        Ok(Table::counted(wanted, columns, labels))
    }

    fn rows(&self) -> usize {
        let counts = self.groups().iter().map(|group| usize::try_from(group.num_rows()));
        counts.fold(0, |all: usize, count| all.saturating_add(count.unwrap_or(0)))
    }

    fn groups(&self) -> &[RowGroupMetaData] {
        self.metadata.metadata().row_groups()
    }

    /// A column as numbers, or what it holds instead.
    fn numbers(&self, index: usize, wanted: &Wanted<'_>) -> Result<Column, ReadError> {
        let kind = self.types.get(index).unwrap_or(&DataType::Null);
        let lists = self.metadata.parquet_schema().column(index).max_rep_level() > 0;
        if let Some(found) = if lists { Some("lists".to_owned()) } else { not_numbers(kind) } {
            return Ok(Column::not_numbers(&found));
        }
        let mut values = Vec::new();
        self.each_batch(index, wanted, &mut |batch, missing| {
            let numbers = floats(batch).map_err(damaged)?;
            let numbers = numbers.as_primitive::<Float64Type>().iter().zip(missing);
            values.extend(
                numbers.map(|(number, missing)| number.filter(|_| !missing).unwrap_or(f64::NAN)),
            );
            Ok(())
        })?;
        Ok(Column::of(values))
    }

    /// Hands on the values of a column in order, some thousand at a time, and which of them are missing
    /// with the structure that they are in.
    fn each_batch(
        &self,
        index: usize,
        Wanted { budget, .. }: &Wanted<'_>,
        take: &mut Take<'_>,
    ) -> Result<(), ReadError> {
        let largest = self.largest_part(index)?;
        budget.check(largest)?;
        // A long text that many rows share is repeated for each row of a batch.
        let most = budget.left() / COPIES / largest.max(1);
        let batch = most.clamp(1, BATCH);
        let file = self.file.try_clone().map_err(damaged)?;
        let only = ProjectionMask::leaves(self.metadata.parquet_schema(), [index]);
        let batches =
            ParquetRecordBatchReaderBuilder::new_with_metadata(file, self.metadata.clone())
                .with_projection(only)
                .with_batch_size(usize::try_from(batch).unwrap_or(1))
                .build()
                .map_err(damaged)?;
        let rows = self.rows();
        let mut left = rows;
        for batch in batches {
            let batch = batch.map_err(damaged)?;
            let mut column = batch.column(0).clone();
            // Where a structure is missing, each of its fields is.
            let mut missing = vec![false; column.len()];
            while let Some(structure) = column.clone().as_struct_opt() {
                for (row, missing) in missing.iter_mut().enumerate() {
                    *missing |= structure.is_null(row);
                }
                column = structure.column(0).clone();
            }
            let more = || damaged(format!("a column has more than {rows} rows"));
            left = left.checked_sub(column.len()).ok_or_else(more)?;
            take(&column, &missing)?;
        }
        if left > 0 {
            return Err(damaged(format!("a column has fewer than {rows} rows")));
        }
        Ok(())
    }

    /// The most bytes of a column in a group of rows, of which a page is unpacked whole. Refuses codecs that
    /// are not built in.
    fn largest_part(&self, index: usize) -> Result<u64, ReadError> {
        let mut largest = 0;
        for group in self.groups() {
            let column = group.column(index);
            if let codec @ (Compression::BROTLI(_) | Compression::LZO) = column.compression() {
                let name = column.column_path().string();
                let codec = if codec == Compression::LZO { "LZO" } else { "brotli" };
                let reason = format!("column `{name}` is compressed by {codec}, which is not read");
                let remedy =
                    "write it with zstd or snappy: `pandas.to_parquet(OUT, compression=\"zstd\")`";
                return Err(ReadError::format("Parquet", reason, remedy));
            }
            largest = largest.max(u64::try_from(column.uncompressed_size()).unwrap_or(0));
        }
        Ok(largest)
    }
}

/// What a column holds instead of numbers.
fn not_numbers(kind: &DataType) -> Option<String> {
    match kind {
        DataType::Dictionary(_, values) => not_numbers(values),
        // Days, which would be read as seconds.
        DataType::Date32 | DataType::Date64 => Some("dates without a time of day".to_owned()),
        DataType::Interval(_) => Some("intervals of the calendar".to_owned()),
        DataType::Boolean => None,
        kind if kind.is_numeric() || kind.is_temporal() => None,
        kind if kind.is_string() => Some("text".to_owned()),
        other => Some(format!("values of the type {other}")),
    }
}

/// Values as numbers; times are counts of their unit.
fn floats(values: &ArrayRef) -> Result<ArrayRef, ArrowError> {
    if values.data_type().is_temporal() {
        return cast(&cast(values, &DataType::Int64)?, &DataType::Float64);
    }
    cast(values, &DataType::Float64)
}

/// The label of each row; a number as it would stand in a text.
fn texts(values: &ArrayRef) -> Result<Vec<String>, ArrowError> {
    let labels = if values.data_type().is_numeric() || *values.data_type() == DataType::Boolean {
        let numbers = floats(values)?;
        let numbers = numbers.as_primitive::<Float64Type>().iter();
        numbers.map(|number| number.map_or_else(String::new, |x| x.to_string())).collect()
    } else {
        let texts = cast(values, &DataType::Utf8)?;
        let texts = texts.as_string::<i32>().iter();
        texts.map(|text| text.unwrap_or_default().trim().to_owned()).collect()
    };
    Ok(labels)
}
