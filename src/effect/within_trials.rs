//! An effect in the trials of one condition alone: gravity with the heavy load.
//!
//! ```text
//! out = effect(in)   in trials whose label has the word
//! out = in           in all others
//! ```
//!
//! What differs between trials, as the load or the supply, is often in their labels and in no
//! signal: `A-in-100-H-S` is a stroke with the high load. A simulation leaves the effect out of
//! the trials that it does not belong to (see [`Effect::within_trials`]); here it only has a name
//! of its own.

use std::borrow::Cow;

use super::interned::{Interned, part_of_interned, text_of_interned};
use super::{
    DeadBand, Dimension, Effect, Equations, GravityLoad, InputChange, Moment, Parameter,
    PositionGain, RecordRange, Spec, Stage, WithinTrials,
};

/// What a load, a supply or another pose of the machine may change.
pub const OF_CONDITIONS: &[&dyn Effect] = &[&TrialGain, &GravityLoad, &PositionGain, &DeadBand];

/// Another gain in the trials of a condition, for each direction: of all trials it would be the
/// joint's gain.
///
/// ```text
/// out = in · (1 + positive)   where in > 0
/// out = in · (1 + negative)   where in < 0
/// ```
#[derive(Clone, Copy, Debug)]
pub struct TrialGain;

static TRIAL_GAIN: Spec = Spec::new("gain", Stage::Load, "another gain, for each direction")
    .equation("out = in (1 + (in > 0 ? positive : negative))")
    .source("a factor of a condition: Montgomery, 2017, Design and Analysis of Experiments")
    .parameters(&[
        Parameter::new("positive", "part by which a positive speed is higher", Dimension::One)
            .between(-0.95, 4.0)
            .typical(-0.2),
        Parameter::new("negative", "part by which a negative speed is higher", Dimension::One)
            .between(-0.95, 4.0)
            .typical(-0.2),
    ])
    .equations(Equations::new(&["out = signal * (1 + if(signal > 0, positive, negative))"]));

impl Effect for TrialGain {
    fn spec(&self) -> &'static Spec {
        &TRIAL_GAIN
    }

    fn step(&self, parameters: &[f64], _memory: &mut [f64], at: &Moment) -> f64 {
        let &[positive, negative] = parameters else { return at.signal };
        at.signal * (1.0 + if at.signal > 0.0 { positive } else { negative })
    }

    fn depends_on_angle(&self) -> bool {
        false
    }
}

/// The effect and the word of an id such as `gravity_load[H]`.
pub(super) fn parts_of(id: &str) -> Option<(&str, &str)> {
    let (effect, word) = id.strip_suffix(']')?.split_once('[')?;
    (!word.is_empty() && !word.contains(['[', ']'])).then_some((effect, word))
}

/// Whether `word` can be one of a trial's label.
pub(super) fn is_word(word: &str) -> bool {
    word.chars().all(char::is_alphanumeric)
}

#[derive(Debug)]
struct Restricted {
    effect: &'static dyn Effect,
    word: String,
    spec: &'static Spec,
}

