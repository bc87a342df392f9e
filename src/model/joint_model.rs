//! Structure and parameters of one joint's model.

use std::borrow::Cow;

use crate::effect::{Effect, InputChange, Stage};
use crate::experiment::has_word;

/// A parameter: its value, whether a fit may change it, and within which bounds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Value {
    /// The value, in the unit of its parameter.
    pub value: f64,
    /// A fit leaves it as it is.
    pub fixed: bool,
    /// Lowest value of a fit, where it is not the parameter's own.
    pub min: Option<f64>,
    /// Highest value of a fit, where it is not the parameter's own.
    pub max: Option<f64>,
}

impl From<f64> for Value {
    fn from(value: f64) -> Self {
        Self { value, fixed: false, min: None, max: None }
    }
}

/// An effect in a model, with its parameters in the order of its specification.
#[derive(Clone, Debug)]
pub struct Component {
    effect: &'static dyn Effect,
    parameters: Vec<Value>,
}

impl Component {
    /// `effect` with these values, or `None` when their number is not that of its
    /// parameters.
    pub fn new(effect: &'static dyn Effect, parameters: Vec<Value>) -> Option<Self> {
        let expected = effect.spec().parameters.len();
        (parameters.len() == expected).then_some(Self { effect, parameters })
    }

    /// `effect` at its neutral values: it changes nothing yet.
    pub fn neutral(effect: &'static dyn Effect) -> Self {
        let neutral = |parameter: &crate::effect::Parameter| Value::from(parameter.neutral);
        let parameters = effect.spec().parameters.iter().map(neutral).collect();
        Self { effect, parameters }
    }

    /// `effect` with values at which it does about what this one does; `None` where it has none.
    pub(crate) fn replaced_by(&self, effect: &'static dyn Effect) -> Option<Self> {
        let values = effect.in_place_of(self.effect.spec(), &self.plain())?;
        Self::new(effect, values.into_iter().map(Value::from).collect())
    }

    /// `effect` in the form that takes each step's delay as it was measured; `None` where it
    /// has none.
    pub fn measured(effect: &'static dyn Effect) -> Option<Self> {
        Self::new(effect, effect.measured_delays()?.into_iter().map(Value::from).collect())
    }

    /// What it does with its parameters, in a few words.
    pub(crate) fn summary(&self) -> Cow<'static, str> {
        self.effect.summary(&self.plain())
    }

    /// Whether it is of that form.
    pub fn takes_measured_delays(&self) -> bool {
        self.effect.takes_measured_delays(&self.plain())
    }

    /// The effect.
    pub fn effect(&self) -> &'static dyn Effect {
        self.effect
    }

    /// Its parameters, in the order of its specification.
    pub fn parameters(&self) -> &[Value] {
        &self.parameters
    }

    /// Takes the values of `other` for parameters of the same name.
    fn take_over(&mut self, other: &Self) {
        let theirs = other.effect.spec().parameters.iter().zip(&other.parameters);
        for (name, value) in theirs.map(|(parameter, value)| (parameter.name, value)) {
            let own = self.effect.spec().parameters.iter().zip(&mut self.parameters);
            for (_, own) in own.filter(|(parameter, _)| parameter.name == name) {
                *own = *value;
            }
        }
    }

    /// The values alone.
    pub(crate) fn plain(&self) -> Vec<f64> {
        self.parameters.iter().map(|parameter| parameter.value).collect()
    }
}

/// The model of one joint: an integrator with effects on it.
///
/// `dy/dt = gain · s(t)`, where `s` is the input, `delay` late, after the effects of the
/// spool, input and dynamics stages; effects of the load stage change the velocity, those of the
/// output stage the angle. Within a stage, effects act in the order they were added.
#[derive(Clone, Debug)]
pub struct JointModel {
    /// Output units per second and input unit.
    pub gain: Value,
    /// Seconds.
    pub delay: Value,
    components: Vec<Component>,
}

impl JointModel {
    /// The plain integrator.
    pub fn integrator(gain: f64, delay: f64) -> Self {
        Self { gain: gain.into(), delay: delay.into(), components: Vec::new() }
    }

    /// This model with another effect after those it has.
    ///
    /// Effects that it absorbs (see [`Spec::absorbs`](crate::effect::Spec::absorbs)) go,
    /// and leave it their values for parameters of the same name.
    #[must_use]
    pub fn with(&self, mut component: Component) -> Self {
        let absorbs = component.effect.spec().absorbs;
        let mut model = self.clone();
        for absorbed in model.components.extract_if(.., |c| absorbs.contains(&c.effect.spec().id)) {
            component.take_over(&absorbed);
        }
        model.components.push(component);
        model
    }

    /// This model with one more effect, [added](Self::with) after those of its stage, and also before
    /// those that it may be [upstream of](crate::effect::Spec::upstream_of), where it has any.
    pub(crate) fn placements(&self, component: &Component) -> Vec<Self> {
        let behind = self.with(component.clone());
        let later = component.effect.spec().upstream_of;
        let first = behind.components.iter().position(|c| later.contains(&c.effect.spec().id));
        let before = first.map(|first| {
            let mut model = behind.clone();
            model.components[first..].rotate_right(1);
            model
        });
        [Some(behind), before].into_iter().flatten().collect()
    }

