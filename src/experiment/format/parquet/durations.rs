//! Columns of durations, for which Parquet has no type: they are numbers without a unit there, and
//! what wrote the file says apart what they are.

use arrow_ipc::{Field, TimeUnit, root_as_message};
use base64::Engine as _;
use base64::prelude::BASE64_STANDARD;
use parquet::file::reader::{FileReader as _, SerializedFileReader};
use serde_json::Value;

/// What precedes the length of a message in Arrow's stream format since version 0.15.
const CONTINUATION: [u8; 4] = [0xff; 4];

/// Paths and units of the columns that are durations, after pandas and after Arrow.
pub(super) fn durations<R: parquet::file::reader::ChunkReader + 'static>(
    reader: &SerializedFileReader<R>,
) -> Vec<(String, &'static str)> {
    let entries = reader.metadata().file_metadata().key_value_metadata();
    let said = |key: &str| {
        entries?.iter().find(|entry| entry.key == key).and_then(|entry| entry.value.as_deref())
    };
    let mut found = said("pandas").map(of_pandas).unwrap_or_default();
    found.extend(said("ARROW:schema").and_then(of_arrow).unwrap_or_default());
    found
}

/// After the [metadata of pandas](https://pandas.pydata.org/docs/development/developer.html), JSON.
fn of_pandas(said: &str) -> Vec<(String, &'static str)> {
    let said = serde_json::from_str::<Value>(said).unwrap_or_default();
    let columns = said.get("columns").and_then(Value::as_array);
    let duration = |column: &Value| {
        let text = |key: &str| column.get(key)?.as_str();
        let unit = match text("numpy_type")? {
            "timedelta64[s]" => "s",
            "timedelta64[ms]" => "ms",
            "timedelta64[us]" => "us",
            "timedelta64[ns]" => "ns",
            _ => return None,
        };
        Some((text("field_name")?.to_owned(), unit))
    };
    columns.into_iter().flatten().filter_map(duration).collect()
}

/// After the schema that pyarrow, Polars and Arrow for R leave: a message of the
/// [stream format](https://arrow.apache.org/docs/format/Columnar.html#encapsulated-message-format)
/// in base 64.
///
/// The message is walked here, since `arrow_ipc::convert` panics at a schema that is damaged.
fn of_arrow(said: &str) -> Option<Vec<(String, &'static str)>> {
    let bytes = BASE64_STANDARD.decode(said).ok()?;
    let message = bytes.strip_prefix(&CONTINUATION).unwrap_or(&bytes).get(size_of::<i32>()..)?;
    let schema = root_as_message(message).ok()?.header_as_schema()?;
    let mut found = Vec::new();
    for field in schema.fields()? {
        collect(field, "", &mut found);
    }
    Some(found)
}

fn collect(field: Field<'_>, parent: &str, found: &mut Vec<(String, &'static str)>) {
    let path = format!("{parent}{}", field.name().unwrap_or_default());
    let unit = field.type_as_duration().and_then(|duration| match duration.unit() {
        TimeUnit::SECOND => Some("s"),
        TimeUnit::MILLISECOND => Some("ms"),
        TimeUnit::MICROSECOND => Some("us"),
        TimeUnit::NANOSECOND => Some("ns"),
        _ => None,
    });
    for child in field.children().into_iter().flatten() {
        collect(child, &format!("{path}."), found);
    }
    found.extend(unit.map(|unit| (path, unit)));
}
