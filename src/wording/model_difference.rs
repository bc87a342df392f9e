//! Two models of one joint, in words.

use super::{counted, feature_with_level, measure, p_text};
use crate::diagnosis::{ModelDifference, RegionPair};
use crate::experiment::Joint;

/// Which of two models is better, how surely, and where; `model` is the one that is spoken of.
pub(crate) fn model_difference_sentences(
    joint: &Joint,
    (model, other): (&str, &str),
    found: &ModelDifference,
) -> Vec<String> {
    let unit = joint.output_unit.as_deref();
    let part = if found.is_validation { "validation part" } else { "whole record" };
    let steps = counted(found.steps, "step");
    let (own, others) = (measure(found.rmse, unit), measure(found.other_rmse, unit));
    let errors = format!(
        "error {own} of {model}, {others} of {other} ({steps} of the {part}, restarted at each); \
         {model} is better in {} of them",
        found.better_steps
    );
    let better = if found.rmse < found.other_rmse { model } else { other };
    let test = found.test.map_or_else(
        || "too few steps, or no difference, to ask whether it is more than chance".to_owned(),
        |test| {
            let p = p_text(test.p_value);
            let said = if found.is_significant() == Some(true) {
                format!("{better} is better by more than chance")
            } else {
                "the difference may be chance".to_owned()
            };
            format!("{said} ({p}, Diebold and Mariano's test over the steps)")
        },
    );
    let places = [(&found.better_where, model), (&found.worse_where, other)];
    let places = places.into_iter().filter(|(pairs, _)| !pairs.is_empty());
    let places = places.map(|(pairs, name)| {
        let place = |pair: &RegionPair| {
            let (own, others) = (measure(pair.region.rmse, unit), measure(pair.other_rmse, unit));
            format!("{} ({own}, {others})", feature_with_level(joint, &pair.region))
        };
        let places: Vec<_> = pairs.iter().map(place).collect();
        format!("where {name} is better (error of {model}, of {other}): {}", places.join("; "))
    });
    [errors, test].into_iter().chain(places).collect()
}
