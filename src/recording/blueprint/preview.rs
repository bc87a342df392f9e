//! The views of what is to be played: a tab per joint.

use rerun::ApplicationId;
use rerun::external::re_sdk_types::blueprint::archetypes::TimeAxis;
use rerun::external::re_sdk_types::blueprint::components::{ContainerKind, LinkAxis, PlayState};
use rerun::log::LogMsg;

use super::builder::{Builder, Node, View, bounds, clickable};
use crate::recording::entity::{below, joint_root};
use crate::recording::error::RecordError;
use crate::recording::preview::{PARTS, PreviewRecording, SIZE};
use crate::report::DesignedJoint;

/// The messages of the blueprint: a tab per joint, and one about it all.
pub(in crate::recording) fn messages(
    preview: &PreviewRecording<'_>,
    application: &ApplicationId,
    id: &str,
) -> Result<Vec<LogMsg>, RecordError> {
    let mut builder = Builder::new();
    let mut tabs = Vec::new();
    for joint in preview.joints {
        tabs.push(tab(&mut builder, joint)?);
    }
    tabs.push(builder.view(View::new("TextDocument", "About", &["/about"]))?);
    let root = builder.container(ContainerKind::Tabs, "Joints", &tabs, &[])?;
    builder.finish(&root, ("time", PlayState::Paused), application, id)
}

/// The page of a joint and its signals; beside them what they tell, and the holds.
fn tab(builder: &mut Builder, joint: &DesignedJoint) -> Result<Node, RecordError> {
    let name = joint.stand.name.as_str();
    let path = |parts: &[&str]| below(&joint_root(name), parts).to_string();
    let parts = PARTS.map(|part| {
        let parts: Vec<&str> = std::iter::once("sheet").chain(part.split('/')).collect();
        path(&parts)
    });
    let page = View::new("2D", "What is expected", &parts);
    let page = builder.view(page.with("VisualBounds2D", bounds(SIZE.0, SIZE.1)))?;
    let plot = |name, paths: &[String]| {
        let axis = TimeAxis::new().with_link(LinkAxis::LinkToGlobal);
        View::new("TimeSeries", name, paths).with("TimeAxis", axis)
    };
    let mut plots = vec![builder.view(plot("Input", &[path(&["input"])]))?];
    let expected = joint.expected();
    if !expected.is_empty() {
        let parts = ["output", "low", "high"];
        let expected = expected.iter().flat_map(|(name, _)| parts.map(|part| (*name, part)));
        let outputs = expected.map(|(name, part)| path(&["expected", name, part]));
        let range = ["low", "high"].map(|part| path(&["range", part]));
        let outputs: Vec<String> = outputs.chain(range).collect();
        plots.push(builder.view(plot("Expected output", &outputs))?);
    }
    if joint.told.is_some() {
        plots.push(builder.view(plot("Difference over noise", &[path(&["apart"])]))?);
    }
    let signals = builder.container(ContainerKind::Vertical, "Signals", &plots, &[])?;
    let left = [page, signals];
    let left = builder.container(ContainerKind::Tabs, "Drawings", &left, &[])?;
    let text = |name, part| View::new("TextDocument", name, &[path(&[part])]);
    let says = builder.view(text("What it tells, and how surely", "says"))?;
    let here = builder.view(text("Under the cursor", "here"))?;
    let holds = View::new("TextLog", "Holds: click a time", &[path(&["holds"])]);
    let holds = builder.view(holds.with("TextLogColumns", clickable("time")))?;
    let words = [says, here, holds];
    let words = builder.container(ContainerKind::Vertical, "Words", &words, &[5.2, 2.3, 2.5])?;
    builder.container(ContainerKind::Horizontal, name, &[left, words], &[7.0, 3.0])
}
