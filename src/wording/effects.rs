//! What a model consists of.

use crate::model::JointModel;

/// Ids of the effects of a model, in its order.
pub(crate) fn effect_ids(model: &JointModel) -> Vec<&'static str> {
    model.components().iter().map(|component| component.effect().spec().id).collect()
}

/// `dead_band + stiction`; a model without effects is an integrator.
pub(crate) fn effects_text(model: &JointModel) -> String {
    effects_named(&effect_ids(model))
}

/// As [`effects_text`], of the ids of effects.
pub(crate) fn effects_named(ids: &[&str]) -> String {
    if ids.is_empty() { "integrator".to_owned() } else { ids.join(" + ") }
}
