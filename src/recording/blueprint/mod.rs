//! Which view shows what: tabs, panels, and the timeline the viewer opens on.

mod builder;
mod joint;
mod preview;
mod sweep;

use rerun::ApplicationId;
use rerun::external::re_sdk_types::blueprint::components::{ContainerKind, PlayState};
use rerun::log::LogMsg;

use self::builder::{Builder, View};
pub(super) use self::preview::messages as preview_messages;
pub(super) use self::sweep::messages as sweep_messages;
use super::Recording;
use super::error::RecordError;

/// Whether more revisions are to come.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Ladder {
    Finished,
    /// Every joint will have some; the viewer goes along with them.
    Growing,
}

/// What decides which views there are.
pub(super) fn in_words(recording: &Recording<'_>, ladder: Ladder) -> String {
    let joints: Vec<_> = recording.joints.iter().map(|joint| &joint.joint.name).collect();
    let models: Vec<_> = recording.models.iter().map(|m| (&m.joint.name, m.model)).collect();
    let counted = recording.revisions.iter().map(|improved| improved.revisions.len().min(2));
    match ladder {
        Ladder::Growing => format!("{joints:?} {models:?}"),
        Ladder::Finished => format!("{joints:?} {models:?} {:?}", counted.collect::<Vec<_>>()),
    }
}

/// The messages of the blueprint of `recording`: a tab per joint and one about it all.
pub(super) fn messages(
    recording: &Recording<'_>,
    ladder: Ladder,
    application: &ApplicationId,
    id: &str,
) -> Result<Vec<LogMsg>, RecordError> {
    let mut builder = Builder::new();
    let mut tabs = Vec::new();
    for joint in recording.joints {
        let models = recording.models.iter().filter(|m| m.joint.name == joint.joint.name);
        let models: Vec<_> = models.collect();
        let improved = recording.revisions_of(joint.joint);
        // The first one is on its way, at least.
        let expected = usize::from(ladder == Ladder::Growing);
        let revisions = improved.map_or(expected, |improved| improved.revisions.len());
        let others = recording.others(joint.joint).len();
        tabs.push(joint::tab(&mut builder, *joint, &models, revisions, others)?);
    }
    tabs.push(builder.view(View::new("TextDocument", "About", &["/about"]))?);
    let root = builder.container(ContainerKind::Tabs, "Joints", &tabs, &[])?;
    // One revision alone is there on every timeline.
    let is_ladder = recording.revisions.iter().any(|improved| improved.revisions.len() > 1);
    let opening = match ladder {
        Ladder::Growing => ("revision", PlayState::Following),
        Ladder::Finished if is_ladder => ("revision", PlayState::Paused),
        Ladder::Finished => ("decision", PlayState::Paused),
    };
    builder.finish(&root, opening, application, id)
}
