//! Which effects are tried as explanations, and how many may be added.

use std::borrow::Cow;

use super::measured_signals::possible_causes;
use crate::effect::{Effect, OF_CONDITIONS, REGISTRY, TrialGain, signal_gain, within_trials};
use crate::experiment::{Joint, are_opposites, conditions};

/// Which effects are tried, and which may stay.
#[derive(Clone, Debug)]
pub struct Options {
    /// The effects that are tried.
    pub effects: Vec<&'static dyn Effect>,
    /// Effects that may be added one after the other.
    pub max_effects: usize,
    /// Whether effects without practical consequence stay in an improved model.
    pub keeps_refinements: bool,
    /// Whether each revision keeps what its model simulates, as recordings need it, and not the last
    /// alone: of a long record that is most of the memory.
    pub keeps_series: bool,
    /// When the effects are tried.
    pub tried: Tried,
    /// Whether what [differs between trials](conditions) is tried, too: the effects of
    /// [`OF_CONDITIONS`], each in the trials of one condition; and a gain that depends on a measured
    /// signal, for each that may be a cause.
    pub tries_conditions: bool,
}

/// When effects are tried.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Tried {
    /// Where a model lacks something.
    #[default]
    WhereLacking,
    /// Always, and shown with what is thought of them: where somebody asked for them.
    Always,
}

impl Options {
    /// These options for `joint`, with the effects of its conditions and measured signals.
    pub(super) fn of(&self, joint: &Joint) -> Cow<'_, Self> {
        if !self.tries_conditions {
            return Cow::Borrowed(self);
        }
        let words = conditions(&joint.trials);
        let mut options = self.clone();
        options.effects.extend(possible_causes(joint).into_iter().map(signal_gain));
        for (index, word) in words.iter().enumerate() {
            let is_opposite = |other: &String| are_opposites(&joint.trials, [other, word]);
            let has_opposite = words[..index].iter().any(is_opposite);
            // A gain that is higher with one word is lower with its opposite: the same model.
            let is_new =
                |effect: &&&dyn Effect| !(has_opposite && effect.spec().id == TrialGain.spec().id);
            let effects = OF_CONDITIONS.iter().filter(is_new);
            options.effects.extend(effects.map(|effect| within_trials(*effect, word)));
        }
        Cow::Owned(options)
    }
}

/// Effects that are added one after the other where nothing else is said: a cylinder has so
/// many.
pub const MAX_EFFECTS: usize = 8;

/// The whole catalogue, up to [`MAX_EFFECTS`].
impl Default for Options {
    fn default() -> Self {
        Self {
            effects: REGISTRY.to_vec(),
            max_effects: MAX_EFFECTS,
            keeps_refinements: false,
            keeps_series: true,
            tried: Tried::WhereLacking,
            tries_conditions: true,
        }
    }
}
