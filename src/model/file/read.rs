//! From the tables of a file to models.

use std::path::Path;

use super::ModelError;
use super::schema::{EffectToml, JointToml, Parameters, TableToml};
use crate::effect::expression;
use crate::effect::{self, Definition, Effect, OwnParameter};
use crate::model::{Component, JointModel, Value};

/// The most effects of a joint, and the most candidates of a file: twice the catalogue. Reading them
/// takes time with their square, and a fit with the cube of their parameters.
const MOST_EFFECTS: usize = 2 * effect::REGISTRY.len();

/// The most characters of all expressions of a joint, and of the candidates of a file: each of them
/// is computed at each step of time of each simulation of a fit.
const MOST_CHARACTERS: usize = 4000;

/// The effects of whoever reads a file, and those that it offers, in its order.
pub(super) fn candidates(
    path: &Path,
    others: &[&'static dyn Effect],
    given: Vec<EffectToml>,
) -> Result<Vec<&'static dyn Effect>, ModelError> {
    check_size(path, || "candidates".to_owned(), &given)?;
    let mut candidates = others.to_vec();
    for given in given {
        let own = Own { path, place: "candidate".to_owned() };
        let effect = own.define(&given, Start::Given)?;
        own.check_unique(&candidates, effect.spec().id)?;
        candidates.push(effect);
    }
    Ok(candidates)
}

fn check_size(
    path: &Path,
    place: impl FnOnce() -> String,
    effects: &[EffectToml],
) -> Result<(), ModelError> {
    let count = effects.len();
    let characters: usize = effects.iter().map(EffectToml::characters).sum();
    let problem = match (count > MOST_EFFECTS, characters > MOST_CHARACTERS) {
        (false, false) => return Ok(()),
        (true, _) => format!("{count} effects; {MOST_EFFECTS} are the most"),
        (false, true) => {
            format!("{characters} characters of expressions; {MOST_CHARACTERS} are the most")
        }
    };
    Err(ModelError::TooLarge { path: path.to_owned(), place: place(), problem })
}

/// Where the start values of a definition come from.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Start {
    /// From the values in it: it is not part of a model yet.
    Given,
    /// From the model that it is a part of, whose values are not part of the definition:
    /// it stays the same effect when they change.
    InModel,
}

/// An effect of a file's own, for messages.
struct Own<'a> {
    path: &'a Path,
    place: String,
}

impl Own<'_> {
    fn error(&self, effect: &str, problem: &str) -> ModelError {
        let (path, place) = (self.path.to_owned(), self.place.clone());
        ModelError::Effect { path, place, effect: effect.to_owned(), problem: problem.to_owned() }
    }

    fn check_unique(&self, others: &[&'static dyn Effect], id: &str) -> Result<(), ModelError> {
        if others.iter().any(|other| other.spec().id == id) {
            return Err(self.error(id, "has an id that another one has; rename one of them"));
        }
        Ok(())
    }

    fn define(&self, given: &EffectToml, start: Start) -> Result<&'static dyn Effect, ModelError> {
        if given.kind != expression::KIND {
            let problem = "is not of this file: a candidate has kind = \"expression\"; those of \
                           the catalogue are candidates anyway";
            return Err(self.error(&given.kind, problem));
        }
        let id = given.id.clone().ok_or_else(|| {
            self.error(&given.kind, "has no `id`: give it a name, as in id = \"knee\"")
        })?;
        let stage = given.stage.ok_or_else(|| {
            let known = "has no `stage`: input, transport, dynamics, load or output";
            self.error(&id, known)
        })?;
        let expression = given.expression.clone().ok_or_else(|| {
            self.error(&id, "has no `expression`, as in expression = \"signal + 0.1\"")
        })?;
        let parameters = given.parameters.iter().map(|(name, parameter)| {
            let given = parameter.table();
            own_parameter(name, given, start)
        });
        let (summary, parameters) = (given.summary.clone(), parameters.collect());
        let states = given.states.iter().map(|(name, state)| state.of_name(name)).collect();
        let defined = expression::define(Definition {
            id: id.clone(),
            summary,
            stage,
            expression,
            states,
            parameters,
        });
        defined.map_err(|source| {
            let (path, place) = (self.path.to_owned(), self.place.clone());
            ModelError::Definition { path, place, effect: id, source: Box::new(source) }
        })
    }
}

fn own_parameter(name: &str, given: TableToml, start: Start) -> OwnParameter {
    let TableToml { value, fixed, min, max, neutral, dimension } = given;
    let is_given = start == Start::Given;
    OwnParameter {
        name: name.to_owned(),
        start: value.filter(|_| is_given),
        min,
        max,
        neutral,
        fixed: fixed && is_given,
        dimension: dimension.unwrap_or_default(),
    }
}

