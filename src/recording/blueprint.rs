//! Blueprints with view properties, which Rerun's own builder does not make.
//!
//! What is shown is a tree of [`Page`]s. A blueprint is a recording of its own: `view/<id>` and
//! `container/<id>` hold what the viewer shows, `viewport` the root.

use rerun::datatypes::{Range2D, TimeRange, TimeRangeBoundary, Utf8};
use rerun::external::re_sdk_types::blueprint::archetypes::{
    ContainerBlueprint, PanelBlueprint, TextLogColumns, TimeAxis, TimePanelBlueprint,
    ViewBlueprint, ViewContents, ViewportBlueprint, VisualBounds2D,
};
use rerun::external::re_sdk_types::blueprint::components::{
    ContainerKind, IncludedContent, LinkAxis, PanelState, PlayState, QueryExpression, RootContainer,
};
use rerun::external::re_sdk_types::blueprint::datatypes::{
    TextLogColumn, TextLogColumnKind, TimelineColumn,
};
use rerun::external::uuid::Uuid;
use rerun::log::LogMsg;
use rerun::{ApplicationId, AsComponents, EntityPath, StoreId, StoreKind};
use sha2::{Digest as _, Sha256};

use super::chunk::{Chunks, Ids, Index, chunk_message, store_message};
use super::error::RecordError;
use super::paths::ABOUT;

/// Namespace of the blueprint's rows; it is a store of its own.
const NAMESPACE: u64 = 1;

/// Where the viewer keeps the axis that linked plots share (a fixed id of its own).
const LINKED_TIME_AXIS: &str = "view/5c0dca6a-e63f-9cf7-f657-2602590474cc/TimeAxis";

/// A view, or several beside, below or behind one another.
pub(super) enum Page {
    /// A view of one of Rerun's classes on some entities, with properties.
    View {
        class: &'static str,
        name: String,
        contents: Vec<String>,
        /// Width and height of the sheet of a drawing, all of which is in view at first.
        sheet: Option<(f32, f32)>,
        properties: Vec<(&'static str, Box<dyn AsComponents>)>,
    },
    /// Pages with the parts that they have of its height or width.
    Container { kind: ContainerKind, name: String, pages: Vec<(f32, Self)> },
}

impl Page {
    pub(super) fn view<P: ToString>(
        class: &'static str,
        name: impl Into<String>,
        contents: impl IntoIterator<Item = P>,
    ) -> Self {
        let contents = contents.into_iter().map(|path| path.to_string()).collect();
        Self::View { class, name: name.into(), contents, sheet: None, properties: Vec::new() }
    }

    /// A text.
    pub(super) fn text(name: impl Into<String>, entity: EntityPath) -> Self {
        Self::view("TextDocument", name, [entity])
    }

    /// Lines with numbers on `timeline` that lead there.
    pub(super) fn list(name: impl Into<String>, entity: EntityPath, timeline: &str) -> Self {
        let timeline = TimelineColumn { visible: true.into(), timeline: Utf8::from(timeline) };
        let body = TextLogColumn { visible: true.into(), kind: TextLogColumnKind::Body };
        let columns = TextLogColumns::new().with_timeline_columns([timeline]);
        let columns = columns.with_text_log_columns([body]);
        Self::view("TextLog", name, [entity]).with("TextLogColumns", columns)
    }

    /// A drawing, which is all that lies below `root`: the whole sheet is in view.
    pub(super) fn drawing(name: impl Into<String>, root: &EntityPath, size: (f32, f32)) -> Self {
        let mut view = Self::view("2D", name, [format!("{root}/**")]);
        if let Self::View { sheet, .. } = &mut view {
            *sheet = Some(size);
        }
        view
    }

    /// Scalars over a time axis that moves with those of all other plots.
    pub(super) fn plot(name: impl Into<String>, entities: &[EntityPath]) -> Self {
        let axis = TimeAxis::new().with_link(LinkAxis::LinkToGlobal);
        Self::view("TimeSeries", name, entities).with("TimeAxis", axis)
    }

    /// Lanes of states, which start with all of the record in view: viewers from 0.41 on begin in its
    /// middle.
    pub(super) fn lanes(name: impl Into<String>, entities: &[EntityPath]) -> Self {
        Self::view("StateTimeline", name, entities).with("TimeAxis", whole_record())
    }

