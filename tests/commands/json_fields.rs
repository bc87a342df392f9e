//! Each field that `compare`, `explain`, `add` and `improve` print for programs is in the documents.

use std::collections::BTreeSet;
use std::path::Path;

use serde_json::Value;

use crate::desk::{Desk, banded, joint};

/// What stands between backticks in the documents.
fn documented() -> BTreeSet<String> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("docs/model_files.md");
    let text = std::fs::read_to_string(path).unwrap();
    let quoted = text.split('`').skip(1).step_by(2);
    quoted.map(str::to_owned).collect()
}

/// Names of the fields of `value`, with where they are; those of `parameters` are the model's.
fn fields(value: &Value, place: &str, into: &mut BTreeSet<(String, String)>) {
    match value {
        Value::Object(object) => {
            for (name, field) in object {
                let here = format!("{place}.{name}");
                if !place.ends_with(".parameters") {
                    into.insert((name.clone(), here.clone()));
                }
                fields(field, &here, into);
            }
        }
        Value::Array(values) => values.iter().for_each(|value| fields(value, place, into)),
        Value::Null | Value::Bool(_) | Value::Number(_) | Value::String(_) => {}
    }
}

#[test]
fn are_documented() {
    let desk = Desk::with(vec![banded("boom"), joint("stick")]);
    let mut found = BTreeSet::new();
    for command in [
        "compare log.csv",
        "explain log.csv",
        "add dead_band log.csv --write added.toml",
        "improve log.csv --write improved.toml",
    ] {
        fields(&desk.json(command, 0), command, &mut found);
    }
    assert!(found.len() > 60, "{found:?}");
    let documented = documented();
    let missing: Vec<_> = found.iter().filter(|(name, _)| !documented.contains(name)).collect();
    assert!(missing.is_empty(), "{missing:?}");
}
