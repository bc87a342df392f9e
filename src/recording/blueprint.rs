//! Blueprints with view properties, which Rerun's own builder does not make.
//!
//! A blueprint is a recording of its own: `view/<id>` and `container/<id>` hold what the
//! viewer shows, `viewport` the root.

use rerun::datatypes::{Range2D, TimeRange, TimeRangeBoundary, Utf8};
use rerun::external::re_sdk_types::blueprint::archetypes::{
    ContainerBlueprint, PanelBlueprint, TextLogColumns, TimeAxis, TimePanelBlueprint,
    ViewBlueprint, ViewContents, ViewportBlueprint, VisualBounds2D,
};
use rerun::external::re_sdk_types::blueprint::components::{
    ContainerKind, IncludedContent, PanelState, PlayState, QueryExpression, RootContainer,
};
use rerun::external::re_sdk_types::blueprint::datatypes::{
    TextLogColumn, TextLogColumnKind, TimelineColumn,
};
use rerun::external::uuid::Uuid;
use rerun::log::LogMsg;
use sha2::{Digest as _, Sha256};

use rerun::{ApplicationId, AsComponents, EntityPath, StoreId, StoreKind};

use super::chunk::{Chunks, Ids};
use super::error::RecordError;
use super::message::{chunk_message, store_message};
use super::paths::{ABOUT, at};

/// Namespace of the blueprint's rows; it is a store of its own.
const NAMESPACE: u64 = 1;

/// Where the viewer keeps the axis that linked plots share (a fixed id of its own).
const LINKED_TIME_AXIS: &str = "view/5c0dca6a-e63f-9cf7-f657-2602590474cc/TimeAxis";

/// Collects views and containers.
pub(super) struct Builder<'i> {
    /// The recording's, from which those of views and containers are made.
    id: &'i str,
    chunks: Chunks,
    nodes: u64,
}

/// A view or a container that was added.
#[derive(Clone, Debug)]
pub(super) struct Node {
    id: Uuid,
    path: String,
}

/// What a view shows, and how.
pub(super) struct View<'a> {
    class: &'static str,
    name: &'a str,
    contents: Vec<QueryExpression>,
    properties: Vec<(&'static str, Box<dyn AsComponents>)>,
}

impl<'a> View<'a> {
    /// A view of Rerun's class `class` on the entities `paths`.
    pub(super) fn new<S: AsRef<str>>(class: &'static str, name: &'a str, paths: &[S]) -> Self {
        let contents = paths.iter().map(|path| QueryExpression::from(path.as_ref())).collect();
        Self { class, name, contents, properties: Vec::new() }
    }

    /// A drawing: all of a sheet, whose parts lie below `root`, is in view.
    pub(super) fn drawing(
        name: &'a str,
        root: &EntityPath,
        parts: &[&str],
        (width, height): (f32, f32),
    ) -> Self {
        let paths: Vec<_> = parts.iter().map(|part| at(root, part).to_string()).collect();
        Self::new("2D", name, &paths).with("VisualBounds2D", bounds(width, height))
    }

    /// Sets a property, such as `VisualBounds2D`.
    pub(super) fn with(mut self, name: &'static str, value: impl AsComponents + 'static) -> Self {
        self.properties.push((name, Box::new(value)));
        self
    }
}

impl<'i> Builder<'i> {
    /// Views of the recording `id`.
    pub(super) fn new(id: &'i str) -> Self {
        Self { id, chunks: Ids::of(&store(id)).chunks(NAMESPACE), nodes: 0 }
    }

    fn node(&mut self, kind: &str) -> Node {
        self.nodes += 1;
        // The same in every run, and none of another recording's: a viewer keeps what it knows
        // of a view by its id alone.
        let digest = Sha256::digest(format!("{} {}", self.id, self.nodes));
        let mut bytes = [0; 16];
        bytes.iter_mut().zip(digest).for_each(|(to, byte)| *to = byte);
        let id = Uuid::from_bytes(bytes);
        Node { id, path: format!("{kind}/{id}") }
    }

    fn log(&mut self, path: &str, data: &dyn AsComponents) -> Result<(), RecordError> {
        self.chunks.push_blueprint(EntityPath::from(path), data)
    }

    pub(super) fn view(&mut self, view: View<'_>) -> Result<Node, RecordError> {
        let node = self.node("view");
        let path = &node.path;
        self.log(&format!("{path}/ViewContents"), &ViewContents::new(view.contents))?;
        self.log(path, &ViewBlueprint::new(view.class).with_display_name(view.name))?;
        for (property, value) in view.properties {
            self.log(&format!("{path}/{property}"), value.as_ref())?;
        }
        Ok(node)
    }

