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

    /// What has no counterpart, for whoever runs the command: a sentence each. Joints of the other
    /// result that are not here are named where all joints of the log are.
    pub(crate) fn notes(&self, has_all_joints: bool) -> Vec<String> {
        let name = &self.other.name;
        let left_over = self.joints.iter().filter_map(|(joint, found)| {
            let missing = missing_sentences(found);
            (!missing.is_empty())
                .then(|| format!("against {name}, {joint}: {}", missing.join("; ")))
        });
        let only_there = Some(&self.only_there).filter(|names| has_all_joints && !names.is_empty());
        let only_there = only_there
            .map(|names| format!("against {name}: joints that are not here: {}", names.join(", ")));
        left_over.chain(only_there).collect()
    }
}

/// How the decisions differ from those of another result: the worst ones of each joint.
pub(crate) fn against_text(against: &Against<'_>) -> String {
    /// Steps of a joint that are shown.
    const MOST: usize = 10;
    let mut text = format!("\nagainst {}:\n", against.title());
    let mut table = TextTable::new(["joint", "step", "p", "here", "there", "difference"], &[2]);
    let mut left_out = 0;
    for (joint, found) in &against.joints {
        for sentence in difference_sentences(found) {
            text += &format!("{joint}: {sentence}\n");
        }
        let has_trials =
            found.pairs.iter().any(|pair| pair.here.trial != found.pairs[0].here.trial);
        for pair in found.differing().take(MOST) {
            table.row([
                (*joint).to_owned(),
                step_name(&pair.here, has_trials),
                pair.here.p.to_string(),
                result_in_short(&pair.here),
                result_in_short(&pair.there),
                difference_in_short(pair),
            ]);
        }
        left_out += found.differing().count().saturating_sub(MOST);
    }
    if !table.rows.is_empty() {
        text += &format!("{table}\n");
    }
    if left_out > 0 {
        text += &format!("{left_out} smaller differences are in the JSON and in the recording\n");
    }
    text
}