    /// How large each drawing is shown, by its name, where the page has so many points.
    #[cfg(test)]
    pub(super) fn scales(&self, (width, height): (f32, f32)) -> Vec<(String, f32)> {
        /// Height of the bar with the name of a view, or with tabs.
        const BAR: f32 = 25.0;
        match self {
            Self::View { name, sheet, .. } => {
                let scale = |(w, h): &(f32, f32)| (width / w).min((height - BAR) / h);
                sheet.iter().map(|size| (name.clone(), scale(size))).collect()
            }
            Self::Container { kind, pages, .. } => {
                let all: f32 = pages.iter().map(|(share, _)| share).sum();
                let of_page = |(share, page): &(f32, Self)| match (kind, page) {
                    (ContainerKind::Horizontal, _) => page.scales((width * share / all, height)),
                    (ContainerKind::Vertical, _) => page.scales((width, height * share / all)),
                    // The name of a view is its tab.
                    (_, Self::View { .. }) => page.scales((width, height)),
                    _ => page.scales((width, height - BAR)),
                };
                pages.iter().flat_map(of_page).collect()
            }
        }
    }

    /// Sets a property of a view, such as `VisualBounds2D`.
    pub(super) fn with(mut self, name: &'static str, value: impl AsComponents + 'static) -> Self {
        if let Self::View { properties, .. } = &mut self {
            properties.push((name, Box::new(value)));
        }
        self
    }

    /// This view without some of the entities.
    pub(super) fn without(mut self, entities: impl IntoIterator<Item = EntityPath>) -> Self {
        if let Self::View { contents, .. } = &mut self {
            contents.extend(entities.into_iter().map(|entity| format!("- {entity}")));
        }
        self
    }

    /// Pages beside one another, with their shares of the width.
    pub(super) fn beside(
        name: impl Into<String>,
        pages: impl IntoIterator<Item = (f32, Self)>,
    ) -> Self {
        let pages = pages.into_iter().collect();
        Self::Container { kind: ContainerKind::Horizontal, name: name.into(), pages }
    }

    /// Pages below one another, with their shares of the height.
    pub(super) fn stacked(
        name: impl Into<String>,
        pages: impl IntoIterator<Item = (f32, Self)>,
    ) -> Self {
        let pages = pages.into_iter().collect();
        Self::Container { kind: ContainerKind::Vertical, name: name.into(), pages }
    }

    /// Pages in tabs, of which the first one is open.
    pub(super) fn tabs(name: impl Into<String>, pages: impl IntoIterator<Item = Self>) -> Self {
        let pages = pages.into_iter().map(|page| (1.0, page)).collect();
        Self::Container { kind: ContainerKind::Tabs, name: name.into(), pages }
    }
}

/// All that a viewer shows of a recording.
pub(super) struct Blueprint {
    pub(super) tabs: Vec<Page>,
    /// What the page on all of it is called: the last tab.
    pub(super) about: String,
    /// The timeline that it opens on.
    pub(super) timeline: &'static str,
}

impl Blueprint {
    /// Its messages, for the recording `id`.
    pub(super) fn messages(
        self,
        application: &ApplicationId,
        id: &str,
    ) -> Result<Vec<LogMsg>, RecordError> {
        /// Tabs that a screen has room for: after more of them nobody finds the page on all.
        const SEEN: usize = 10;
        let store = format!("{id}-views");
        let mut builder = Builder { id, chunks: Ids::of(&store).chunks(NAMESPACE), nodes: 0 };
        let mut tabs =
            self.tabs.into_iter().map(|tab| builder.add(tab)).collect::<Result<Vec<_>, _>>()?;
        let about = builder.add(Page::text(self.about, EntityPath::from(ABOUT)))?;
        let open = tabs.first().unwrap_or(&about).clone();
        let place = if tabs.len() > SEEN { 0 } else { tabs.len() };
        tabs.insert(place, about);
        let root = builder.tabs("Joints", &tabs, &open)?;
        let root = rerun::datatypes::Uuid { bytes: *root.id.as_bytes() };
        let viewport = ViewportBlueprint::new().with_root_container(RootContainer(root));
        builder.log("viewport", &viewport.with_auto_layout(false).with_auto_views(false))?;
        let collapsed = PanelBlueprint::new().with_state(PanelState::Collapsed);
        builder.log("blueprint_panel", &collapsed)?;
        builder.log("selection_panel", &collapsed)?;
        let time = TimePanelBlueprint::new()
            .with_state(PanelState::Collapsed)
            .with_timeline(self.timeline)
            .with_fps(20.0)
            // So that the first arrow moves the cursor: at the tick that shows the last one.
            .with_play_state(PlayState::Paused);
        builder.log("time_panel", &time)?;
        builder.log(LINKED_TIME_AXIS, &whole_record())?;
        let store = StoreId::new(StoreKind::Blueprint, application.clone(), store);
        let chunks = builder.chunks.into_chunks();
        let messages = chunks.iter().map(|chunk| chunk_message(&store, chunk));
        std::iter::once(Ok(store_message(&store))).chain(messages).collect()
    }
}

/// A time axis that starts with all of the record in view.
fn whole_record() -> TimeAxis {
    let infinite = TimeRangeBoundary::Infinite;
    TimeAxis::new().with_view_range(TimeRange { start: infinite, end: infinite })
}

/// Collects views and containers.
struct Builder<'i> {
    /// The recording's, from which those of views and containers are made.
    id: &'i str,
    chunks: Chunks,
    nodes: u64,
}

