//! Tables through the Arrow C interface: of pandas, polars, pyarrow, or whoever offers
//! `__arrow_c_stream__`.

use std::collections::HashMap;

use arrow_array::cast::AsArray as _;
use arrow_array::ffi_stream::ArrowArrayStreamReader;
use arrow_array::types::{
    ArrowPrimitiveType, Decimal128Type, Float16Type, Float32Type, Float64Type, Int8Type, Int16Type,
    Int32Type, Int64Type, UInt8Type, UInt16Type, UInt32Type, UInt64Type,
};
use arrow_array::{Array, ArrayRef, Int32Array, Int64Array, RecordBatch, RecordBatchReader as _};
use arrow_pyarrow::FromPyArrow as _;
use arrow_schema::{DataType, TimeUnit};
use pyo3::prelude::*;
use tauscope::experiment::{HandedColumn, HandedValues};

use crate::TauscopeError;

/// A table as it lies in the memory of whoever made it.
#[pyclass(frozen, module = "tauscope")]
pub(crate) struct Frame {
    /// Names of the columns, and where each is in the batches.
    columns: Vec<(String, usize)>,
    batches: Vec<RecordBatch>,
}

#[pymethods]
impl Frame {
    /// The columns of `table`; those in `names` have another name, or are left out.
    #[new]
    fn new(table: &Bound<'_, PyAny>, names: HashMap<String, Option<String>>) -> PyResult<Self> {
        let stream = ArrowArrayStreamReader::from_pyarrow_bound(table)?;
        let schema = stream.schema();
        let all = schema.fields().iter().map(|field| field.name()).enumerate();
        let kept = |(index, name): (usize, &String)| {
            let given = names.get(name).cloned().unwrap_or_else(|| Some(name.clone()));
            Some((given?, index))
        };
        let columns = all.filter_map(kept).collect();
        let batches = stream.collect::<Result<_, _>>();
        let batches = batches.map_err(|error| TauscopeError::new_err(error.to_string()))?;
        Ok(Self { columns, batches })
    }
}

impl Frame {
    /// The columns, copied once.
    pub(crate) fn columns(&self) -> Vec<HandedColumn> {
        let rows = self.batches.iter().map(RecordBatch::num_rows).sum();
        let column = |(name, index): &(String, usize)| {
            let parts: Vec<&ArrayRef> =
                self.batches.iter().map(|batch| batch.column(*index)).collect();
            HandedColumn { name: name.clone(), values: values(&parts, rows) }
        };
        self.columns.iter().map(column).collect()
    }
}

/// The values of a column in parts; texts without a letter where it holds neither numbers, times
/// nor texts.
fn values(parts: &[&ArrayRef], rows: usize) -> HandedValues {
    let mut numbers = Vec::with_capacity(rows);
    if parts.iter().all(|part| push_numbers(part, &mut numbers).is_some()) {
        return HandedValues::Numbers(numbers);
    }
    drop(numbers);
    seconds(parts, rows).map_or_else(
        || HandedValues::Texts(parts.iter().flat_map(|part| texts(part)).collect()),
        HandedValues::Numbers,
    )
}

/// Adds the numbers of `part`, NaN where there is none; nothing where it holds something else.
fn push_numbers(part: &ArrayRef, numbers: &mut Vec<f64>) -> Option<()> {
    #[expect(clippy::cast_precision_loss, reason = "no more digits than float64 has")]
    match part.data_type() {
        DataType::Float64 => push::<Float64Type>(part, numbers, |value| value),
        DataType::Float32 => push::<Float32Type>(part, numbers, f64::from),
        DataType::Float16 => push::<Float16Type>(part, numbers, f64::from),
        DataType::Int64 => push::<Int64Type>(part, numbers, |value| value as f64),
        DataType::Int32 => push::<Int32Type>(part, numbers, f64::from),
        DataType::Int16 => push::<Int16Type>(part, numbers, f64::from),
        DataType::Int8 => push::<Int8Type>(part, numbers, f64::from),
        DataType::UInt64 => push::<UInt64Type>(part, numbers, |value| value as f64),
        DataType::UInt32 => push::<UInt32Type>(part, numbers, f64::from),
        DataType::UInt16 => push::<UInt16Type>(part, numbers, f64::from),
        DataType::UInt8 => push::<UInt8Type>(part, numbers, f64::from),
        DataType::Decimal128(_, scale) => {
            let unit = 10_f64.powi(i32::from(*scale));
            push::<Decimal128Type>(part, numbers, |value| value as f64 / unit);
        }
        DataType::Boolean => {
            let number = |value: Option<bool>| value.map_or(f64::NAN, |is| f64::from(u8::from(is)));
            numbers.extend(part.as_boolean().iter().map(number));
        }
        DataType::Null => numbers.resize(numbers.len() + part.len(), f64::NAN),
        DataType::Dictionary(_, _) => {
            let mut known = Vec::new();
            push_numbers(part.as_any_dictionary().values(), &mut known)?;
            let number = |place: Option<usize>| place.and_then(|place| known.get(place));
            let of_rows = places(part).into_iter().map(number);
            numbers.extend(of_rows.map(|number| number.copied().unwrap_or(f64::NAN)));
        }
        _ => return None,
    }
    Some(())
}

