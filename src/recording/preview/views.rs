//! The views of what is to be played: a tab per joint.

use rerun::ApplicationId;
use rerun::external::re_sdk_types::blueprint::archetypes::TimeAxis;
use rerun::external::re_sdk_types::blueprint::components::{ContainerKind, LinkAxis, PlayState};
use rerun::log::LogMsg;

use super::recorded::PreviewRecording;
use super::sheet::SIZE;
use crate::recording::blueprint::{Builder, Node, View, clickable};
use crate::recording::error::RecordError;
use crate::recording::paths::{at, child, joint_root, preview as paths};
use crate::report::DesignedJoint;

/// The messages of the blueprint: a tab per joint, and one about it all.
pub(super) fn messages(
    preview: &PreviewRecording<'_>,
    application: &ApplicationId,
    id: &str,
) -> Result<Vec<LogMsg>, RecordError> {
    let mut builder = Builder::new(id);
    let mut tabs = Vec::new();
    for joint in preview.joints {
        tabs.push(tab(&mut builder, joint)?);
    }
    builder.tabbed(tabs, "About", ("time", PlayState::Paused), application)
}

/// The page of a joint and its signals; beside them what they distinguish, and the holds.
fn tab(builder: &mut Builder<'_>, joint: &DesignedJoint) -> Result<Node, RecordError> {
    let name = joint.rig.name.as_str();
    let root = joint_root(name);
    let path = |path: &str| at(&root, path).to_string();
    let sheet = at(&root, paths::sheet::ROOT);
    let page = View::drawing("What is expected", &sheet, &paths::sheet::PARTS, SIZE);
    let page = builder.view(page)?;
    let plot = |name, paths: &[String]| {
        let axis = TimeAxis::new().with_link(LinkAxis::LinkToGlobal);
        View::new("TimeSeries", name, paths).with("TimeAxis", axis)
    };
    let mut plots = vec![builder.view(plot("Input", &[path(paths::INPUT)]))?];
    let expected = joint.expected();
    if !expected.is_empty() {
        let expected = expected.iter().flat_map(|(name, _)| {
            let output = child(&at(&root, paths::EXPECTED), name);
            [paths::OUTPUT, paths::LOW, paths::HIGH].map(|part| at(&output, part).to_string())
        });
        let range = at(&root, paths::RANGE);
        let range = [paths::LOW, paths::HIGH].map(|part| at(&range, part).to_string());
        let outputs: Vec<String> = expected.chain(range).collect();
        plots.push(builder.view(plot("Expected output", &outputs))?);
    }
    if joint.discrimination.is_some() {
        plots.push(builder.view(plot("Difference over noise", &[path(paths::APART)]))?);
    }
    let signals = builder.container(ContainerKind::Vertical, "Signals", &plots, &[])?;
    let left = [page, signals];
    let left = builder.container(ContainerKind::Tabs, "Drawings", &left, &[])?;
    let text = |name, part| View::new("TextDocument", name, &[path(part)]);
    let says = builder.view(text("What it distinguishes, and how surely", paths::SAYS))?;
    let here = builder.view(text("Under the cursor", paths::HERE))?;
    let holds = View::new("TextLog", "Holds: click a time", &[path(paths::HOLDS)]);
    let holds = builder.view(holds.with("TextLogColumns", clickable("time")))?;
    let words = [says, here, holds];
    let words = builder.container(ContainerKind::Vertical, "Words", &words, &[5.2, 2.3, 2.5])?;
    builder.container(ContainerKind::Horizontal, name, &[left, words], &[7.0, 3.0])
}
