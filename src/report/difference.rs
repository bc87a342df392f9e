//! Decisions beside those of other results.

use serde_json::{Value, json};

use super::{EstimatedJoint, TextTable};
use crate::study::{JointDifferences, JointResult, OtherResult, StepPair, StepResult, Verdicts};
use crate::wording::{difference_in_short, difference_sentences, result_in_short, step_name};

/// Another result, and how it differs on each joint.
#[derive(Debug)]
pub(crate) struct Against<'a> {
    pub(crate) other: &'a OtherResult,
    /// The joints of this result in their order.
    pub(crate) joints: Vec<(&'a str, JointDifferences)>,
    /// Joints that this result does not have.
    pub(crate) only_there: Vec<&'a str>,
}

impl<'a> Against<'a> {
    /// Compares `joints` with `other`.
    pub(crate) fn of(joints: &[EstimatedJoint<'a>], other: &'a OtherResult) -> Self {
        let one = |joint: &EstimatedJoint<'a>| {
            let here = JointResult::of(joint.joint, joint.estimate);
            let there = other.joint(&joint.joint.name);
            (joint.joint.name.as_str(), JointDifferences::of(&here, there))
        };
        let is_here =
            |name: &str| joints.iter().any(|joint: &EstimatedJoint<'_>| joint.joint.name == name);
        let names = other.joints.iter().map(|joint| joint.joint.as_str());
        let only_there = names.filter(|name| !is_here(name)).collect();
        Self { other, joints: joints.iter().map(one).collect(), only_there }
    }

    /// Whether no step has a counterpart.
    pub(crate) fn is_empty(&self) -> bool {
        self.joints.iter().all(|(_, found)| found.pairs.is_empty())
    }

    /// Name and settings of the other result.
    pub(crate) fn title(&self) -> String {
        match &self.other.settings {
            Some(settings) if *settings != self.other.name => {
                format!("{} ({settings})", self.other.name)
            }
            _ => self.other.name.clone(),
        }
    }
}

/// How the decisions differ from those of another result: the largest differences of each joint.
pub(crate) fn against_text(against: &Against<'_>) -> String {
    /// Steps of a joint that are shown.
    const MOST: usize = 10;
    let mut text = format!("\nagainst {}:\n", against.title());
    for (joint, found) in &against.joints {
        let sentences = difference_sentences(found).into_iter();
        text.extend(sentences.map(|sentence| format!("{joint}: {sentence}\n")));
    }
    let joints = against.joints.iter().map(|(joint, found)| (*joint, found));
    let table = difference_table(joints, MOST);
    if !table.rows.is_empty() {
        text += &table.to_string();
        text += "\n";
    }
    if !against.only_there.is_empty() {
        let names = against.only_there.join(", ");
        text += &["joints that are not here: ", &names, "\n"].concat();
    }
    let all: usize = against.joints.iter().map(|(_, found)| found.differing().count()).sum();
    let left_out = all - table.rows.len();
    if left_out > 0 {
        let left_out = left_out.to_string();
        text += &(left_out + " smaller differences are in the JSON and in the recording\n");
    }
    text
}

/// The steps that differ, the largest differences first; at most so many of each joint.
pub(super) fn difference_table<'a>(
    joints: impl Iterator<Item = (&'a str, &'a JointDifferences)>,
    most: usize,
) -> TextTable {
    let mut table = TextTable::new(["joint", "step", "p", "here", "there", "difference"], &[2]);
    for (joint, found) in joints {
        let trials = found.trials();
        for pair in found.differing().take(most) {
            table.row([
                joint.to_owned(),
                step_name(&pair.here, trials),
                pair.here.p.to_string(),
                result_in_short(&pair.here),
                result_in_short(&pair.there),
                difference_in_short(pair),
            ]);
        }
    }
    table
}

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
