//! A model with one effect more, or several, fitted.

use super::outcome::FitOutcome;
use crate::effect::Effect;
use crate::model::{Component, JointModel};

/// A model with effects added to it, fitted.
#[derive(Clone, Debug)]
pub(super) struct Extension {
    /// Ids of what was added.
    pub(super) effects: Vec<&'static str>,
    pub(super) fit: FitOutcome,
}

impl Extension {
    /// Whether the model that was extended is a special case of it.
    pub(super) fn nests(&self) -> bool {
        components_of(&self.fit.model, &self.effects).map(Component::effect).all(Effect::nests)
    }
}

/// The components of `model` with the effects `ids`.
pub(super) fn components_of<'a>(
    model: &'a JointModel,
    ids: &'a [&'static str],
) -> impl Iterator<Item = &'a Component> {
    model.components().iter().filter(|component| ids.contains(&component.effect().spec().id))
}

/// Ids of the effects of `model`.
pub(super) fn ids(model: &JointModel) -> Vec<&'static str> {
    model.components().iter().map(|component| component.effect().spec().id).collect()
}
