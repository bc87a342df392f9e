//! Parquet: columns of numbers, times or text, with a row number for messages.
//!
//! A column in a structure is called by its path, `boom.input`, as is a flat one of that name.

mod durations;

use std::fs::File;
use std::iter::repeat_n;
use std::path::Path;

use parquet::basic::{LogicalType, TimeUnit, Type};
use parquet::column::reader::{ColumnReader, ColumnReaderImpl};
use parquet::data_type::{ByteArray, DataType};
use parquet::errors::ParquetError;
use parquet::file::metadata::RowGroupMetaData;
use parquet::file::reader::{FileReader as _, SerializedFileReader};
use parquet::schema::types::ColumnDescriptor;

use crate::experiment::error::ReadError;
use crate::experiment::memory::{Budget, TooLarge};
use crate::experiment::table::{
    Column, Head, Header, LONGEST_NAME, Labels, OpenTable, Rows, Table, Wanted,
};

/// Memory of a number: itself, and what its vector has to spare.
const NUMBER_SIZE: usize = 2 * size_of::<f64>();

/// Memory of a text beside its bytes.
const LABEL_SIZE: usize = 64;

/// More bytes than a name may have, by more than what is left of a letter.
const TOO_LONG: usize = LONGEST_NAME + 8;

/// A file whose footer was read.
struct Unread {
    reader: SerializedFileReader<File>,
    budget: Budget,
}

