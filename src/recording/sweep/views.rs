//! The views of a sweep: a tab per joint.

use rerun::ApplicationId;
use rerun::external::re_sdk_types::blueprint::components::{ContainerKind, PlayState};
use rerun::log::LogMsg;

use super::recorded::SweepRecording;
use super::{sheet, step};
use crate::recording::blueprint::{Builder, Node, View, clickable};
use crate::recording::error::RecordError;
use crate::recording::paths::{at, joint_root, sweep as paths};

/// The messages of the blueprint: a tab per joint, and one about it all.
pub(super) fn messages(
    sweep: &SweepRecording<'_>,
    application: &ApplicationId,
    id: &str,
) -> Result<Vec<LogMsg>, RecordError> {
    let mut builder = Builder::new(id);
    let mut tabs = Vec::new();
    for joint in sweep.joints {
        tabs.push(tab(&mut builder, &joint.joint.name)?);
    }
    builder.tabbed(tabs, "About", ("setting", PlayState::Paused), application)
}

/// All steps and one step; beside them what is found, what is under the cursor, and the
/// steps to look at.
fn tab(builder: &mut Builder<'_>, joint: &str) -> Result<Node, RecordError> {
    let root = joint_root(joint);
    let path = |path: &str| at(&root, path).to_string();
    let all = at(&root, paths::sheet::ROOT);
    let all = View::drawing("All steps", &all, &paths::sheet::PARTS, sheet::SIZE);
    let all = builder.view(all)?;
    let one = at(&root, paths::one::ROOT);
    let one = View::drawing("One step", &one, &paths::one::PARTS, step::SIZE);
    let one = builder.view(one)?;
    let drawings = builder.container(ContainerKind::Tabs, "Drawings", &[all, one], &[])?;
    let text = |name, part| View::new("TextDocument", name, &[path(part)]);
    let found = builder.view(text("What is found", paths::FOUND))?;
    let here = builder.view(text("Under the cursor", paths::HERE))?;
    let list = "Steps sensitive to a setting: click a number on the left";
    let list = View::new("TextLog", list, &[path(paths::SENSITIVE_LOG)]);
    let list = builder.view(list.with("TextLogColumns", clickable("segment")))?;
    let words = [found, here, list];
    let words = builder.container(ContainerKind::Vertical, "Words", &words, &[5.0, 2.6, 2.4])?;
    builder.container(ContainerKind::Horizontal, joint, &[drawings, words], &[7.1, 2.9])
}
