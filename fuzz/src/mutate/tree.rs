//! TOML, by its values: what comes out is TOML again.

use toml::{Table, Value};

use super::{Mutation, tables};

/// Changes a value, a key or a table of a file.
pub(super) fn toml(mutation: &mut Mutation, bytes: &[u8]) -> Option<Vec<u8>> {
    let mut file: Table = std::str::from_utf8(bytes).ok()?.parse().ok()?;
    change_table(mutation, &mut file);
    Some(toml::to_string(&file).ok()?.into_bytes())
}

/// Changes something in a table, or, more often, in something that it holds.
fn change_table(mutation: &mut Mutation, table: &mut Table) {
    let keys: Vec<String> = table.keys().cloned().collect();
    if keys.is_empty() {
        return;
    }
    let key = weighted(mutation, table);
    let key = &keys[key];
    let other = &keys[mutation.below(keys.len())];
    match mutation.below(16) {
        0 => drop(table.remove(key)),
        1 => {
            let value = table[other].clone();
            table.insert(key.clone(), value);
        }
        2 => {
            let value = table[key].clone();
            let name = mutation.text(key);
            table.insert(name, value);
        }
        _ => {
            if let Some(value) = table.get_mut(key) {
                change(mutation, value);
            }
        }
    }
}

/// One of the entries of a table, each as often as it holds values.
fn weighted(mutation: &mut Mutation, table: &Table) -> usize {
    let entries = table.iter().zip(0..);
    let places = entries.flat_map(|((_, value), place)| std::iter::repeat_n(place, size(value)));
    let places: Vec<usize> = places.collect();
    places[mutation.below(places.len())]
}

/// The values in a value, a number counting as several texts, most of which name something.
fn size(value: &Value) -> usize {
    const NUMBER: usize = 4;
    match value {
        Value::Table(table) => 1 + table.iter().map(|(_, value)| size(value)).sum::<usize>(),
        Value::Array(values) => 1 + values.iter().map(size).sum::<usize>(),
        Value::Float(_) | Value::Integer(_) => NUMBER,
        _ => 1,
    }
}

fn change(mutation: &mut Mutation, value: &mut Value) {
    match value {
        Value::Table(table) => change_table(mutation, table),
        Value::Array(values) if values.is_empty() || mutation.one_in(4) => {
            mutation.shuffle(values);
        }
        Value::Array(values) => {
            let place = mutation.below(values.len());
            change(mutation, &mut values[place]);
        }
        _ if mutation.one_in(16) => *value = any(mutation),
        Value::String(text) => {
            // As an expression, where it is one.
            let words = tables::words(mutation, text.as_bytes());
            *text = words.map_or_else(String::new, |words| String::from_utf8_lossy(&words).into());
        }
        Value::Float(number) => *number = mutation.float(*number),
        Value::Integer(number) => *number = integer(mutation, *number),
        Value::Boolean(flag) => *flag = !*flag,
        Value::Datetime(_) => *value = any(mutation),
    }
}

/// A value of another kind.
fn any(mutation: &mut Mutation) -> Value {
    match mutation.below(6) {
        0 => Value::String(mutation.text("a")),
        1 => Value::Float(mutation.float(1.0)),
        2 => Value::Integer(integer(mutation, 1)),
        3 => Value::Boolean(true),
        4 => Value::Array(vec![Value::Float(mutation.float(0.5)), Value::Float(1.0)]),
        _ => Value::Table(Table::new()),
    }
}

fn integer(mutation: &mut Mutation, number: i64) -> i64 {
    match mutation.below(3) {
        0 => mutation.extreme().cast_signed(),
        1 => number.wrapping_add(1),
        _ => number.wrapping_neg(),
    }
}