/// Opens the log and reads its schema.
pub(super) fn open(path: &Path, budget: Budget) -> Result<OpenTable, ReadError> {
    let io_error = |source| ReadError::Io { path: path.to_owned(), source };
    let file = File::open(path).map_err(io_error)?;
    let size = file.metadata().map_err(io_error)?.len();
    let reader = SerializedFileReader::new(file).map_err(|error| damaged(path, &error))?;
    if !reader.metadata().row_groups().iter().all(|group| lies_within(group, size)) {
        let outside = ParquetError::EOF("a column lies outside of the file".to_owned());
        return Err(damaged(path, &outside));
    }
    let columns = reader.metadata().file_metadata().schema_descr().columns();
    let durations = durations::durations(&reader);
    let headers = columns.iter().map(|column| header(column, &durations)).collect();
    let head = Head { path: path.to_owned(), headers, header_row: 0, unread: Vec::new() };
    Ok(OpenTable { head, rows: Box::new(Unread { reader, budget }) })
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

fn damaged(path: &Path, error: &ParquetError) -> ReadError {
    let unsupported = matches!(error, ParquetError::NYI(_));
    let remedy = if unsupported {
        "write it with the compression zstd, snappy, lz4, gzip or none"
    } else {
        "write it again: a file that is not complete cannot be read"
    };
    ReadError::Format {
        path: path.to_owned(),
        format: "Parquet",
        reason: error.to_string(),
        remedy,
    }
}

/// A time or a duration is in the unit of its type, whatever its name says.
fn header(column: &ColumnDescriptor, durations: &[(String, &'static str)]) -> Header {
    let mut header = Header::parse(&column.path().string());
    let name = column.path().string();
    let of_duration = || durations.iter().find(|(of, _)| *of == name).map(|(_, unit)| *unit);
    let of_type = match column.logical_type_ref() {
        Some(LogicalType::Timestamp(time) | LogicalType::Time(time)) => match time.unit {
            TimeUnit::MILLIS => Some("ms"),
            TimeUnit::MICROS => Some("us"),
            TimeUnit::NANOS => Some("ns"),
        },
        _ => of_duration(),
    };
    header.unit = of_type.map(str::to_owned).or(header.unit);
    header
}

impl Rows for Unread {
    fn read(self: Box<Self>, wanted: &Wanted<'_>) -> Result<Table, ReadError> {
        let schema = self.reader.metadata().file_metadata().schema_descr();
        let kinds: Vec<_> =
            wanted.numeric.iter().map(|index| not_numbers(&schema.column(*index))).collect();
        let mut columns = vec![Column::default(); wanted.numeric.len()];
        let mut labels = Labels::default();
        let mut rows = 0;
        let refuse = |error: TooLarge| error.refuse(wanted.path());
        let counts = self.reader.metadata().row_groups().iter();
        let counts: Vec<usize> =
            counts.map(|group| usize::try_from(group.num_rows()).unwrap_or_default()).collect();
        let all = counts.iter().fold(0, |all: usize, count| all.saturating_add(*count));
        self.budget.take_values(all, wanted.numeric.len() * NUMBER_SIZE).map_err(refuse)?;
        for (group, count) in counts.into_iter().enumerate() {
            let of_group = self.reader.metadata().row_group(group);
            let read = |index, cells: &mut dyn FnMut(Cell)| {
                // A page is unpacked whole.
                let unpacked = of_group.column(index).uncompressed_size();
                self.budget.check(u64::try_from(unpacked).unwrap_or_default()).map_err(refuse)?;
                self.group(group, index, cells).map_err(|error| damaged(wanted.path(), &error))
            };
            for ((column, index), kind) in columns.iter_mut().zip(wanted.numeric).zip(&kinds) {
                if let Some(kind) = kind {
                    *column = Column::not_numbers(kind);
                    continue;
                }
                let described = schema.column(*index);
                column.are_of_day =
                    matches!(described.logical_type_ref(), Some(LogicalType::Time(_)));
                read(*index, &mut |cell| column.add(cell.number()))?;
            }
            if let Some(index) = wanted.label {
                let mut texts = Runs { all: Vec::new(), refused: Ok(()), budget: &self.budget };
                read(index, &mut |cell| texts.push(cell.label()))?;
                texts.refused.map_err(refuse)?;
                let rows = rows + 1..;
                let each = texts.all.iter().flat_map(|(text, count)| repeat_n(text, *count));
                for (text, row) in each.zip(rows) {
                    labels.push(text, row as u64, (wanted.path(), &self.budget))?;
                }
            }
            rows += count;
        }
        Table::counted(wanted.path(), rows, columns, &labels)
    }
}

/// What a column holds instead of numbers.
fn not_numbers(column: &ColumnDescriptor) -> Option<String> {
    let logical = column.logical_type_ref();
    match column.physical_type() {
        _ if column.max_rep_level() > 0 => Some("lists".to_owned()),
        // Days, which would be read as seconds.
        _ if matches!(logical, Some(LogicalType::Date)) => {
            Some("dates without a time of day".to_owned())
        }
        Type::BOOLEAN | Type::FLOAT | Type::DOUBLE | Type::INT32 | Type::INT64 => None,
        Type::FIXED_LEN_BYTE_ARRAY if fixed_length(column).is_some() => None,
        Type::BYTE_ARRAY if matches!(logical, Some(LogicalType::String)) => Some("text".to_owned()),
        other => Some(format!("values of the type {other}")),
    }
}

impl Unread {
    /// Hands on the cells of a column in a group of rows, one by one.
    fn group(
        &self,
        group: usize,
        column: usize,
        cells: &mut dyn FnMut(Cell),
    ) -> Result<(), ParquetError> {
        let schema = self.reader.metadata().file_metadata().schema_descr();
        let full = schema.column(column).max_def_level();
        let rows = self.reader.metadata().row_group(group).num_rows();
        let unsigned = matches!(
            schema.column(column).logical_type_ref(),
            Some(LogicalType::Integer(int)) if !int.is_signed
        );
        let unit = decimal_unit(&schema.column(column));
        let fixed = fixed_length(&schema.column(column));
        #[expect(clippy::cast_sign_loss, reason = "the bits are those of an unsigned number")]
        match self.reader.get_row_group(group)?.get_column_reader(column)? {
            ColumnReader::BoolColumnReader(reader) => {
                each(reader, full, |value| Cell::Number(f64::from(u8::from(value))), rows, cells)
            }
            ColumnReader::Int32ColumnReader(reader) if unsigned => {
                each(reader, full, |value| Cell::Number(f64::from(value as u32)), rows, cells)
            }
            ColumnReader::Int32ColumnReader(reader) => {
                each(reader, full, |value| Cell::Number(f64::from(value) / unit), rows, cells)
            }
            ColumnReader::Int64ColumnReader(reader) if unsigned => {
                each(reader, full, |value| Cell::Number(value as u64 as f64), rows, cells)
            }
            ColumnReader::Int64ColumnReader(reader) => {
                each(reader, full, |value| Cell::Number(value as f64 / unit), rows, cells)
            }
            ColumnReader::FloatColumnReader(reader) => {
                each(reader, full, |value| Cell::Number(f64::from(value)), rows, cells)
            }
            ColumnReader::DoubleColumnReader(reader) => {
                each(reader, full, Cell::Number, rows, cells)
            }
            ColumnReader::FixedLenByteArrayColumnReader(reader) => {
                let fixed = fixed.ok_or_else(|| {
                    ParquetError::NYI("a column of bytes of a fixed length".to_owned())
                })?;
                each(reader, full, |value| fixed.number(value.data()), rows, cells)
            }
            ColumnReader::ByteArrayColumnReader(reader) => each(reader, full, text, rows, cells),
            ColumnReader::Int96ColumnReader(_) => {
                Err(ParquetError::NYI("a column of 96-bit numbers".to_owned()))
            }
        }
    }
}

/// What the integers of a column of decimals are divided by; one for other columns.
fn decimal_unit(column: &ColumnDescriptor) -> f64 {
    match column.logical_type_ref() {
        Some(LogicalType::Decimal(decimal)) => 10_f64.powi(decimal.scale),
        _ => 1.0,
    }
}

/// A number of a fixed count of bytes.
#[derive(Clone, Copy, Debug)]
enum Fixed {
    /// Half precision.
    Half,
    /// A decimal, divided by so much.
    Decimal(f64),
}

/// How the numbers of a column of fixed length are written; none where these are no numbers.
fn fixed_length(column: &ColumnDescriptor) -> Option<Fixed> {
    match column.logical_type_ref()? {
        LogicalType::Float16 => Some(Fixed::Half),
        LogicalType::Decimal(_) => Some(Fixed::Decimal(decimal_unit(column))),
        _ => None,
    }
}

impl Fixed {
    fn number(self, bytes: &[u8]) -> Cell {
        match self {
            Self::Half => bytes.try_into().map_or(Cell::Missing, |bytes| Cell::Number(half(bytes))),
            Self::Decimal(unit) => Cell::Number(signed(bytes) / unit),
        }
    }
}

/// A number of half precision, IEEE 754 binary16: `(−1)^s 2^(e − 15) (1 + f/1024)`.
fn half(bytes: [u8; 2]) -> f64 {
    let bits = u16::from_le_bytes(bytes);
    let (exponent, fraction) = (i32::from((bits >> 10) & 0x1f), f64::from(bits & 0x3ff) / 1024.0);
    let size = match exponent {
        0 => fraction * 2_f64.powi(-14),
        0x1f if fraction > 0.0 => f64::NAN,
        0x1f => f64::INFINITY,
        _ => (1.0 + fraction) * 2_f64.powi(exponent - 15),
    };
    if bits >> 15 == 1 { -size } else { size }
}

/// A whole number of any length, in two's complement, the highest byte first.
fn signed(bytes: &[u8]) -> f64 {
    let Some((first, others)) = bytes.split_first() else { return 0.0 };
    let head = f64::from(i8::from_be_bytes([*first]));
    others.iter().fold(head, |sum, byte| sum * 256.0 + f64::from(*byte))
}

/// Texts as runs of equal ones.
struct Runs<'a> {
    all: Vec<(String, usize)>,
    refused: Result<(), TooLarge>,
    budget: &'a Budget,
}

impl Runs<'_> {
    fn push(&mut self, text: String) {
        match self.all.last_mut().filter(|(last, _)| *last == text) {
            Some((_, count)) => *count += 1,
            None if self.refused.is_ok() => {
                self.refused = self.budget.take_values(1, LABEL_SIZE + text.len());
                self.all.push((text, 1));
            }
            None => {}
        }
    }
}

/// A value of a column.
enum Cell {
    Missing,
    Number(f64),
    Text(String),
}

impl Cell {
    fn number(&self) -> f64 {
        if let Self::Number(value) = self { *value } else { f64::NAN }
    }

    fn label(self) -> String {
        match self {
            Self::Missing => String::new(),
            Self::Number(value) => value.to_string(),
            Self::Text(text) => text,
        }
    }
}

#[expect(clippy::needless_pass_by_value, reason = "the reader hands its values over")]
fn text(value: ByteArray) -> Cell {
    // What is longer than a name may be is refused by its length, not by its end.
    let bytes = value.data().get(..TOO_LONG).unwrap_or(value.data());
    Cell::Text(String::from_utf8_lossy(bytes).trim().to_owned())
}

/// Hands on the values of the `rows` of a column as cells; where the level is not `full` there
/// is none.
fn each<T: DataType>(
    mut reader: ColumnReaderImpl<T>,
    full: i16,
    cell: impl Fn(T::T) -> Cell,
    rows: i64,
    cells: &mut dyn FnMut(Cell),
) -> Result<(), ParquetError> {
    /// Rows that are read at once.
    const ROWS: usize = 8192;
    // Pages may hold more rows than their group says it has, for which there is no memory.
    let mut left = usize::try_from(rows).unwrap_or_default();
    let unequal = || ParquetError::General(format!("a column has more or fewer than {rows} rows"));
    loop {
        let (mut levels, mut values) = (Vec::new(), Vec::new());
        let (count, _, _) = reader.read_records(ROWS, Some(&mut levels), None, &mut values)?;
        if count == 0 {
            return if left == 0 { Ok(()) } else { Err(unequal()) };
        }
        left = left.checked_sub(count).ok_or_else(unequal)?;
        let mut values = values.into_iter().map(&cell);
        if full == 0 {
            values.by_ref().for_each(&mut *cells);
        }
        for level in levels {
            let present = (level == full).then(|| values.next()).flatten();
            cells(present.unwrap_or(Cell::Missing));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_of_a_fixed_length_are_read() {
        let halves = [[0, 0x3c], [0, 0xc0], [0xff, 0x7b], [1, 0], [0, 0x7c]].map(half);
        assert_eq!(
            halves.map(|x| x.to_string()),
            ["1", "-2", "65504", "0.00000005960464477539063", "inf"]
        );
        assert!(half([1, 0x7c]).is_nan());
        let whole = [&[0xff, 0xfe][..], &[0, 1, 0], &[0x80, 0], &[]].map(signed);
        assert_eq!(whole.map(|x| x.to_string()), ["-2", "256", "-32768", "0"]);
    }
}