/// A view or a container that was added.
#[derive(Clone, Debug)]
struct Node {
    id: Uuid,
    path: String,
}

impl Builder<'_> {
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
        // One row on the timeline of blueprints, by which the viewer knows them.
        let columns = data.as_serialized_batches().into_iter().map(Into::into);
        self.chunks.push(EntityPath::from(path), Index::on("blueprint", [0]), columns)
    }

    fn add(&mut self, page: Page) -> Result<Node, RecordError> {
        match page {
            Page::View { class, name, contents, sheet, properties } => {
                let node = self.node("view");
                let path = &node.path;
                let contents = contents.iter().map(|query| QueryExpression::from(query.as_str()));
                self.log(&format!("{path}/ViewContents"), &ViewContents::new(contents))?;
                self.log(path, &ViewBlueprint::new(class).with_display_name(name))?;
                if let Some((width, height)) = sheet {
                    let range = |end: f32| [0.0, f64::from(end)].into();
                    let (x_range, y_range) = (range(width), range(height));
                    let bounds = VisualBounds2D::new(Range2D { x_range, y_range });
                    self.log(&format!("{path}/VisualBounds2D"), &bounds)?;
                }
                for (property, value) in properties {
                    self.log(&format!("{path}/{property}"), value.as_ref())?;
                }
                Ok(node)
            }
            Page::Container { kind, name, pages } => {
                let (shares, pages): (Vec<f32>, Vec<Page>) = pages.into_iter().unzip();
                let nodes =
                    pages.into_iter().map(|page| self.add(page)).collect::<Result<Vec<_>, _>>()?;
                if let (ContainerKind::Tabs, Some(first)) = (kind, nodes.first()) {
                    return self.tabs(&name, &nodes, first);
                }
                let container = ContainerBlueprint::new(kind);
                let container = match kind {
                    ContainerKind::Horizontal => container.with_col_shares(shares),
                    _ => container.with_row_shares(shares),
                };
                self.container(&name, &nodes, container)
            }
        }
    }

    /// Tabs, of which one is open.
    fn tabs(&mut self, name: &str, tabs: &[Node], open: &Node) -> Result<Node, RecordError> {
        let container = ContainerBlueprint::new(ContainerKind::Tabs);
        self.container(name, tabs, container.with_active_tab(open.path.clone()))
    }

    fn container(
        &mut self,
        name: &str,
        nodes: &[Node],
        container: ContainerBlueprint,
    ) -> Result<Node, RecordError> {
        let node = self.node("container");
        let contents = nodes.iter().map(|child| IncludedContent::from(child.path.clone()));
        self.log(&node.path, &container.with_display_name(name).with_contents(contents))?;
        Ok(node)
    }
}
