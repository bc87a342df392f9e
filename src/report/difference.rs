//! Decisions beside those of other results.

use super::EstimatedJoint;
use super::text_table::TextTable;
use crate::study::{JointDifferences, JointResult, OtherResult};
use crate::wording::{
    difference_in_short, difference_sentences, missing_sentences, result_in_short, step_name,
};

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

    /// Which steps have no counterpart, for whoever runs the command: a sentence per joint.
    pub(crate) fn notes(&self) -> Vec<String> {
        let name = &self.other.name;
        let left_over = self.joints.iter().filter_map(|(joint, found)| {
            let missing = missing_sentences(found).join("; ");
            (!missing.is_empty()).then(|| format!("against {name}, {joint}: {missing}"))
        });
        left_over.collect()
    }

    /// Which joints of the other result are not here.
    pub(crate) fn note_on_joints(&self) -> Option<String> {
        let (name, joints) = (&self.other.name, self.only_there.join(", "));
        (!joints.is_empty()).then(|| format!("against {name}: joints that are not here: {joints}"))
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
