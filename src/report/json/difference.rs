//! Decisions beside those of other results.

use serde_json::{Value, json};

use crate::report::Against;
use crate::study::{JointDifferences, StepPair, StepResult, Verdicts};

/// Other results, and how each differs.
pub(super) fn differences_json(against: &[Against<'_>]) -> Value {
    let other = |against: &Against<'_>| {
        let joints = against.joints.iter().map(|(name, found)| joint(name, found));
        json!({
            "name": against.other.name,
            "settings": against.other.settings,
            "joints": joints.collect::<Value>(),
            "only_there": against.only_there,
        })
    };
    against.iter().map(other).collect()
}

fn joint(name: &str, found: &JointDifferences) -> Value {
    let steps = |steps: &[StepResult]| -> Value {
        let step = |step: &StepResult| json!({ "trial": step.trial, "i": step.i, "p": step.p });
        steps.iter().map(step).collect()
    };
    json!({
        "joint": name,
        "compared": found.pairs.len(),
        "accepted_by_both": found.count(Verdicts::BothAccepted),
        "accepted_here_only": found.count(Verdicts::OnlyHere),
        "accepted_there_only": found.count(Verdicts::OnlyThere),
        "accepted_by_neither": found.count(Verdicts::BothRejected),
        "other_delay": found.moved(),
        "median_distance_s": found.median_s(),
        "largest_distance_s": found.largest_s(),
        "matched_by_number": found.by_number,
        "only_here": steps(&found.only_here),
        "only_there": steps(&found.only_there),
        "differences": found.differing().map(pair).collect::<Value>(),
    })
}

fn pair(pair: &StepPair) -> Value {
    let StepPair { here, there } = pair;
    json!({
        "trial": here.trial,
        "i": here.i,
        "p": here.p,
        "verdict": here.verdict.to_string(),
        "delay_s": here.delay_s,
        "other_i": there.i,
        "other_p": there.p,
        "other_verdict": there.verdict.to_string(),
        "other_delay_s": there.delay_s,
        "difference_s": pair.difference_s(),
    })
}
