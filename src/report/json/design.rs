//! Schema `tauscope/design/1`.

use serde_json::{Value, json};

use super::document::document;
use crate::design::{Expected, Prediction, Rehearsal, Schedule, Side, transitions};
use crate::report::design::{DesignedJoint, Discrimination, holds, kept_until_s, order};

/// The document of `design --format json`; `failures` are messages on joints that failed.
pub(crate) fn design_json(seed: u64, joints: &[DesignedJoint], failures: &[String]) -> Value {
    let joints: Value = joints.iter().map(joint).collect();
    let facts = json!({ "seed": seed, "joints": joints, "failures": failures });
    document("tauscope/design/1", facts)
}

fn joint(joint: &DesignedJoint) -> Value {
    let DesignedJoint { rig, schedule, .. } = joint;
    let ends = |(low, high): (f64, f64)| json!({ "low": low, "high": high });
    let trial =
        |trial: &Schedule| json!({ "duration_s": trial.duration_s(), "steps": trial.steps() });
    json!({
        "joint": rig.name,
        "input_unit": rig.input_unit,
        "output_unit": rig.output_unit,
        "sample_period_s": schedule.period().seconds(),
        "duration_s": schedule.duration_s(),
        "steps": schedule.steps(),
        "levels": schedule.levels(),
        "hold_s": ends(schedule.hold_range_s()),
        "transitions": transitions(schedule),
        "start": rig.start,
        "start_tolerance": joint.basis.as_ref().and_then(|basis| basis.start_tolerance),
        "output_range": rig.range.map(ends),
        "predicted": joint.prediction.as_ref().map(|found| predicted(joint, found)),
        "separates": joint.discrimination.as_ref().map(discrimination),
        "notes": joint.notes,
        "trials": schedule.trials().iter().map(trial).collect::<Value>(),
        "holds": holds(schedule),
    })
}

fn predicted(joint: &DesignedJoint, prediction: &Prediction) -> Value {
    let (low, high) = prediction.extent();
    json!({
        "low": low,
        "high": high,
        "largest_margin": prediction.largest_margin(),
        "kept_until_s": kept_until_s(joint, prediction),
    })
}

fn discrimination(found: &Discrimination) -> Value {
    let Discrimination { ids, design, wanted, noise, .. } = found;
    let sides = ids.iter().zip(&design.sides);
    json!({
        "effects": ids,
        "order": order(design.order),
        "noise": noise,
        "power_wanted": wanted,
        "power": design.power(),
        "explores": design.explores,
        "if_there": sides.map(|(effect, of_effect)| side(effect, of_effect)).collect::<Value>(),
    })
}

fn side(effect: &str, side: &Side) -> Value {
    let Expected { rival, neither, .. } = side.expected;
    let Rehearsal { successes, runs } = side.rehearsal.unwrap_or_default();
    json!({
        "effect": effect,
        "told": side.is_target,
        "excluded": side.is_excluded,
        "power": side.expected.power(),
        "noncentrality": rival.noncentrality(),
        "noncentrality_training": rival.training,
        "noncentrality_validation": rival.validation,
        "noncentrality_with_neither": neither.noncentrality(),
        "rehearsed": runs,
        "rehearsed_told": successes,
    })
}
