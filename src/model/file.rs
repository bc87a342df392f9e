//! Models as users write them: TOML, schema `tauscope/model/1`.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use serde::Deserialize;

use super::{Component, JointModel, Value};
use crate::effect::{self, UnknownEffect};

/// The schema of a model file.
const SCHEMA: &str = "tauscope/model/1";

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
#[derive(Clone, Debug, Default)]
pub struct ModelFile {
    joints: BTreeMap<String, Revised>,
}

/// A model and the number of its revision.
#[derive(Clone, Debug)]
struct Revised {
    model: JointModel,
    revision: u32,
}

/// Why a model file cannot be used.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ModelError {
    /// It cannot be opened or read.
    #[error("{}: cannot be read", path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// What the system said.
        source: std::io::Error,
    },
    /// It is not TOML, or has a key that is not known.
    #[error("{}: not a model file", path.display())]
    Parse {
        /// The file.
        path: PathBuf,
        /// Line, column and cause.
        source: Box<toml::de::Error>,
    },
    /// It is of another schema.
    #[error("{}: schema `{found}` is not known; expected `{SCHEMA}`", path.display())]
    Schema {
        /// The file.
        path: PathBuf,
        /// What it says.
        found: String,
    },
    /// A joint has a structure that is not known.
    #[error(
        "{}, joint `{joint}`: structure `{found}` is not known; expected `integrator`",
        path.display()
    )]
    Structure {
        /// The file.
        path: PathBuf,
        /// The joint.
        joint: String,
        /// What it says.
        found: String,
    },
    /// An effect is not in the catalogue.
    #[error("{}, joint `{joint}`: `tauscope effects` lists the catalogue", path.display())]
    UnknownEffect {
        /// The file.
        path: PathBuf,
        /// The joint.
        joint: String,
        /// Its name, and the nearest one.
        source: UnknownEffect,
    },
    /// A parameter does not belong to its effect.
    #[error(
        "{}, joint `{joint}`: `{owner}` has no parameter `{name}`; it has {known}", path.display()
    )]
    UnknownParameter {
        /// The file.
        path: PathBuf,
        /// The joint.
        joint: String,
        /// The effect, or the structure.
        owner: String,
        /// What it says.
        name: String,
        /// The parameters there are.
        known: String,
    },
    /// A parameter of the structure is missing.
    #[error("{}, joint `{joint}`: parameter `{name}` is missing", path.display())]
    MissingParameter {
        /// The file.
        path: PathBuf,
        /// The joint.
        joint: String,
        /// The parameter.
        name: &'static str,
    },
    /// A value is not finite, or lies outside its bounds.
    #[error(
        "{}, joint `{joint}`: `{owner}.{name}` = {value} is not between {min} and {max}",
        path.display()
    )]
    OutOfBounds {
        /// The file.
        path: PathBuf,
        /// The joint.
        joint: String,
        /// The effect, or the structure.
        owner: String,
        /// The parameter.
        name: String,
        /// What it says.
        value: f64,
        /// Lowest value.
        min: f64,
        /// Highest value.
        max: f64,
    },
}

impl ModelFile {
    /// Reads a model file.
    ///
    /// # Errors
    /// [`ModelError`], with the file and, where there is one, the joint.
    pub fn read(path: &Path) -> Result<Self, ModelError> {
        let text = std::fs::read_to_string(path)
            .map_err(|source| ModelError::Read { path: path.to_owned(), source })?;
        Self::parse(&text, path)
    }

    /// Reads the text of a model file; `path` is its name in messages.
    ///
    /// # Errors
    /// As [`read`](Self::read).
    pub fn parse(text: &str, path: &Path) -> Result<Self, ModelError> {
        let file: FileToml = toml::from_str(text)
            .map_err(|e| ModelError::Parse { path: path.to_owned(), source: Box::new(e) })?;
        if file.schema != SCHEMA {
            return Err(ModelError::Schema { path: path.to_owned(), found: file.schema });
        }
        let mut joints = BTreeMap::new();
        for (name, joint) in file.joint {
            let place = Place { path, joint: &name };
            let revision = joint.history.iter().map(|entry| entry.revision).max().unwrap_or(0);
            let model = place.joint(joint)?;
            joints.insert(name, Revised { model, revision });
        }
        Ok(Self { joints })
    }

    /// The model of `joint`.
    pub fn joint(&self, joint: &str) -> Option<&JointModel> {
        self.joints.get(joint).map(|revised| &revised.model)
    }

    /// The number of its last revision; 0 for one that was never revised.
    pub fn revision(&self, joint: &str) -> Option<u32> {
        self.joints.get(joint).map(|revised| revised.revision)
    }

