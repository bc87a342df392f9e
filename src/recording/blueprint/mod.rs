//! Which view shows what: tabs, panels, and the timeline the viewer opens on.

mod builder;
mod joint;

use rerun::ApplicationId;
use rerun::external::re_sdk_types::blueprint::components::ContainerKind;
use rerun::log::LogMsg;

use self::builder::{Builder, View};
use super::Recording;
use super::error::RecordError;

/// The messages of the blueprint of `recording`: a tab per joint and one about it all.
pub(super) fn messages(
    recording: &Recording<'_>,
    application: &ApplicationId,
    id: &str,
) -> Result<Vec<LogMsg>, RecordError> {
    let mut builder = Builder::new();
    let mut tabs = Vec::new();
    for joint in recording.joints {
        let models = recording.models.iter().filter(|m| m.joint.name == joint.joint.name);
        let models: Vec<_> = models.map(|model| model.model).collect();
        let improved = recording.revisions_of(joint.joint);
        let others = recording.others(joint.joint).len();
        let revisions = improved.map_or(0, |improved| improved.revisions.len());
        tabs.push(joint::tab(&mut builder, *joint, &models, revisions, others)?);
    }
    tabs.push(builder.view(View::new("TextDocument", "About", &["/about"]))?);
    let root = builder.container(ContainerKind::Tabs, "Joints", &tabs, &[])?;
    // One revision alone is there on every timeline.
    let is_ladder = recording.revisions.iter().any(|improved| improved.revisions.len() > 1);
    let timeline = if is_ladder { "revision" } else { "decision" };
    builder.finish(&root, timeline, application, id)
}
