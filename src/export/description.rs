//! A model as every language needs it: parameters with names, effects as lines.

use std::collections::BTreeSet;

use super::error::ExportError;
use crate::effect::expression::Program;
use crate::effect::{Dimension, Stage};
use crate::experiment::is_control;
use crate::model::{Component, JointModel};
use crate::units::radians_in;

/// The units of the log that a model is of; they are shown with the parameters.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Units {
    /// Of the input.
    pub input: Option<String>,
    /// Of the output: `deg`, `rad`, `mrad` or `rev` say what an angle is, and where it is none
    /// of them it is taken for degrees, as by [`fit`](crate::fit::fit).
    pub output: Option<String>,
}

/// A joint's model, ready to be written in any [`Language`](super::Language).
#[derive(Clone, Debug)]
pub struct Export {
    pub(super) joint: String,
    /// Where it is from, line by line.
    pub(super) origin: Vec<String>,
    pub(super) units: Units,
    /// `gain`, `delay`, `start_s`, `radians_per_output_unit`, then those of the effects.
    pub(super) parameters: Vec<Parameter>,
    pub(super) effects: Vec<Exported>,
}

/// A number that may be changed in the model.
#[derive(Clone, Debug)]
pub(super) struct Parameter {
    /// As a variable.
    pub(super) name: String,
    pub(super) meaning: String,
    /// Empty where it has none.
    pub(super) unit: String,
    pub(super) value: f64,
}

/// An effect of the model.
#[derive(Clone, Debug)]
pub(super) struct Exported {
    /// Its id; where the model has it before, with something after it.
    pub(super) id: String,
    pub(super) summary: String,
    pub(super) equation: String,
    pub(super) stage: Stage,
    pub(super) acts_on_state: bool,
    /// Of its parameters, as in [`Export::parameters`].
    pub(super) parameters: Vec<String>,
    /// Of its memory, as variables.
    pub(super) memory: Vec<String>,
    pub(super) settle: Program,
    pub(super) step: Program,
}

impl Parameter {
    /// Its meaning, and its unit where it has one.
    pub(super) fn described(&self) -> String {
        let Self { meaning, unit, .. } = self;
        if unit.is_empty() { meaning.clone() } else { format!("{meaning} [{unit}]") }
    }
}

impl Export {
    /// The model of `joint`; `origin` says, line by line, where it is from.
    ///
    /// # Errors
    /// [`ExportError`], with the effect that cannot be exported.
    ///
    /// # Examples
    /// ```
    /// use tauscope::JointModel;
    /// use tauscope::export::{Export, Units, by_ending};
    ///
    /// let model = JointModel::integrator(11.9, 0.15);
    /// let export = Export::new("boom", &model, Units::default(), &[])?;
    /// let python = by_ending("py").unwrap();
    /// assert!(python.files(&export, "boom")?[0].text().contains("def step(self, input)"));
    /// # Ok::<(), tauscope::export::ExportError>(())
    /// ```
    pub fn new(
        joint: &str,
        model: &JointModel,
        units: Units,
        origin: &[String],
    ) -> Result<Self, ExportError> {
        let Units { input, output } = units;
        let units =
            Units { input: input.map(|it| one_line(&it)), output: output.map(|it| one_line(&it)) };
        let mut taken = Taken::reserved();
        let mut parameters = own_parameters(model, &units, &mut taken);
        let mut effects = Vec::new();
        for component in model.components() {
            let (effect, its) = exported(component, &units, &mut taken)?;
            effects.push(effect);
            parameters.extend(its);
        }
        let origin = origin.iter().map(|line| one_line(line).trim_end().to_owned()).collect();
        Ok(Self { joint: one_line(joint), origin, units, parameters, effects })
    }

    /// The effects of a stage, in their order.
    pub(super) fn stage(&self, stage: Stage) -> impl Iterator<Item = &Exported> {
        self.effects.iter().filter(move |effect| effect.stage == stage)
    }

    /// The effects between the input and the gain.
    pub(super) fn drive(&self) -> impl Iterator<Item = &Exported> {
        let stages = [Stage::Spool, Stage::Input, Stage::Dynamics];
        stages.into_iter().flat_map(|stage| self.stage(stage))
    }

    /// The effects on the output that limit the angle itself.
    pub(super) fn limits(&self) -> impl Iterator<Item = &Exported> {
        self.stage(Stage::Output).filter(|effect| effect.acts_on_state)
    }

