//! The tables of a model file, as TOML.

use std::collections::BTreeMap;

use serde::de::Error as _;
use serde::{Deserialize, Deserializer};

use super::{Fitted, Revision};
use crate::effect::{Dimension, OwnState, Stage};
use crate::model::Value;

/// The schema of a model file.
pub(super) const SCHEMA: &str = "tauscope/model/1";

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct FileToml {
    pub(super) schema: String,
    #[serde(default)]
    pub(super) candidate: Vec<EffectToml>,
    #[serde(default)]
    pub(super) joint: BTreeMap<String, JointToml>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct JointToml {
    pub(super) structure: String,
    pub(super) parameters: Parameters,
    #[serde(default)]
    pub(super) effect: Vec<EffectToml>,
    #[serde(default)]
    pub(super) history: Vec<Revision>,
    pub(super) fitted: Option<Fitted>,
}

pub(super) type Parameters = BTreeMap<String, ParameterToml>;

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct EffectToml {
    pub(super) kind: String,
    /// This and the next four are for expressions only.
    pub(super) id: Option<String>,
    pub(super) summary: Option<String>,
    #[serde(default, deserialize_with = "stage")]
    pub(super) stage: Option<Stage>,
    pub(super) expression: Option<String>,
    #[serde(default)]
    pub(super) states: BTreeMap<String, StateToml>,
    #[serde(default)]
    pub(super) parameters: Parameters,
}

/// A state of an expression: what it is next, and where it starts.
#[derive(Clone, Deserialize)]
#[serde(
    untagged,
    expecting = "expected an expression, or a table like { start = \"signal\", next = \"…\" }"
)]
pub(super) enum StateToml {
    Next(String),
    Table { start: String, next: String },
}

impl StateToml {
    pub(super) fn of_name(&self, name: &str) -> OwnState {
        match self {
            Self::Next(next) => OwnState::new(name, next),
            Self::Table { start, next } => {
                OwnState { start: start.clone(), ..OwnState::new(name, next) }
            }
        }
    }
}

impl EffectToml {
    /// The characters of its expressions.
    pub(super) fn characters(&self) -> usize {
        let states = self.states.values().map(|state| match state {
            StateToml::Next(next) => next.len(),
            StateToml::Table { start, next } => start.len() + next.len(),
        });
        self.expression.as_ref().map_or(0, String::len) + states.sum::<usize>()
    }
}

#[derive(Clone, Copy, Deserialize)]
#[serde(untagged, expecting = "expected a number, or a table like { value = 0.5, min = 0.0 }")]
pub(super) enum ParameterToml {
    Plain(f64),
    Whole(i64),
    Table(TableToml),
}

#[derive(Clone, Copy, Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct TableToml {
    pub(super) value: Option<f64>,
    #[serde(default)]
    pub(super) fixed: bool,
    pub(super) min: Option<f64>,
    pub(super) max: Option<f64>,
    /// This and the next are for expressions only.
    pub(super) neutral: Option<f64>,
    #[serde(default, deserialize_with = "dimension")]
    pub(super) dimension: Option<Dimension>,
}

impl ParameterToml {
    pub(super) fn table(self) -> TableToml {
        match self {
            Self::Plain(value) => TableToml { value: Some(value), ..TableToml::default() },
            Self::Whole(value) => TableToml { value: Some(value as f64), ..TableToml::default() },
            Self::Table(table) => table,
        }
    }
}

impl TableToml {
    /// The value in a model, where one is given.
    pub(super) fn given(self) -> Option<Value> {
        let Self { value, fixed, min, max, .. } = self;
        value.map(|value| Value { value, fixed, min, max })
    }
}

fn stage<'d, D: Deserializer<'d>>(deserializer: D) -> Result<Option<Stage>, D::Error> {
    named(deserializer, &Stage::ALL, Stage::id).map(Some)
}

fn dimension<'d, D: Deserializer<'d>>(deserializer: D) -> Result<Option<Dimension>, D::Error> {
    named(deserializer, &Dimension::ALL, Dimension::id).map(Some)
}

/// The one of `all` whose id is written.
fn named<'d, D: Deserializer<'d>, T: Copy>(
    deserializer: D,
    all: &[T],
    id: fn(T) -> &'static str,
) -> Result<T, D::Error> {
    let found = String::deserialize(deserializer)?;
    let is_it = |known: &&T| id(**known) == found;
    all.iter().find(is_it).copied().ok_or_else(|| {
        let known: Vec<_> = all.iter().map(|known| format!("`{}`", id(*known))).collect();
        let known = known.join(", ");
        D::Error::custom(format_args!("unknown variant `{found}`, expected one of {known}"))
    })
}
