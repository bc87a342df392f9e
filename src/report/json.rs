//! What every document begins with, and how objects are put together.

use serde_json::{Map, Value, json};

/// A document: schema and version of the program, then `facts`.
pub(crate) fn document(schema: &str, facts: Value) -> Value {
    joined([json!({ "schema": schema, "version": env!("CARGO_PKG_VERSION") }), facts])
}

/// One object with the fields of all `parts`, in their order.
pub(in crate::report) fn joined<const N: usize>(parts: [Value; N]) -> Value {
    let mut all = Map::new();
    for part in parts {
        if let Value::Object(fields) = part {
            all.extend(fields);
        }
    }
    all.into()
}

/// `facts` without those of the `optional` fields that say nothing: `null`, `false`, or empty.
pub(super) fn without_empty(mut facts: Value, optional: &[&str]) -> Value {
    let says_nothing = |value: &Value| match value {
        Value::Null | Value::Bool(false) => true,
        Value::Array(values) => values.is_empty(),
        Value::Object(fields) => fields.is_empty(),
        _ => false,
    };
    if let Value::Object(fields) = &mut facts {
        fields.retain(|name, value| !(optional.contains(&name.as_str()) && says_nothing(value)));
    }
    facts
}
