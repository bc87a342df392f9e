//! The views of a sweep: a tab per joint.

use rerun::ApplicationId;
use rerun::external::re_sdk_types::blueprint::components::{ContainerKind, PlayState};
use rerun::log::LogMsg;

use super::builder::{Builder, Node, View, bounds, clickable};
use crate::recording::entity::{below, joint_root};
use crate::recording::error::RecordError;
use crate::recording::sweep::{PARTS, SIZE, STEP_PARTS, STEP_SIZE, SweepRecording};

/// The messages of the blueprint: a tab per joint, and one about it all.
pub(in crate::recording) fn messages(
    sweep: &SweepRecording<'_>,
    application: &ApplicationId,
    id: &str,
) -> Result<Vec<LogMsg>, RecordError> {
    let mut builder = Builder::new();
    let mut tabs = Vec::new();
    for joint in sweep.joints {
        tabs.push(tab(&mut builder, &joint.joint.name)?);
    }
    tabs.push(builder.view(View::new("TextDocument", "About", &["/about"]))?);
    let root = builder.container(ContainerKind::Tabs, "Joints", &tabs, &[])?;
    builder.finish(&root, ("setting", PlayState::Paused), application, id)
}

/// All steps and one step; beside them what is found, what is under the cursor, and the
/// steps to look at.
fn tab(builder: &mut Builder, joint: &str) -> Result<Node, RecordError> {
    let path = |parts: &[&str]| below(&joint_root(joint), parts).to_string();
    let drawing = |root: &str, names: &[&str]| -> Vec<String> {
        let paths = names.iter().map(|name| {
            let parts: Vec<_> = std::iter::once(root).chain(name.split('/')).collect();
            path(&parts)
        });
        paths.collect()
    };
    let all = View::new("2D", "All steps", &drawing("sheet", &PARTS));
    let all = builder.view(all.with("VisualBounds2D", bounds(SIZE.0, SIZE.1)))?;
    let one = View::new("2D", "One step", &drawing("one", &STEP_PARTS));
    let one = builder.view(one.with("VisualBounds2D", bounds(STEP_SIZE.0, STEP_SIZE.1)))?;
    let drawings = builder.container(ContainerKind::Tabs, "Drawings", &[all, one], &[])?;
    let text = |name, part| View::new("TextDocument", name, &[path(&[part])]);
    let found = builder.view(text("What is found", "found"))?;
    let here = builder.view(text("Under the cursor", "here"))?;
    let list = "Steps that hang on a setting: click a number on the left";
    let list = View::new("TextLog", list, &[path(&["hanging", "log"])]);
    let list = builder.view(list.with("TextLogColumns", clickable("segment")))?;
    let words = [found, here, list];
    let words = builder.container(ContainerKind::Vertical, "Words", &words, &[5.0, 2.6, 2.4])?;
    builder.container(ContainerKind::Horizontal, joint, &[drawings, words], &[7.1, 2.9])
}
