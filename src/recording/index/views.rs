//! The views of the recording that stands before many.

use rerun::ApplicationId;
use rerun::external::re_sdk_types::blueprint::components::{ContainerKind, PlayState};
use rerun::log::LogMsg;

use rerun::EntityPath;

use crate::recording::blueprint::{Builder, View, clickable};
use crate::recording::error::RecordError;
use crate::recording::paths::{at, drawing, index};
use crate::recording::segment_view;

/// One page, and the one about it all; `interval` is what intervals of delays are drawn by.
pub(super) fn messages(
    interval: Option<&str>,
    application: &ApplicationId,
    id: &str,
) -> Result<Vec<LogMsg>, RecordError> {
    let mut builder = Builder::new(id);
    let root = EntityPath::from(index::ROOT);
    let path = |path: &str| at(&root, path).to_string();
    let parts: Vec<_> = drawing::PARTS.into_iter().chain(interval).collect();
    let name = "The segment, the chosen lines, what they leave, the squared errors";
    let drawing = View::drawing(name, &at(&root, drawing::ROOT), &parts, segment_view::SIZE);
    let drawing = builder.view(drawing)?;
    let joints = View::new("TextDocument", "Joints", &[index::JOINTS]);
    let joints = builder.view(joints)?;
    let list = "Most doubtful of all joints first: click a number";
    let list = View::new("TextLog", list, &[path(index::LOG)]);
    let list = builder.view(list.with("TextLogColumns", clickable("doubt")))?;
    let verdict = View::new("TextDocument", "Verdict", &[path(index::VERDICT)]);
    let verdict = builder.view(verdict)?;
    let left = [list, drawing];
    let left = builder.container(ContainerKind::Vertical, "Decisions", &left, &[3.2, 6.8])?;
    let right = [joints, verdict];
    let right = builder.container(ContainerKind::Vertical, "Words", &right, &[4.0, 6.0])?;
    let columns = [left, right];
    let name = "Joints and doubtful decisions";
    let page = builder.container(ContainerKind::Horizontal, name, &columns, &[6.2, 3.8])?;
    builder.tabbed(vec![page], "About", ("doubt", PlayState::Paused), application)
}