/// `effect` in the trials whose label has `word`, with an id of its own: `gravity_load[H]`.
///
/// # Examples
/// ```
/// use tauscope::effect::{GravityLoad, within_trials};
///
/// let heavy = within_trials(&GravityLoad, "H");
/// assert_eq!(heavy.spec().id, "gravity_load[H]");
/// assert_eq!(heavy.within_trials().unwrap().word, "H");
/// ```
pub fn within_trials(effect: &'static dyn Effect, word: &str) -> &'static dyn Effect {
    static KNOWN: Interned<Restricted> = Interned::none();
    let is_of = |one: &Restricted, (effect, word): &(&'static dyn Effect, &str)| {
        one.word == *word && std::ptr::eq(one.effect.spec(), effect.spec())
    };
    KNOWN.get_or_make((effect, word), is_of, |(effect, word)| Restricted::new(effect, word))
}

impl Restricted {
    fn new(effect: &'static dyn Effect, word: &str) -> Self {
        let inner = effect.spec();
        let spec = Spec {
            id: text_of_interned(format!("{}[{word}]", inner.id)),
            summary: text_of_interned(format!("{}, in trials `{word}`", inner.summary)),
            confused_with: &[],
            absorbs: &[],
            looks_like_both: &[],
            refines: None,
            limiting_case: None,
            ..inner.clone()
        };
        Self { effect, word: word.to_owned(), spec: part_of_interned(spec) }
    }
}

/// All that the effect itself says holds of it in these trials, too, but for its measured delays,
/// which leave no delay to the other trials, and its definition, which is of another id.
impl Effect for Restricted {
    fn spec(&self) -> &'static Spec {
        self.spec
    }

    fn summary(&self, parameters: &[f64]) -> Cow<'static, str> {
        format!("{}, in trials `{}`", self.effect.summary(parameters), self.word).into()
    }

    fn within_trials(&self) -> Option<WithinTrials<'_>> {
        Some(WithinTrials { effect: self.effect, word: &self.word })
    }

    fn step(&self, parameters: &[f64], memory: &mut [f64], at: &Moment) -> f64 {
        self.effect.step(parameters, memory, at)
    }

    fn settle(&self, parameters: &[f64], memory: &mut [f64], at: &Moment) {
        self.effect.settle(parameters, memory, at);
    }

    fn extra_delay_s(&self, parameters: &[f64], change: &InputChange) -> f64 {
        self.effect.extra_delay_s(parameters, change)
    }

    fn nests(&self) -> bool {
        self.effect.nests()
    }

    fn is_steady(&self) -> bool {
        self.effect.is_steady()
    }

    fn depends_on_angle(&self) -> bool {
        self.effect.depends_on_angle()
    }

    fn depends_on_others(&self) -> bool {
        self.effect.depends_on_others()
    }

    fn depends_on_warmth(&self) -> bool {
        self.effect.depends_on_warmth()
    }

    fn depends_on_steps(&self) -> bool {
        self.effect.depends_on_steps()
    }

    fn bounds(&self, record: &RecordRange<'_>) -> Vec<(f64, f64)> {
        self.effect.bounds(record)
    }

    fn guesses(&self, record: &RecordRange<'_>) -> Vec<Vec<f64>> {
        self.effect.guesses(record)
    }

    fn fault(&self, parameters: &[f64]) -> Option<&'static str> {
        self.effect.fault(parameters)
    }

    fn in_place_of(&self, other: &Spec, values: &[f64]) -> Option<Vec<f64>> {
        self.effect.in_place_of(other, values)
    }
}

#[cfg(test)]
mod tests {
    use super::super::testing::{assert_close, run};
    use super::*;
    use crate::effect::contract::check;
    use crate::effect::{REGISTRY, SupplyDroop, VariableDelay};

    #[test]
    fn the_gain_differs_by_direction() {
        assert_close(&run(&TrialGain, &[0.5, -0.25], &[2.0, 0.0, -2.0]), &[3.0, 0.0, -1.5]);
    }

    #[test]
    fn what_an_effect_depends_on_it_depends_on_in_some_trials() {
        for effect in REGISTRY {
            let restricted = within_trials(*effect, "H");
            let depends = |effect: &dyn Effect| {
                [
                    effect.depends_on_angle(),
                    effect.depends_on_others(),
                    effect.depends_on_warmth(),
                    effect.depends_on_steps(),
                    effect.is_steady(),
                    effect.nests(),
                ]
            };
            assert_eq!(depends(restricted), depends(*effect), "{}", restricted.spec().id);
        }
        assert!(within_trials(&SupplyDroop, "H").depends_on_others());
        let law = within_trials(&VariableDelay, "H");
        let parameters: Vec<f64> = law.spec().parameters.iter().map(|p| p.neutral).collect();
        let own = VariableDelay.summary(&parameters);
        assert_eq!(law.summary(&parameters), format!("{own}, in trials `H`"));
    }

    #[test]
    fn each_keeps_the_contract_and_is_there_once() {
        for effect in OF_CONDITIONS {
            let restricted = within_trials(*effect, "heavy");
            assert_eq!(check(restricted), Ok(()));
            assert!(std::ptr::eq(restricted.spec(), within_trials(*effect, "heavy").spec()));
        }
        assert_eq!(within_trials(&DeadBand, "20kg").spec().id, "dead_band[20kg]");
    }
}
