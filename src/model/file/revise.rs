//! Models back into the text they came from.
//!
//! What a user wrote stays as it is: comments, order, how a number is written that has not
//! changed. Only what the model says otherwise is replaced.

use toml_edit::{Array, ArrayOfTables, DocumentMut, InlineTable, Item, Table, TableLike};

use super::{ModelError, ModelFile, Revision, SCHEMA};
use crate::effect::expression::KIND;
use crate::effect::{Definition, Dimension, Effect, OwnParameter, Parameter};
use crate::model::{Component, JointModel, Value};

impl ModelFile {
    /// This file with `model` for `joint`, whose history goes on with `revision`.
    ///
    /// Values are replaced in place. Effects that the model no longer has go, with the
    /// comments above them; those that it has beyond the file's come behind the others. A
    /// joint that the file has not is added. Numbers are written with as many digits as it
    /// takes to read the same ones.
    ///
    /// # Errors
    /// [`ModelError`] when what was written could not be read again: a value that is not
    /// finite, or an effect that no file can name.
    ///
    /// # Examples
    /// ```
    /// use std::path::Path;
    /// use tauscope::effect::DeadBand;
    /// use tauscope::model::{Component, ModelFile, Revision};
    ///
    /// let text = r#"
    /// schema = "tauscope/model/1"
    /// [joint.boom]
    /// structure = "integrator"
    /// parameters = { gain = 11.90, delay = 0.15 } # from the data sheet
    /// "#;
    /// let file = ModelFile::parse(text, Path::new("boom.toml"))?;
    /// let plain = file.joint("boom").unwrap();
    /// let banded = plain.with(Component::new(&DeadBand, vec![(-0.6).into(), 0.6.into()]).unwrap());
    /// let added = Some("dead_band".to_owned());
    /// let revision = Revision { revision: 1, added, validation_rmse: Some(0.06), ..<_>::default() };
    ///
    /// let behind = r#"[[joint.boom.effect]]
    /// kind = "dead_band"
    /// parameters = { lower = -0.6, upper = 0.6 }
    /// [[joint.boom.history]]
    /// revision = 1
    /// added = "dead_band"
    /// validation_rmse = 0.06
    /// "#;
    /// assert_eq!(file.revised("boom", &banded, &revision)?.text(), text.to_owned() + behind);
    /// # Ok::<(), tauscope::model::ModelError>(())
    /// ```
    pub fn revised(
        &self,
        joint: &str,
        model: &JointModel,
        revision: &Revision,
    ) -> Result<Self, ModelError> {
        self.rewritten(joint, model, Some(revision))
    }

    /// This file with `model` for `joint`, whose history stays as it is: see
    /// [`revised`](Self::revised).
    ///
    /// # Errors
    /// As [`revised`](Self::revised).
    pub fn refitted(&self, joint: &str, model: &JointModel) -> Result<Self, ModelError> {
        self.rewritten(joint, model, None)
    }

    fn rewritten(
        &self,
        joint: &str,
        model: &JointModel,
        revision: Option<&Revision>,
    ) -> Result<Self, ModelError> {
        let mut document: DocumentMut = self.text.parse().map_err(|error| ModelError::Edit {
            path: self.path.clone(),
            source: Box::new(error),
        })?;
        if !document.contains_key("schema") {
            document.insert("schema", toml_edit::value(SCHEMA));
        }
        let form = || ModelError::Form { path: self.path.clone(), joint: joint.to_owned() };
        let writer = Writer { candidates: &self.candidates };
        writer.joint(document.as_table_mut(), joint, model, revision).ok_or_else(form)?;
        Self::parse(&document.to_string(), &self.path)
    }
}

/// Writes into a document; every function gives `None` where it is not of the form that a
/// model file has.
struct Writer<'a> {
    candidates: &'a [&'static dyn Effect],
}