    /// Tabs, of which one is open.
    fn tabs(&mut self, name: &str, tabs: &[Node], open: &Node) -> Result<Node, RecordError> {
        let node = self.node("container");
        let contents = tabs.iter().map(|tab| IncludedContent::from(tab.path.clone()));
        let container = ContainerBlueprint::new(ContainerKind::Tabs).with_display_name(name);
        let container = container.with_contents(contents).with_active_tab(open.path.clone());
        self.log(&node.path, &container)?;
        Ok(node)
    }

    /// A container; `shares` are the parts of its height or width, or none.
    pub(super) fn container(
        &mut self,
        kind: ContainerKind,
        name: &str,
        children: &[Node],
        shares: &[f32],
    ) -> Result<Node, RecordError> {
        if let (ContainerKind::Tabs, Some(first)) = (kind, children.first()) {
            return self.tabs(name, children, first);
        }
        let node = self.node("container");
        let contents = children.iter().map(|child| IncludedContent::from(child.path.clone()));
        let mut container =
            ContainerBlueprint::new(kind).with_display_name(name).with_contents(contents);
        let shares = shares.iter().copied();
        container = match kind {
            ContainerKind::Horizontal => container.with_col_shares(shares),
            ContainerKind::Vertical => container.with_row_shares(shares),
            ContainerKind::Tabs | ContainerKind::Grid => container,
        };
        self.log(&node.path, &container)?;
        Ok(node)
    }

    /// The messages of a blueprint of `tabs`, a page on all of it, called `name`, being the last
    /// one, which opens on a timeline.
    pub(super) fn tabbed(
        mut self,
        mut tabs: Vec<Node>,
        name: &str,
        opening: (&str, PlayState),
        application: &ApplicationId,
    ) -> Result<Vec<LogMsg>, RecordError> {
        /// Tabs that a screen has room for: behind more of them nobody finds the page on all.
        const SEEN: usize = 10;
        let about = EntityPath::from(ABOUT).to_string();
        let about = self.view(View::new("TextDocument", name, &[about]))?;
        let place = if tabs.len() > SEEN { 0 } else { tabs.len() };
        let opening_tab = tabs.first().unwrap_or(&about).clone();
        tabs.insert(place, about);
        let root = self.tabs("Joints", &tabs, &opening_tab)?;
        self.finish(&root, opening, application)
    }

    /// The messages of the whole blueprint, which opens on `timeline`.
    fn finish(
        mut self,
        root: &Node,
        (timeline, play): (&str, PlayState),
        application: &ApplicationId,
    ) -> Result<Vec<LogMsg>, RecordError> {
        let root = rerun::datatypes::Uuid { bytes: *root.id.as_bytes() };
        let viewport = ViewportBlueprint::new().with_root_container(RootContainer(root));
        self.log("viewport", &viewport.with_auto_layout(false).with_auto_views(false))?;
        let collapsed = PanelBlueprint::new().with_state(PanelState::Collapsed);
        self.log("blueprint_panel", &collapsed)?;
        self.log("selection_panel", &collapsed)?;
        let time = TimePanelBlueprint::new()
            .with_state(PanelState::Collapsed)
            .with_timeline(timeline)
            .with_fps(20.0)
            .with_play_state(play);
        self.log("time_panel", &time)?;
        // Plots with a linked time axis start with all of it in view.
        let infinite = TimeRangeBoundary::Infinite;
        let all = TimeRange { start: infinite, end: infinite };
        self.log(LINKED_TIME_AXIS, &TimeAxis::new().with_view_range(all))?;
        let store = StoreId::new(StoreKind::Blueprint, application.clone(), store(self.id));
        let chunks = self.chunks.into_chunks();
        let messages = chunks.iter().map(|chunk| chunk_message(&store, chunk));
        std::iter::once(Ok(store_message(&store))).chain(messages).collect()
    }
}

/// The id of the store that holds the views of the recording `id`.
fn store(id: &str) -> String {
    format!("{id}-views")
}

/// All of a sheet in view.
pub(super) fn bounds(width: f32, height: f32) -> VisualBounds2D {
    let (width, height) = (f64::from(width), f64::from(height));
    VisualBounds2D::new(Range2D { x_range: [0.0, width].into(), y_range: [0.0, height].into() })
}

/// Lines that lead to their places on `timeline`.
pub(super) fn clickable(timeline: &str) -> TextLogColumns {
    let timeline = TimelineColumn { visible: true.into(), timeline: Utf8::from(timeline) };
    let body = TextLogColumn { visible: true.into(), kind: TextLogColumnKind::Body };
    TextLogColumns::new().with_timeline_columns([timeline]).with_text_log_columns([body])
}