    /// This model without the effect `id`.
    #[must_use]
    pub fn without(&self, id: &str) -> Self {
        let mut model = self.clone();
        model.components.retain(|component| component.effect.spec().id != id);
        model
    }

    /// Names of the measured signals on which its effects depend.
    pub(crate) fn measured_signals(&self) -> impl Iterator<Item = &str> {
        self.components.iter().filter_map(|component| component.effect.measured_signal())
    }

    /// This model in a trial of this label: without the effects of other conditions (see
    /// [`Effect::within_trials`]).
    pub fn in_trial(&self, label: &str) -> Cow<'_, Self> {
        let acts = |component: &Component| {
            component.effect.within_trials().is_none_or(|of| has_word(label, of.word))
        };
        if self.components.iter().all(acts) {
            return Cow::Borrowed(self);
        }
        let mut model = self.clone();
        model.components.retain(acts);
        Cow::Owned(model)
    }

    /// Whether it takes time until the speed is what the input says.
    pub(crate) fn has_dynamics(&self) -> bool {
        let is_dynamic = |effect: &dyn Effect| {
            matches!(effect.spec().stage, Stage::Spool | Stage::Dynamics) && !effect.is_steady()
        };
        self.components.iter().any(|component| is_dynamic(component.effect))
    }

    /// Whether any effect can make the speed depend on the angle.
    pub(crate) fn depends_on_angle(&self) -> bool {
        self.components.iter().any(|component| component.effect.depends_on_angle())
    }

    /// Whether each step has its own delay, as it was measured, where that is known.
    pub fn takes_measured_delays(&self) -> bool {
        self.components.iter().any(Component::takes_measured_delays)
    }

    /// The effects, in the order they were added.
    pub fn components(&self) -> &[Component] {
        &self.components
    }

    /// All parameters: gain, delay, then those of each effect.
    pub fn values(&self) -> Vec<Value> {
        let own = [self.gain, self.delay].into_iter();
        own.chain(self.components.iter().flat_map(|c| c.parameters.iter().copied())).collect()
    }

    /// This model with other values, in the order of [`values`](Self::values); what is
    /// missing at the end keeps its value.
    #[must_use]
    pub fn with_values(&self, values: &[f64]) -> Self {
        let mut model = self.clone();
        let parameters = model.components.iter_mut().flat_map(|c| &mut c.parameters);
        let all = [&mut model.gain, &mut model.delay].into_iter().chain(parameters);
        for (parameter, value) in all.zip(values) {
            parameter.value = *value;
        }
        model
    }

    /// Names of all parameters, as `gain` or `dead_band.lower`.
    pub fn names(&self) -> Vec<String> {
        let own = ["gain", "delay"].map(str::to_owned).into_iter();
        let named = |component: &Component| {
            let spec = component.effect.spec();
            spec.parameters.iter().map(|p| format!("{}.{}", spec.id, p.name)).collect::<Vec<_>>()
        };
        own.chain(self.components.iter().flat_map(named)).collect()
    }

    /// The delay of a change of the input, seconds: `delay` and what the effects of the transport
    /// stage add to it, never below zero.
    pub fn delay_s(&self, change: &InputChange) -> f64 {
        self.delay_of()(change)
    }

    /// The [delay](Self::delay_s) of any change.
    pub(super) fn delay_of(&self) -> impl Fn(&InputChange) -> f64 {
        let transport = self.stage(Stage::Transport);
        let transport: Vec<_> = transport.map(|one| (one.effect, one.plain())).collect();
        let delay_s = self.delay.value;
        move |change| {
            let extra = transport.iter().map(|(effect, plain)| effect.extra_delay_s(plain, change));
            (delay_s + extra.sum::<f64>()).max(0.0)
        }
    }

    /// The effects of one stage.
    pub(super) fn stage(&self, stage: Stage) -> impl Iterator<Item = &Component> {
        self.components.iter().filter(move |component| component.effect.spec().stage == stage)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effect::{ActuatorLag, CoulombFriction, DeadBand};

    #[test]
    fn an_effect_takes_the_place_of_those_it_contains() {
        let lag = Component::new(&ActuatorLag, vec![Value { fixed: true, ..0.3.into() }]).unwrap();
        let model = JointModel::integrator(1.0, 0.1).with(lag).with(Component::neutral(&DeadBand));
        let model = model.with(Component::neutral(&CoulombFriction));
        let ids: Vec<_> = model.components().iter().map(|c| c.effect().spec().id).collect();
        assert_eq!(ids, ["dead_band", "coulomb_friction"]);
        let friction = model.components()[1].parameters();
        assert_eq!(friction[2], Value { fixed: true, ..0.3.into() });
        assert_eq!(friction[0], 0.0.into());
    }
}