impl Writer<'_> {
    fn joint(
        &self,
        document: &mut dyn TableLike,
        name: &str,
        model: &JointModel,
        revision: Option<&Revision>,
    ) -> Option<()> {
        let mut joints = Table::new();
        joints.set_implicit(true);
        let joints = or_new(document, "joint", joints)?.as_table_like_mut()?;
        let mut joint = Table::new();
        joint.insert("structure", toml_edit::value("integrator"));
        let joint = or_new(joints, name, joint)?.as_table_like_mut()?;
        let own = [("gain", model.gain), ("delay", model.delay)];
        write_parameters(joint, own.map(|(name, value)| (name, None, value.into())))?;
        self.effects(joint, model.components())?;
        match revision {
            Some(revision) => push(joint, "history", entry_of(revision)),
            None => Some(()),
        }
    }

    fn effects(&self, joint: &mut dyn TableLike, components: &[Component]) -> Option<()> {
        let mut entries = joint.get_mut("effect").map_or_else(|| Some(Vec::new()), entries)?;
        let places = self.places(&entries, components);
        let (kept, new) = components.split_at(places.len());
        let mut kept = kept.iter();
        for (place, entry) in entries.iter_mut().enumerate() {
            if places.contains(&place) {
                write_component(*entry, kept.next()?)?;
            }
        }
        if let Some(effects) = joint.get_mut("effect") {
            retain(effects, &places);
        }
        for component in new {
            let mut entry = self.header(component.effect());
            write_component(&mut entry, component)?;
            push(joint, "effect", entry)?;
        }
        if joint.get("effect").is_some_and(is_empty) {
            joint.remove("effect");
        }
        Some(())
    }

    /// The places in the file of the first components, in their order; those behind them
    /// have none.
    fn places(&self, entries: &[&mut dyn TableLike], components: &[Component]) -> Vec<usize> {
        let mut next = 0;
        let mut place = |component: &Component| {
            let wanted = self.header(component.effect());
            let is_it = |entry: &&mut dyn TableLike| has_all_of(*entry, &wanted);
            let place = next + entries.iter().skip(next).position(is_it)?;
            next = place + 1;
            Some(place)
        };
        components.iter().map_while(&mut place).collect()
    }

    /// What tells an effect of a joint from others.
    fn header(&self, effect: &'static dyn Effect) -> Table {
        let mut table = Table::new();
        let spec = effect.spec();
        let is_candidate = self.candidates.iter().any(|each| std::ptr::eq(each.spec(), spec));
        match effect.definition().filter(|_| !is_candidate) {
            None => insert_text(&mut table, "kind", spec.id),
            Some(Definition { id, summary, stage, expression, .. }) => {
                insert_text(&mut table, "kind", KIND);
                insert_text(&mut table, "id", id);
                if let Some(summary) = summary {
                    insert_text(&mut table, "summary", summary);
                }
                insert_text(&mut table, "stage", stage.id());
                insert_text(&mut table, "expression", expression);
            }
        }
        table
    }
}

fn insert_text(table: &mut Table, key: &str, text: &str) {
    table.insert(key, toml_edit::value(text));
}

fn has_all_of(entry: &dyn TableLike, wanted: &Table) -> bool {
    wanted
        .iter()
        .all(|(key, value)| entry.get(key).is_some_and(|own| own.as_str() == value.as_str()))
}

fn entry_of(revision: &Revision) -> Table {
    let Revision { revision, added, removed, validation_rmse } = revision;
    let mut table = Table::new();
    table.insert("revision", toml_edit::value(i64::from(*revision)));
    for (key, id) in [("added", added), ("removed", removed)] {
        if let Some(id) = id {
            insert_text(&mut table, key, id);
        }
    }
    if let Some(rmse) = validation_rmse {
        table.insert("validation_rmse", Item::Value(number(*rmse)));
    }
    table
}

/// What stands under `key`, or `new`.
fn or_new<'t>(table: &'t mut dyn TableLike, key: &str, new: Table) -> Option<&'t mut Item> {
    if !table.contains_key(key) {
        table.insert(key, Item::Table(new));
    }
    table.get_mut(key)
}

/// Several tables, each under its own header or all in brackets.
fn entries(item: &mut Item) -> Option<Vec<&mut dyn TableLike>> {
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

/// Drops all entries but those at `places`.
fn retain(item: &mut Item, places: &[usize]) {
    let mut place = 0;
    let mut is_kept = || {
        place += 1;
        places.contains(&(place - 1))
    };
    match item {
        Item::ArrayOfTables(tables) => tables.retain(|_| is_kept()),
        Item::Value(toml_edit::Value::Array(array)) => array.retain(|_| is_kept()),
        _ => (),
    }
}

fn is_empty(item: &Item) -> bool {
    item.as_array_of_tables().is_some_and(ArrayOfTables::is_empty)
        || item.as_array().is_some_and(Array::is_empty)
}

/// Adds an entry in the form that the others have, behind an empty line if they are.
fn push(table: &mut dyn TableLike, key: &str, mut entry: Table) -> Option<()> {
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

fn write_component(entry: &mut dyn TableLike, component: &Component) -> Option<()> {
    let effect = component.effect();
    // Where the file refers to a definition, the limits of the definition stand there.
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

/// A parameter as it stands in a file.
#[derive(Clone, Debug)]
struct Written {
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

    /// Replaces what stands in `item` where it says something else.
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
fn write_parameters<'a>(
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

fn write_number(table: &mut dyn TableLike, key: &str, value: Option<f64>) {
    let is_same = match (table.get(key), value) {
        (Some(item), Some(value)) => is_number(item, value),
        (found, value) => found.is_none() && value.is_none(),
    };
    if !is_same {
        write(table, key, value.map(number));
    }
}

/// Puts a value under `key`, or takes away what stands there.
fn write(table: &mut dyn TableLike, key: &str, value: Option<toml_edit::Value>) {
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
fn set(item: &mut Item, mut value: toml_edit::Value) {
    if let Some(old) = item.as_value() {
        *value.decor_mut() = old.decor().clone();
    }
    *item = Item::Value(value);
}

fn is_number(item: &Item, value: f64) -> bool {
    let found = item.as_float().or_else(|| item.as_integer().map(|whole| whole as f64));
    found.is_some_and(|found| same(found, value))
}

fn same(a: f64, b: f64) -> bool {
    a.to_bits() == b.to_bits()
}

/// A number with as many digits as it takes to read the same one; large and small ones as
/// `1e-12`.
fn number(value: f64) -> toml_edit::Value {
    format!("{value:?}").parse().unwrap_or_else(|_| value.into())
}
