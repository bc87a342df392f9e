//! A model file: its text, and the models in it.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use super::error::Place;
use super::read::{self, JointReader};
use super::schema::{FileToml, JointToml, SCHEMA};
use super::{Fitted, ModelError, Revision};
use crate::effect::Effect;
use crate::experiment::{Joint, read_text};
use crate::model::JointModel;

/// The models of several joints, read from a file.
///
/// ```toml
/// schema = "tauscope/model/1"
/// [joint.boom]
/// structure = "integrator"
/// parameters = { gain = 11.9, delay = { value = 0.15, min = 0.0, max = 1.0 } }
/// [[joint.boom.effect]]
/// kind = "dead_band"
/// parameters = { lower = -0.6, upper = 0.6 }
/// ```
///
/// It keeps its text, so that a [revision](Self::revised) leaves as it is whatever a user
/// wrote.
#[derive(Clone, Debug, Default)]
pub struct ModelFile {
    pub(super) path: PathBuf,
    pub(super) text: String,
    /// Effects of whoever reads the file.
    pub(super) others: Vec<&'static dyn Effect>,
    pub(super) candidates: Vec<&'static dyn Effect>,
    joints: BTreeMap<String, Revised>,
}

/// A model and how it came about.
#[derive(Clone, Debug)]
struct Revised {
    model: JointModel,
    history: Vec<Revision>,
    fitted: Option<Fitted>,
}

impl ModelFile {
    /// Reads a model file.
    ///
    /// # Errors
    /// [`ModelError`], with the file and, where there is one, the joint.
    pub fn read(path: &Path) -> Result<Self, ModelError> {
        Self::read_with(path, &[])
    }

    /// Reads a model file that may name the effects `others` like those of the catalogue.
    ///
    /// # Errors
    /// As [`read`](Self::read).
    pub(crate) fn read_with(
        path: &Path,
        others: &[&'static dyn Effect],
    ) -> Result<Self, ModelError> {
        let text =
            read_text(path).map_err(|e| Place::file(path).error_from("cannot be read", e))?;
        Self::parse_with(&text, path, others)
    }

    /// Reads the text of a model file; `path` is its name in messages.
    ///
    /// # Errors
    /// As [`read`](Self::read).
    pub fn parse(text: &str, path: &Path) -> Result<Self, ModelError> {
        Self::parse_with(text, path, &[])
    }

    /// Reads the text of a model file that may name the effects `others` like those of the
    /// catalogue. They are [candidates](Self::candidates), too.
    ///
    /// # Errors
    /// As [`read`](Self::read).
    pub fn parse_with(
        text: &str,
        path: &Path,
        others: &[&'static dyn Effect],
    ) -> Result<Self, ModelError> {
        let file: FileToml = toml::from_str(text)
            .map_err(|e| Place::file(path).error_from("not a model file", e))?;
        if file.schema != SCHEMA {
            let problem = format!("schema `{}` is not known; expected `{SCHEMA}`", file.schema);
            return Err(Place::file(path).error(problem));
        }
        let candidates = read::candidates(path, others, file.candidate)?;
        let mut joints = BTreeMap::new();
        for (name, joint) in file.joint {
            let reader = JointReader { place: Place::joint(path, &name), candidates: &candidates };
            let model = reader.joint(&joint)?;
            let JointToml { history, fitted, .. } = joint;
            joints.insert(name, Revised { model, history, fitted });
        }
        let (path, text, others) = (path.to_owned(), text.to_owned(), others.to_owned());
        Ok(Self { path, text, others, candidates, joints })
    }

    /// One without joints, which has this name in messages.
    pub fn new(path: &Path) -> Self {
        Self { path: path.to_owned(), ..Self::default() }
    }

    /// Its text, to be written.
    pub fn text(&self) -> &str {
        &self.text
    }

    /// The effects that there are besides those of the catalogue: those of whoever read it, and
    /// those that it offers.
    pub fn candidates(&self) -> &[&'static dyn Effect] {
        &self.candidates
    }

    /// The model of `joint`.
    pub fn joint(&self, joint: &str) -> Option<&JointModel> {
        self.joints.get(joint).map(|revised| &revised.model)
    }

    /// The number of its last revision; 0 for one that was never revised.
    pub fn revision(&self, joint: &str) -> Option<u32> {
        let revised = self.joints.get(joint)?;
        Some(revised.history.iter().map(|entry| entry.revision).max().unwrap_or(0))
    }

    /// Its revisions, in the order of the file.
    pub fn history(&self, joint: &str) -> &[Revision] {
        self.joints.get(joint).map_or(&[], |revised| revised.history.as_slice())
    }

    /// What its numbers were fitted to; none of a model that was written by hand.
    pub fn fitted(&self, joint: &str) -> Option<&Fitted> {
        self.joints.get(joint)?.fitted.as_ref()
    }

    /// Checks that `joint` was logged in the units in which its model was fitted, where both say them.
    ///
    /// # Errors
    /// [`ModelError`] with both: numbers of a model mean nothing in other units.
    pub fn check_units(&self, joint: &Joint) -> Result<(), ModelError> {
        let Some(fitted) = self.fitted(&joint.name) else { return Ok(()) };
        let pairs = [
            ("input", &fitted.input_unit, &joint.input_unit),
            ("output", &fitted.output_unit, &joint.output_unit),
        ];
        for (signal, of_model, of_log) in pairs {
            if let Some((of_model, of_log)) = of_model.as_ref().zip(of_log.as_ref())
                && of_model != of_log
            {
                return Err(Place::joint(&self.path, &joint.name).error(format!(
                    "its {signal} was in {of_model} when it was fitted, and is in {of_log} in the \
                     log; convert that column, or fit a model to this log without `--model`"
                )));
            }
        }
        Ok(())
    }

    /// Whether an error was left that no effect accounts for when the model of `joint` was fitted: what
    /// it predicts may be far off.
    pub fn is_unexplained(&self, joint: &str) -> bool {
        let verdict = self.fitted(joint).and_then(|fitted| fitted.verdict.as_deref());
        verdict == Some("unexplained")
    }

    /// Names of the joints, in order.
    pub fn names(&self) -> impl Iterator<Item = &str> {
        self.joints.keys().map(String::as_str)
    }
}
