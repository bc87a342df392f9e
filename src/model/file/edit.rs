//! Edits of a TOML document that leave comments, order and spacing as they were.

use toml_edit::{Array, ArrayOfTables, Item, Table, TableLike};

/// Puts `text` under `key`.
pub(super) fn set_text(table: &mut Table, key: &str, text: &str) {
    table.insert(key, toml_edit::value(text));
}

/// The item under `key`; `new` where there is none.
pub(super) fn or_new<'t>(
    table: &'t mut dyn TableLike,
    key: &str,
    new: Table,
) -> Option<&'t mut Item> {
    if !table.contains_key(key) {
        table.insert(key, Item::Table(new));
    }
    table.get_mut(key)
}

/// Several tables, each under its own header or all in brackets.
pub(super) fn entries(item: &mut Item) -> Option<Vec<&mut dyn TableLike>> {
    fn wide(table: &mut impl TableLike) -> &mut dyn TableLike {
        table
    }
    match item {
        Item::ArrayOfTables(tables) => Some(tables.iter_mut().map(wide).collect()),
        Item::Value(toml_edit::Value::Array(array)) => {
            array.iter_mut().map(|value| value.as_inline_table_mut().map(wide)).collect()
        }
        _ => None,
    }
}

/// Drops all entries but those with these `indices`.
pub(super) fn retain(item: &mut Item, indices: &[usize]) {
    let mut index = 0;
    let mut is_kept = || {
        index += 1;
        indices.contains(&(index - 1))
    };
    match item {
        Item::ArrayOfTables(tables) => tables.retain(|_| is_kept()),
        Item::Value(toml_edit::Value::Array(array)) => array.retain(|_| is_kept()),
        _ => (),
    }
}

pub(super) fn is_empty(item: &Item) -> bool {
    item.as_array_of_tables().is_some_and(ArrayOfTables::is_empty)
        || item.as_array().is_some_and(Array::is_empty)
}

/// Adds an entry in the form that the others have, after an empty line if they are.
pub(super) fn push(table: &mut dyn TableLike, key: &str, mut entry: Table) -> Option<()> {
    if !table.contains_key(key) {
        table.insert(key, Item::ArrayOfTables(ArrayOfTables::new()));
    }
    match table.get_mut(key)? {
        Item::ArrayOfTables(tables) => {
            let above = |table: &Table| table.decor().prefix()?.as_str().map(str::to_owned);
            let last = tables.iter().last().and_then(above).unwrap_or_default();
            entry.decor_mut().set_prefix(if last.starts_with('\n') { "\n" } else { "" });
            tables.push(entry);
        }
        Item::Value(toml_edit::Value::Array(array)) => array.push(entry.into_inline_table()),
        _ => return None,
    }
    Some(())
}

pub(super) fn write_number(table: &mut dyn TableLike, key: &str, value: Option<f64>) {
    let is_same = match (table.get(key), value) {
        (Some(item), Some(value)) => is_number(item, value),
        (found, value) => found.is_none() && value.is_none(),
    };
    if !is_same {
        write(table, key, value.map(number));
    }
}

/// Puts a value under `key`, or removes the one there.
pub(super) fn write(table: &mut dyn TableLike, key: &str, value: Option<toml_edit::Value>) {
    let Some(mut value) = value else {
        table.remove(key);
        return;
    };
    if let Some(item) = table.get_mut(key) {
        set(item, value);
        return;
    }
    // In braces, the space before the closing one belongs to the last value.
    let last = table.iter_mut().last().and_then(|(_, item)| item.as_value_mut());
    if let Some(last) = last
        && let Some(suffix) = last.decor().suffix().and_then(|suffix| suffix.as_str())
        && !suffix.is_empty()
        && suffix.chars().all(|c| c == ' ')
    {
        let suffix = suffix.to_owned();
        last.decor_mut().set_suffix("");
        value.decor_mut().set_suffix(suffix);
        value.decor_mut().set_prefix(" ");
    }
    table.insert(key, Item::Value(value));
}

/// Puts a value in the place of another, with the spaces and the comment about it.
pub(super) fn set(item: &mut Item, mut value: toml_edit::Value) {
    if let Some(old) = item.as_value() {
        *value.decor_mut() = old.decor().clone();
    }
    *item = Item::Value(value);
}

pub(super) fn is_number(item: &Item, value: f64) -> bool {
    let found = item.as_float().or_else(|| item.as_integer().map(|whole| whole as f64));
    found.is_some_and(|found| same(found, value))
}

pub(super) fn same(a: f64, b: f64) -> bool {
    a.to_bits() == b.to_bits()
}

/// A number with as many digits as it takes to read the same one; large and small ones as
/// `1e-12`.
pub(super) fn number(value: f64) -> toml_edit::Value {
    format!("{value:?}").parse().unwrap_or_else(|_| value.into())
}
