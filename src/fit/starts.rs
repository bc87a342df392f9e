//! Where a fit starts.

use crate::effect::RecordRange;
use crate::model::{Component, JointModel, Value};

/// Start values: those of the model, and the starts of effects that are still neutral.
pub(super) fn starts(model: &JointModel, range: &RecordRange<'_>) -> Vec<Vec<f64>> {
    /// Combinations that are tried at most, but for as many as one effect has by itself.
    const MOST: usize = 16;
    let mut starts = vec![vec![model.gain.value, model.delay.value]];
    for component in model.components() {
        let own = component_starts(component, range);
        let with = |start: &Vec<f64>| {
            own.iter().map(|own| [start.as_slice(), own].concat()).collect::<Vec<_>>()
        };
        let most = MOST.max(starts.len()).max(own.len());
        starts = starts.iter().flat_map(with).take(most).collect();
    }
    starts
}

/// The starts of one effect: its own for those of its parameters that are neutral and not
/// fixed, and the values it has where any is not neutral.
fn component_starts(component: &Component, range: &RecordRange<'_>) -> Vec<Vec<f64>> {
    let given = component.parameters();
    let neutral = component.effect().spec().neutral();
    #[expect(clippy::float_cmp, reason = "neutral is a number that is set")]
    let keeps = |(value, neutral): (&Value, &f64)| value.fixed || value.value != *neutral;
    let keeps: Vec<bool> = given.iter().zip(&neutral).map(keeps).collect();
    let plain: Vec<f64> = given.iter().map(|value| value.value).collect();
    if keeps.iter().all(|keeps| *keeps) {
        return vec![plain];
    }
    let mut starts = component.effect().starts(range);
    for start in &mut starts {
        for (value, (given, _)) in
            start.iter_mut().zip(plain.iter().zip(&keeps)).filter(|(_, (_, keeps))| **keeps)
        {
            *value = *given;
        }
    }
    starts.dedup();
    let any_set = given.iter().zip(&keeps).any(|(value, keeps)| *keeps && !value.fixed);
    if any_set {
        starts.insert(0, plain);
    }
    starts
}