    /// The effects between the angle and its sensor.
    pub(super) fn sensor(&self) -> impl Iterator<Item = &Exported> {
        self.stage(Stage::Output).filter(|effect| !effect.acts_on_state)
    }

    /// Whether the joint moves otherwise while other joints move.
    pub(super) fn uses_others(&self) -> bool {
        self.effects.iter().any(|effect| effect.step.uses_others())
    }
}

/// A text that ends no line, and so no comment of a line, in any language: a model file says what it
/// likes of its effects, and what is exported is run.
fn one_line(text: &str) -> String {
    text.replace(is_control, " ")
}

/// Names that are taken; another of the same is made another.
#[derive(Debug)]
struct Taken(BTreeSet<String>);

impl Taken {
    /// With the names that the templates have in the state of the joint.
    fn reserved() -> Self {
        let state = "p others lost period_s sample before since level first count coming angle \
                     velocity measured load_adds";
        Self(state.split_whitespace().map(str::to_owned).collect())
    }

    fn give(&mut self, name: String) -> String {
        let mut name = name;
        while !self.0.insert(name.clone()) {
            name.push('_');
        }
        name
    }
}

/// Parameters of the joint itself.
fn own_parameters(model: &JointModel, units: &Units, taken: &mut Taken) -> Vec<Parameter> {
    let of = |dimension: Dimension| dimension.unit(units.input.as_deref(), units.output.as_deref());
    let gain = format!("{}/{}", of(Dimension::OutputPerSecond), of(Dimension::Input));
    let radians = radians_in(units.output.as_deref());
    let own = [
        ("gain", "speed of the joint per input", gain, model.gain.value),
        ("delay", "time until the input acts", of(Dimension::Seconds), model.delay.value),
        ("start_s", "time of the record at the first sample", of(Dimension::Seconds), 0.0),
        ("radians_per_output_unit", "radians in one unit of the output", String::new(), radians),
    ];
    let parameter = |(name, meaning, unit, value): (&str, &str, String, f64)| Parameter {
        name: taken.give(name.to_owned()),
        meaning: meaning.to_owned(),
        unit,
        value,
    };
    own.map(parameter).to_vec()
}

/// A name of every language for `gravity_load[H]`: `gravity_load_H`.
fn identifier(id: &str) -> String {
    let id = id.trim_end_matches(']');
    id.chars().map(|c| if c.is_ascii_alphanumeric() { c } else { '_' }).collect()
}

fn exported(
    component: &Component,
    units: &Units,
    taken: &mut Taken,
) -> Result<(Exported, Vec<Parameter>), ExportError> {
    let spec = component.effect().spec();
    if component.takes_measured_delays() {
        return Err(ExportError::MeasuredDelays { effect: spec.id });
    }
    let equations = spec.equations.ok_or(ExportError::NoEquations { effect: spec.id })?;
    let names: Vec<_> = spec.parameters.iter().map(|parameter| parameter.name).collect();
    let parse = |text: &str| {
        let parsed = Program::parse(text, spec.stage, &names, equations.memory);
        parsed.map_err(|source| ExportError::Equations { effect: spec.id, source })
    };
    let (settle, step) = (parse(equations.settle)?, parse(&equations.step.concat())?);
    if !step.gives_result() {
        return Err(ExportError::NoResult { effect: spec.id });
    }
    let id = taken.give(identifier(spec.id));
    let mut give = |name: &str| taken.give(format!("{id}_{name}"));
    let own = spec.parameters.iter().zip(component.parameters());
    let parameters: Vec<_> = own
        .map(|(parameter, value)| Parameter {
            name: give(parameter.name),
            meaning: one_line(parameter.meaning),
            unit: parameter.dimension.unit(units.input.as_deref(), units.output.as_deref()),
            value: value.value,
        })
        .collect();
    let memory = equations.memory.iter().map(|name| give(name)).collect();
    let exported = Exported {
        id,
        summary: one_line(spec.summary),
        equation: one_line(spec.equation),
        stage: spec.stage,
        acts_on_state: spec.acts_on_state,
        parameters: parameters.iter().map(|parameter| parameter.name.clone()).collect(),
        memory,
        settle,
        step,
    };
    Ok((exported, parameters))
}
