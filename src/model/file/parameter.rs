//! Parameters as they are written: a number, or a table where there is more to say.

use toml_edit::{InlineTable, Item, TableLike};

use super::edit::{is_number, number, same, set, write, write_number};
use crate::effect::{Dimension, OwnParameter, Parameter};
use crate::model::{Component, Value};

/// Writes the parameters of `component` into its `entry`.
pub(super) fn write_component(entry: &mut dyn TableLike, component: &Component) -> Option<()> {
    let effect = component.effect();
    // Where the file refers to a definition, the limits are in the definition.
    let is_defined_here = entry.contains_key("expression");
    let own = effect.definition().filter(|_| is_defined_here).map(|own| own.parameters.as_slice());
    let own = own.unwrap_or_default().iter().map(Some).chain(std::iter::repeat(None));
    let all = effect.spec().parameters.iter().zip(component.parameters()).zip(own);
    let written = |((parameter, value), own): ((&'static Parameter, &Value), Option<_>)| {
        let written = own.map_or_else(|| (*value).into(), |own| Written::defined(own, value));
        // A definition names all its parameters, a use of it those that are not neutral.
        (parameter.name, own.is_none().then_some(parameter.neutral), written)
    };
    write_parameters(entry, all.map(written))
}

/// A parameter as it is written in a file.
#[derive(Clone, Debug)]
pub(super) struct Written {
    value: f64,
    fixed: bool,
    min: Option<f64>,
    max: Option<f64>,
    neutral: Option<f64>,
    dimension: Option<Dimension>,
}

impl From<Value> for Written {
    fn from(value: Value) -> Self {
        let Value { value, fixed, min, max } = value;
        Self { value, fixed, min, max, neutral: None, dimension: None }
    }
}

impl Written {
    fn defined(own: &OwnParameter, value: &Value) -> Self {
        Self {
            value: value.value,
            fixed: value.fixed,
            min: own.min,
            max: own.max,
            neutral: own.neutral,
            dimension: (own.dimension != Dimension::One).then_some(own.dimension),
        }
    }

    fn is_plain(&self) -> bool {
        let Self { fixed, min, max, neutral, dimension, .. } = self;
        !fixed && min.is_none() && max.is_none() && neutral.is_none() && dimension.is_none()
    }

    fn fresh(&self) -> toml_edit::Value {
        if self.is_plain() {
            return number(self.value);
        }
        let mut table = InlineTable::new();
        table.insert("value", number(self.value));
        self.write_rest(&mut table);
        table.into()
    }

    /// Replaces `item` where it says something else.
    fn replace(&self, item: &mut Item) {
        if let Some(table) = item.as_table_like_mut() {
            write_number(table, "value", Some(self.value));
            self.write_rest(table);
        } else if !self.is_plain() {
            set(item, self.fresh());
        } else if !is_number(item, self.value) {
            set(item, number(self.value));
        }
    }

    fn write_rest(&self, table: &mut dyn TableLike) {
        if table.get("fixed").and_then(Item::as_bool).unwrap_or(false) != self.fixed {
            let fixed = self.fixed.then(|| self.fixed.into());
            write(table, "fixed", fixed);
        }
        for (key, value) in [("min", self.min), ("max", self.max), ("neutral", self.neutral)] {
            write_number(table, key, value);
        }
        let dimension = self.dimension.map(Dimension::id);
        let is_known = table.get("dimension").and_then(Item::as_str) == dimension;
        if !is_known {
            write(table, "dimension", dimension.map(Into::into));
        }
    }
}

/// Writes parameters by their names, with the values that they have where they are missing.
pub(super) fn write_parameters<'a>(
    owner: &mut dyn TableLike,
    all: impl IntoIterator<Item = (&'a str, Option<f64>, Written)>,
) -> Option<()> {
    if !owner.contains_key("parameters") {
        owner.insert("parameters", toml_edit::value(InlineTable::new()));
    }
    let parameters = owner.get_mut("parameters")?.as_table_like_mut()?;
    for (name, missing, written) in all {
        let is_missing = missing.is_some_and(|missing| same(missing, written.value));
        if let Some(item) = parameters.get_mut(name) {
            written.replace(item);
        } else if !(is_missing && written.is_plain()) {
            write(parameters, name, Some(written.fresh()));
        }
    }
    if parameters.is_empty() {
        owner.remove("parameters");
    }
    Some(())
}
