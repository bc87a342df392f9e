//! From the tables of a file to models.

use std::path::Path;

use super::ModelError;
use super::error::Place;
use super::schema::{EffectToml, JointToml, Parameters, TableToml};
use crate::effect::expression;
use crate::effect::{self, Definition, Effect, OwnParameter, UNLIMITED};
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
    check_size(&Place::part(path, "candidates".to_owned()), &given)?;
    let place = Place::part(path, "candidate".to_owned());
    let mut candidates = others.to_vec();
    for given in given {
        let effect = define(&place, &given, Start::Given)?;
        check_unique(&place, &candidates, effect.spec().id)?;
        candidates.push(effect);
    }
    Ok(candidates)
}

fn check_size(place: &Place, effects: &[EffectToml]) -> Result<(), ModelError> {
    let count = effects.len();
    let characters: usize = effects.iter().map(EffectToml::characters).sum();
    let problem = match (count > MOST_EFFECTS, characters > MOST_CHARACTERS) {
        (false, false) => return Ok(()),
        (true, _) => format!("{count} effects; at most {MOST_EFFECTS} are allowed"),
        (false, true) => {
            format!("{characters} characters of expressions; at most {MOST_CHARACTERS} are allowed")
        }
    };
    Err(place.error(problem))
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

/// An error about one effect.
fn of_effect(place: &Place, effect: &str, problem: &str) -> ModelError {
    place.error(format!("effect `{effect}` {problem}"))
}

fn check_unique(place: &Place, others: &[&'static dyn Effect], id: &str) -> Result<(), ModelError> {
    if others.iter().any(|other| other.spec().id == id) {
        let problem = "has an id that another one has; rename one of them";
        return Err(of_effect(place, id, problem));
    }
    Ok(())
}

/// An effect of the file's own.
fn define(
    place: &Place,
    given: &EffectToml,
    start: Start,
) -> Result<&'static dyn Effect, ModelError> {
    if given.kind != expression::KIND {
        let problem = "must have kind = \"expression\"; effects of the catalogue are candidates \
                       anyway";
        return Err(of_effect(place, &given.kind, problem));
    }
    let id = given.id.clone().ok_or_else(|| {
        let problem = "has no `id`: give it a name, as in id = \"knee\"";
        of_effect(place, &given.kind, problem)
    })?;
    let stage = given.stage.ok_or_else(|| {
        of_effect(place, &id, "has no `stage`: input, transport, dynamics, load or output")
    })?;
    let expression = given.expression.clone().ok_or_else(|| {
        of_effect(place, &id, "has no `expression`, as in expression = \"signal + 0.1\"")
    })?;
    let states = given.states.iter().map(|(name, state)| state.of_name(name)).collect();
    let parameters = given.parameters.iter();
    let parameters = parameters.map(|(name, given)| own_parameter(name, given.table(), start));
    let defined = expression::define(Definition {
        id: id.clone(),
        summary: given.summary.clone(),
        stage,
        expression,
        states,
        parameters: parameters.collect(),
    });
    defined.map_err(|source| place.error_from(format!("effect `{id}`"), source))
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

/// A joint of a file, with what it may name.
pub(super) struct JointReader<'a> {
    pub(super) place: Place,
    pub(super) candidates: &'a [&'static dyn Effect],
}

impl JointReader<'_> {
    pub(super) fn joint(&self, joint: &JointToml) -> Result<JointModel, ModelError> {
        if joint.structure != "integrator" {
            let found = &joint.structure;
            let problem = format!("structure `{found}` is not known; expected `integrator`");
            return Err(self.place.error(problem));
        }
        let own = [("gain", f64::MIN, f64::MAX), ("delay", 0.0, f64::MAX)];
        let given = self.values("integrator", &own, &joint.parameters)?;
        let needed = |index: usize, name: &str| {
            let value = given.get(index).copied().flatten();
            value.ok_or_else(|| self.place.error(format!("parameter `{name}` is missing")))
        };
        let mut model = JointModel::integrator(0.0, 0.0);
        (model.gain, model.delay) = (needed(0, "gain")?, needed(1, "delay")?);
        check_size(&self.place, &joint.effect)?;
        for given in &joint.effect {
            let before: Vec<_> = model.components().iter().map(Component::effect).collect();
            model = model.with(self.component(given, &before)?);
        }
        Ok(model)
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
            Some(fault) => Err(of_effect(&self.place, effect.spec().id, fault)),
            None => Ok(component),
        }
    }

    fn own_effect(
        &self,
        given: &EffectToml,
        before: &[&'static dyn Effect],
    ) -> Result<&'static dyn Effect, ModelError> {
        let effect = define(&self.place, given, Start::InModel)?;
        let id = effect.spec().id;
        if self.candidates.iter().any(|candidate| candidate.spec().id == id) {
            let problem = format!("is a candidate; write kind = \"{id}\", or rename one of them");
            return Err(of_effect(&self.place, id, &problem));
        }
        check_unique(&self.place, before, id)?;
        Ok(effect)
    }

    /// The effect of the catalogue, or the candidate, of this kind.
    fn known_effect(&self, given: &EffectToml) -> Result<&'static dyn Effect, ModelError> {
        let EffectToml { kind, id, summary, stage, expression, states, parameters } = given;
        let is_defined = id.is_some() || summary.is_some() || stage.is_some() || !states.is_empty();
        if is_defined || expression.is_some() {
            let problem = "has a definition already: `id`, `summary`, `stage`, `expression` and \
                           `states` belong to kind = \"expression\"";
            return Err(of_effect(&self.place, kind, problem));
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
            return Err(of_effect(&self.place, kind, &problem));
        }
        effect::find_among(kind, self.candidates).map_err(|source| {
            self.place.error_from("`tauscope effects` lists the catalogue", source)
        })
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
            let known = names.join(", ");
            let problem = format!("`{owner}` has no parameter `{name}`; it has {known}");
            return Err(self.place.error(problem));
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
        for (key, limit) in [("min", value.min), ("max", value.max)] {
            if limit.is_some_and(f64::is_nan) {
                let problem = format!("`{owner}.{name}`: `{key}` is not a number; remove it");
                return Err(self.place.error(problem));
            }
        }
        let min = value.min.map_or(own.0, |min| min.max(own.0));
        let max = value.max.map_or(own.1, |max| max.min(own.1));
        if (min..=max).contains(&value.value) {
            return Ok(value);
        }
        let (written, allowed) = (plain(value.value), allowed(value.value, (min, max)));
        Err(self.place.error(format!("`{owner}.{name}` = {written} is not {allowed}")))
    }
}

/// What a value may be.
fn allowed(value: f64, (min, max): (f64, f64)) -> String {
    if value.abs() > UNLIMITED && value.is_finite() {
        return format!("between -{UNLIMITED:e} and {UNLIMITED:e}");
    }
    match (min > -UNLIMITED, max < UNLIMITED) {
        (true, true) => format!("between {} and {}", plain(min), plain(max)),
        (true, false) => format!("{} or more", plain(min)),
        (false, true) => format!("{} or less", plain(max)),
        (false, false) => "a finite number".to_owned(),
    }
}

/// A number without rows of zeros.
fn plain(value: f64) -> String {
    if value.abs() < UNLIMITED { value.to_string() } else { format!("{value:e}") }
}
