//! The views of a recording: a tab per joint, and the timeline the viewer opens on.

use rerun::ApplicationId;
use rerun::external::re_sdk_types::blueprint::components::PlayState;
use rerun::log::LogMsg;

use super::joint;
use crate::recording::blueprint::Builder;
use crate::recording::content::Growth;
use crate::recording::error::RecordError;
use crate::recording::recorded::Recording;
use crate::report::{EstimatedJoint, JointSummary, doubtful_lines};

/// What decides which views there are.
pub(in crate::recording) fn in_words(recording: &Recording<'_>, growth: Growth) -> String {
    let name = |joint: &EstimatedJoint<'_>| match joint.estimate.dead_time {
        Some(_) => format!("{} without steps", joint.joint.name),
        None => joint.joint.name.clone(),
    };
    let joints: Vec<_> = recording.joints.iter().map(name).collect();
    let models: Vec<_> = recording.models.iter().map(|m| (&m.joint.name, m.model)).collect();
    let counted = recording.revisions.iter().map(|improved| improved.revisions.len().min(2));
    match growth {
        Growth::Growing => format!("{joints:?} {models:?}"),
        Growth::Finished => format!("{joints:?} {models:?} {:?}", counted.collect::<Vec<_>>()),
    }
}

/// The messages of the blueprint of `recording`: a tab per joint and one about it all.
pub(in crate::recording) fn messages(
    recording: &Recording<'_>,
    growth: Growth,
    application: &ApplicationId,
    id: &str,
) -> Result<Vec<LogMsg>, RecordError> {
    let mut builder = Builder::new(id);
    let mut tabs = Vec::new();
    for joint in recording.joints {
        let models = recording.models.iter().filter(|m| m.joint.name == joint.joint.name);
        let models: Vec<_> = models.collect();
        let improved = recording.revisions_of(joint.joint);
        // The first one is on its way, at least.
        let expected = usize::from(growth == Growth::Growing);
        let revisions = improved.map_or(expected, |improved| improved.revisions.len());
        let others =
            recording.also.iter().filter(|it| it.joint(&joint.joint.name).is_some()).count();
        tabs.push(joint::tab(&mut builder, *joint, &models, revisions, others)?);
    }
    // One revision alone is there on every timeline.
    let is_ladder = recording.revisions.iter().any(|improved| improved.revisions.len() > 1);
    let has_steps = recording.joints.iter().any(|joint| joint.estimate.dead_time.is_none());
    let opening = match growth {
        Growth::Growing => ("revision", PlayState::Following),
        // Paused, so that the first arrow moves the cursor: at the tick that shows the last one.
        Growth::Finished if is_ladder => ("revision", PlayState::Paused),
        Growth::Finished if !recording.also.is_empty() => ("difference", PlayState::Paused),
        // A model is seen along its record.
        Growth::Finished if !has_steps || !recording.models.is_empty() => {
            ("time", PlayState::Paused)
        }
        Growth::Finished => ("decision", PlayState::Paused),
    };
    builder.tabbed(tabs, &about(recording, growth), opening, application)
}

/// The name of the page on it all: of one joint how many steps were accepted, of several how many
/// decisions are doubtful, which no page of a joint says.
fn about(recording: &Recording<'_>, growth: Growth) -> String {
    let doubtful = match growth {
        Growth::Finished => doubtful_lines(recording.joints).len(),
        Growth::Growing => 0,
    };
    match (recording.joints.len(), doubtful) {
        (0 | 1, _) => match recording.joints.first().map(|joint| JointSummary::of(*joint)) {
            Some(JointSummary { steps, accepted, .. }) if steps > 0 => {
                format!("About: {accepted} of {steps} accepted")
            }
            _ => "About".to_owned(),
        },
        (_, 0) if growth == Growth::Growing => "All joints".to_owned(),
        (_, 0) if !recording.joints.iter().any(has_decisions) => {
            "All joints: no decisions".to_owned()
        }
        (_, 0) => "All joints: none doubtful".to_owned(),
        (_, doubtful) => format!("All joints: {doubtful} doubtful"),
    }
}

fn has_decisions(joint: &EstimatedJoint<'_>) -> bool {
    joint.estimate.estimated().any(|trial| !trial.decisions.is_empty())
}
