//! Models written back into the text they came from.
//!
//! What a user wrote stays as it is: comments, order, how a number is written that has not
//! changed. Only what the model says otherwise is replaced.

use toml_edit::{DocumentMut, InlineTable, Item, Table, TableLike};

use super::edit::{entries, is_empty, or_new, push, retain, set_text};
use super::error::Place;
use super::fitted::insert_errors;
use super::parameter::{write_component, write_parameters};
use super::schema::SCHEMA;
use super::{Fitted, ModelError, ModelFile, Revision};
use crate::effect::expression::KIND;
use crate::effect::{Definition, Effect, OwnState};
use crate::model::{Component, JointModel};

impl ModelFile {
    /// This file with `model` for `joint`, whose history goes on with `revision`.
    ///
    /// Values are replaced in place. Effects that the model no longer has go, with the
    /// comments above them; those that it has beyond the file's come after the others. A
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
    /// use tauscope::model::{Component, ModelFile, Revision, RevisionErrors};
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
    /// let errors = RevisionErrors { validation_rmse: Some(0.06), ..<_>::default() };
    /// let revision = Revision { revision: 1, added, errors, ..<_>::default() };
    ///
    /// let after = r#"[[joint.boom.effect]]
    /// kind = "dead_band"
    /// parameters = { lower = -0.6, upper = 0.6 }
    /// [[joint.boom.history]]
    /// revision = 1
    /// added = "dead_band"
    /// validation_rmse = 0.06
    /// "#;
    /// assert_eq!(file.revised("boom", &banded, &revision)?.text(), text.to_owned() + after);
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

    /// This file with what the numbers of `joint` were fitted to, in the place of what it said of
    /// that.
    ///
    /// # Errors
    /// [`ModelError`] when it has no such joint.
    pub fn fitted_to(&self, joint: &str, fitted: &Fitted) -> Result<Self, ModelError> {
        self.edited(joint, |document| {
            let joints = document.get_mut("joint")?.as_table_like_mut()?;
            let joint = joints.get_mut(joint)?;
            let table = fitted.table();
            let inline = joint.is_inline_table();
            let item = if inline {
                toml_edit::value(table.into_inline_table())
            } else {
                Item::Table(table)
            };
            joint.as_table_like_mut()?.insert("fitted", item);
            Some(())
        })
    }

    /// A file that knows the effects of this one, and has no joint yet.
    pub(crate) fn emptied(&self) -> Self {
        let candidates = self.candidates.clone();
        let mut empty = Self::new(&self.path);
        (empty.others, empty.candidates) = (candidates.clone(), candidates);
        empty
    }

    /// This file with the joints of `files`, which were [empty](Self::emptied) and have one each that
    /// is not in this one: to revise this one for each of them would read it again each time.
    ///
    /// # Errors
    /// As [`revised`](Self::revised).
    pub(crate) fn joined(&self, files: &[Self]) -> Result<Self, ModelError> {
        let mut text = self.text.clone();
        for file in files {
            match file.text.split_once('\n') {
                Some((_, joint)) if !text.is_empty() => {
                    text.extend(Some('\n').filter(|_| !text.ends_with('\n')));
                    text += joint;
                }
                _ => text += &file.text,
            }
        }
        Self::parse_with(&text, &self.path, &self.others)
    }

    fn rewritten(
        &self,
        joint: &str,
        model: &JointModel,
        revision: Option<&Revision>,
    ) -> Result<Self, ModelError> {
        let writer = Writer { candidates: &self.candidates };
        self.edited(joint, |document| writer.joint(document, joint, model, revision))
    }

    /// This file after an `edit` about `joint`, which gives `None` where the document is not of the
    /// form that a model file has.
    fn edited(
        &self,
        joint: &str,
        edit: impl FnOnce(&mut Table) -> Option<()>,
    ) -> Result<Self, ModelError> {
        let place = Place::file(&self.path);
        let mut document: DocumentMut =
            self.text.parse().map_err(|error| place.error_from("cannot be revised", error))?;
        if !document.contains_key("schema") {
            document.insert("schema", toml_edit::value(SCHEMA));
        }
        edit(document.as_table_mut()).ok_or_else(|| {
            Place::joint(&self.path, joint)
                .error(format!("cannot be revised as it is written; write it as `[joint.{joint}]`"))
        })?;
        Self::parse_with(&document.to_string(), &self.path, &self.others)
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
        let known = self.indices(&entries, components);
        let (kept, new) = components.split_at(known.len());
        let mut kept = kept.iter();
        for (index, entry) in entries.iter_mut().enumerate() {
            if known.contains(&index) {
                write_component(*entry, kept.next()?)?;
            }
        }
        if let Some(effects) = joint.get_mut("effect") {
            retain(effects, &known);
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

    /// The indices in the file of the first components, in their order; those after them
    /// are not in it.
    fn indices(&self, entries: &[&mut dyn TableLike], components: &[Component]) -> Vec<usize> {
        let mut next = 0;
        let mut index_of = |component: &Component| {
            let wanted = self.header(component.effect());
            let is_it = |entry: &&mut dyn TableLike| has_all_of(*entry, &wanted);
            let index = next + entries.iter().skip(next).position(is_it)?;
            next = index + 1;
            Some(index)
        };
        components.iter().map_while(&mut index_of).collect()
    }

    /// The keys by which an effect of a joint is recognised.
    fn header(&self, effect: &'static dyn Effect) -> Table {
        let mut table = Table::new();
        let spec = effect.spec();
        let is_candidate = self.candidates.iter().any(|each| std::ptr::eq(each.spec(), spec));
        match effect.definition().filter(|_| !is_candidate) {
            None => set_text(&mut table, "kind", spec.id),
            Some(Definition { id, summary, stage, expression, states, .. }) => {
                set_text(&mut table, "kind", KIND);
                set_text(&mut table, "id", id);
                if let Some(summary) = summary {
                    set_text(&mut table, "summary", summary);
                }
                set_text(&mut table, "stage", stage.id());
                set_text(&mut table, "expression", expression);
                if !states.is_empty() {
                    table.insert("states", toml_edit::value(states_table(states)));
                }
            }
        }
        table
    }
}

/// The states of a definition, as they are written.
fn states_table(states: &[OwnState]) -> InlineTable {
    let table = |OwnState { name, start, next }: &OwnState| {
        let fields = [("start", start.as_str()), ("next", next.as_str())];
        (name.clone(), fields.into_iter().collect::<InlineTable>())
    };
    states.iter().map(table).collect()
}

fn has_all_of(entry: &dyn TableLike, wanted: &Table) -> bool {
    wanted
        .iter()
        .all(|(key, value)| entry.get(key).is_some_and(|own| own.as_str() == value.as_str()))
}

fn entry_of(revision: &Revision) -> Table {
    let Revision { revision, added, removed, errors } = revision;
    let mut table = Table::new();
    table.insert("revision", toml_edit::value(i64::from(*revision)));
    for (key, id) in [("added", added), ("removed", removed)] {
        if let Some(id) = id {
            set_text(&mut table, key, id);
        }
    }
    insert_errors(&mut table, errors);
    table
}