/// Adds the values of `part`, NaN where there is none.
fn push<T: ArrowPrimitiveType>(
    part: &ArrayRef,
    numbers: &mut Vec<f64>,
    number: impl Fn(T::Native) -> f64,
) {
    let part = part.as_primitive::<T>();
    if part.null_count() == 0 {
        numbers.extend(part.values().iter().map(|value| number(*value)));
    } else {
        numbers.extend(part.iter().map(|value| value.map_or(f64::NAN, &number)));
    }
}

/// Times in seconds from the first, NaN where there is none; nothing where there are others.
fn seconds(parts: &[&ArrayRef], rows: usize) -> Option<Vec<f64>> {
    let per_second = match parts.first()?.data_type() {
        DataType::Timestamp(unit, _)
        | DataType::Duration(unit)
        | DataType::Time32(unit)
        | DataType::Time64(unit) => match unit {
            TimeUnit::Second => 1.0,
            TimeUnit::Millisecond => 1e3,
            TimeUnit::Microsecond => 1e6,
            TimeUnit::Nanosecond => 1e9,
        },
        DataType::Date64 => 1e3,
        DataType::Date32 => 1.0 / 86_400.0,
        _ => return None,
    };
    let mut seconds = Vec::with_capacity(rows);
    let mut first = None;
    for part in parts {
        // Differences of the ticks themselves are exact; they lie in memory as whole numbers.
        let data = part.to_data().into_builder();
        let ticks: Vec<Option<i64>> = match part.data_type() {
            DataType::Time32(_) | DataType::Date32 => {
                let ticks = Int32Array::from(data.data_type(DataType::Int32).build().ok()?);
                ticks.iter().map(|tick| tick.map(i64::from)).collect()
            }
            _ => Int64Array::from(data.data_type(DataType::Int64).build().ok()?).iter().collect(),
        };
        first = first.or_else(|| ticks.iter().copied().flatten().next());
        let origin = first.unwrap_or_default();
        #[expect(clippy::cast_precision_loss, reason = "no more digits than float64 has")]
        let since = |tick: i64| tick.saturating_sub(origin) as f64 / per_second;
        seconds.extend(ticks.into_iter().map(|tick| tick.map_or(f64::NAN, since)));
    }
    Some(seconds)
}

/// The texts of `part`; without a letter where there is none, or something else.
fn texts(part: &ArrayRef) -> Vec<String> {
    let text = |text: Option<&str>| text.unwrap_or_default().to_owned();
    match part.data_type() {
        DataType::Utf8 => part.as_string::<i32>().iter().map(text).collect(),
        DataType::LargeUtf8 => part.as_string::<i64>().iter().map(text).collect(),
        DataType::Utf8View => part.as_string_view().iter().map(text).collect(),
        DataType::Dictionary(_, _) => {
            let known = texts(part.as_any_dictionary().values());
            let places = places(part).into_iter();
            places
                .map(|place| place.and_then(|it| known.get(it)).cloned().unwrap_or_default())
                .collect()
        }
        _ => vec![String::new(); part.len()],
    }
}

/// Where the value of each row is among those of a dictionary.
fn places(part: &ArrayRef) -> Vec<Option<usize>> {
    let dictionary = part.as_any_dictionary();
    if dictionary.values().is_empty() {
        return vec![None; part.len()];
    }
    let keys = dictionary.normalized_keys().into_iter().enumerate();
    keys.map(|(row, key)| (!dictionary.keys().is_null(row)).then_some(key)).collect()
}