    /// Names of the joints, in order.
    pub fn names(&self) -> impl Iterator<Item = &str> {
        self.joints.keys().map(String::as_str)
    }
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct FileToml {
    schema: String,
    #[serde(default)]
    joint: BTreeMap<String, JointToml>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct JointToml {
    structure: String,
    parameters: BTreeMap<String, ValueToml>,
    #[serde(default)]
    effect: Vec<EffectToml>,
    #[serde(default)]
    history: Vec<HistoryToml>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct EffectToml {
    kind: String,
    #[serde(default)]
    parameters: BTreeMap<String, ValueToml>,
}

#[derive(Deserialize)]
struct HistoryToml {
    revision: u32,
}

#[derive(Clone, Copy, Deserialize)]
#[serde(untagged)]
enum ValueToml {
    Plain(f64),
    Whole(i64),
    Bounded(BoundedToml),
}

#[derive(Clone, Copy, Deserialize)]
#[serde(deny_unknown_fields)]
struct BoundedToml {
    value: f64,
    #[serde(default)]
    fixed: bool,
    min: Option<f64>,
    max: Option<f64>,
}

impl From<ValueToml> for Value {
    fn from(value: ValueToml) -> Self {
        match value {
            ValueToml::Plain(value) => Self::from(value),
            ValueToml::Whole(value) => Self::from(value as f64),
            ValueToml::Bounded(BoundedToml { value, fixed, min, max }) => {
                Self { value, fixed, min, max }
            }
        }
    }
}

/// A joint of a file, for messages.
struct Place<'a> {
    path: &'a Path,
    joint: &'a str,
}

impl Place<'_> {
    fn joint(&self, joint: JointToml) -> Result<JointModel, ModelError> {
        if joint.structure != "integrator" {
            let (path, name) = (self.path.to_owned(), self.joint.to_owned());
            return Err(ModelError::Structure { path, joint: name, found: joint.structure });
        }
        let own = [("gain", f64::MIN, f64::MAX), ("delay", 0.0, f64::MAX)];
        let given = self.values("integrator", &own, &joint.parameters)?;
        let needed = |index: usize, name| {
            let (path, joint) = (self.path.to_owned(), self.joint.to_owned());
            let value = given.get(index).copied().flatten();
            value.ok_or(ModelError::MissingParameter { path, joint, name })
        };
        let mut model = JointModel::integrator(0.0, 0.0);
        (model.gain, model.delay) = (needed(0, "gain")?, needed(1, "delay")?);
        for effect in joint.effect {
            model = model.with(self.component(&effect)?);
        }
        Ok(model)
    }

    fn component(&self, given: &EffectToml) -> Result<Component, ModelError> {
        let unknown = |source| ModelError::UnknownEffect {
            path: self.path.to_owned(),
            joint: self.joint.to_owned(),
            source,
        };
        let effect = effect::find(&given.kind).map_err(unknown)?;
        let parameters = effect.spec().parameters;
        let bounds: Vec<_> = parameters.iter().map(|p| (p.name, p.min, p.max)).collect();
        let values = self.values(&given.kind, &bounds, &given.parameters)?;
        let or_neutral = values.iter().zip(parameters).map(|(v, p)| v.unwrap_or(p.neutral.into()));
        Ok(Component::new(effect, or_neutral.collect()).unwrap_or(Component::neutral(effect)))
    }

    /// The given values in the order of `known` (name, lowest, highest).
    fn values(
        &self,
        owner: &str,
        known: &[(&str, f64, f64)],
        given: &BTreeMap<String, ValueToml>,
    ) -> Result<Vec<Option<Value>>, ModelError> {
        let is_known = |name: &str| known.iter().any(|(known, _, _)| *known == name);
        if let Some(name) = given.keys().find(|name| !is_known(name)) {
            let names: Vec<_> = known.iter().map(|(name, _, _)| *name).collect();
            return Err(ModelError::UnknownParameter {
                path: self.path.to_owned(),
                joint: self.joint.to_owned(),
                owner: owner.to_owned(),
                name: name.clone(),
                known: names.join(", "),
            });
        }
        let value = |(name, min, max): &(&str, f64, f64)| {
            let value = given.get(*name).copied().map(Value::from);
            value.map(|value| self.inside(owner, name, (*min, *max), value)).transpose()
        };
        known.iter().map(value).collect()
    }

    fn inside(
        &self,
        owner: &str,
        name: &str,
        own: (f64, f64),
        value: Value,
    ) -> Result<Value, ModelError> {
        let min = value.min.map_or(own.0, |min| min.max(own.0));
        let max = value.max.map_or(own.1, |max| max.min(own.1));
        if (min..=max).contains(&value.value) {
            return Ok(value);
        }
        Err(ModelError::OutOfBounds {
            path: self.path.to_owned(),
            joint: self.joint.to_owned(),
            owner: owner.to_owned(),
            name: name.to_owned(),
            value: value.value,
            min,
            max,
        })
    }
}