/// A joint of a file, for messages.
pub(super) struct JointReader<'a> {
    pub(super) path: &'a Path,
    pub(super) joint: &'a str,
    pub(super) candidates: &'a [&'static dyn Effect],
}

impl JointReader<'_> {
    pub(super) fn joint(&self, joint: &JointToml) -> Result<JointModel, ModelError> {
        if joint.structure != "integrator" {
            let (path, name) = (self.path.to_owned(), self.joint.to_owned());
            let found = joint.structure.clone();
            return Err(ModelError::Structure { path, joint: name, found });
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
        check_size(self.path, || format!("joint `{}`", self.joint), &joint.effect)?;
        for given in &joint.effect {
            let before: Vec<_> = model.components().iter().map(Component::effect).collect();
            model = model.with(self.component(given, &before)?);
        }
        Ok(model)
    }

    fn own(&self) -> Own<'_> {
        Own { path: self.path, place: format!("joint `{}`", self.joint) }
    }

    /// An effect of the joint, which has those `before` it.
    fn component(
        &self,
        given: &EffectToml,
        before: &[&'static dyn Effect],
    ) -> Result<Component, ModelError> {
        let effect = if given.kind == expression::KIND {
            self.own_effect(given, before)?
        } else {
            self.known_effect(given)?
        };
        let parameters = effect.spec().parameters;
        let bounds: Vec<_> = parameters.iter().map(|p| (p.name, p.min, p.max)).collect();
        let mut values = self.values(effect.spec().id, &bounds, &given.parameters)?;
        if given.kind == expression::KIND {
            // Its limits are those of the effect itself.
            for value in values.iter_mut().flatten() {
                (value.min, value.max) = (None, None);
            }
        }
        let or_neutral = values.iter().zip(parameters).map(|(v, p)| v.unwrap_or(p.neutral.into()));
        let component =
            Component::new(effect, or_neutral.collect()).unwrap_or(Component::neutral(effect));
        let parameters: Vec<f64> = component.parameters().iter().map(|value| value.value).collect();
        match effect.fault(&parameters) {
            Some(fault) => Err(self.own().error(effect.spec().id, fault)),
            None => Ok(component),
        }
    }

    fn own_effect(
        &self,
        given: &EffectToml,
        before: &[&'static dyn Effect],
    ) -> Result<&'static dyn Effect, ModelError> {
        let effect = self.own().define(given, Start::InModel)?;
        let id = effect.spec().id;
        if self.candidates.iter().any(|candidate| candidate.spec().id == id) {
            let problem = format!("is a candidate; write kind = \"{id}\", or rename one of them");
            return Err(self.own().error(id, &problem));
        }
        self.own().check_unique(before, id)?;
        Ok(effect)
    }

    /// The effect of the catalogue, or the candidate, of this kind.
    fn known_effect(&self, given: &EffectToml) -> Result<&'static dyn Effect, ModelError> {
        let EffectToml { kind, id, summary, stage, expression, states, parameters } = given;
        let is_defined = id.is_some() || summary.is_some() || stage.is_some() || !states.is_empty();
        if is_defined || expression.is_some() {
            let problem = "has a definition already: `id`, `summary`, `stage`, `expression` and \
                           `states` belong to kind = \"expression\"";
            return Err(self.own().error(kind, problem));
        }
        let is_own = |given: TableToml| given.neutral.is_some() || given.dimension.is_some();
        for (name, parameter) in parameters {
            let problem = if is_own(parameter.table()) {
                "has a definition already: `neutral` and `dimension` belong to kind = \
                 \"expression\""
                    .to_owned()
            } else if parameter.table().value.is_none() {
                format!("has no `value` for its parameter `{name}`")
            } else {
                continue;
            };
            return Err(self.own().error(kind, &problem));
        }
        let unknown = |source| ModelError::UnknownEffect {
            path: self.path.to_owned(),
            joint: self.joint.to_owned(),
            source,
        };
        effect::find_among(kind, self.candidates).map_err(unknown)
    }

    /// The given values in the order of `known` (name, lowest, highest).
    fn values(
        &self,
        owner: &str,
        known: &[(&str, f64, f64)],
        given: &Parameters,
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
            let value = given.get(*name).and_then(|parameter| parameter.table().given());
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
        // A limit that is no number is none of the two, and holds no value.
        let tighter = |given: f64, own: f64, tighter: fn(f64, f64) -> f64| {
            if given.is_nan() { given } else { tighter(given, own) }
        };
        let min = value.min.map_or(own.0, |min| tighter(min, own.0, f64::max));
        let max = value.max.map_or(own.1, |max| tighter(max, own.1, f64::min));
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
