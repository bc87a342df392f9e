//! The recording that stands before many: a table of all joints with the file that each is in,
//! and the most doubtful decisions of all of them. It is small, and there at once.

use rerun::EntityPath;
use rerun::external::re_sdk_types::blueprint::components::PlayState;

use super::about;
use super::blueprint::{Blueprint, Page};
use super::chunk::{Chunks, Index};
use super::content::{Content, Growth, Tab, hashed, name_of};
use super::error::RecordError;
use super::layers::Layers;
use super::layout::{JointLayout, SegmentLayout, TrialLayout, TrialStarts};
use super::markdown::{link, plain};
use super::paths::{self, at};
use super::segment_view;
use super::verdict;
use crate::report::estimate::{SUMMARY_HEADER, summary_cells};
use crate::report::{EstimatedJoint, JointSummary, Recording, TextTable};
use crate::wording::doubt_percent;

/// What lies below it: the drawing and the verdict of a decision, and the list of all.
const ROOT: &str = "doubtful";

/// The table of all joints.
const JOINTS: &str = "joints";

/// A file with some of the joints.
#[derive(Clone, Debug)]
pub(crate) struct Volume {
    /// Its name without folder.
    pub(crate) file: String,
    /// How many joints are in it: those after the joints of the files before it.
    pub(crate) joints: usize,
}

/// All joints, and the files that they are in.
#[derive(Clone, Copy, Debug)]
pub(crate) struct IndexRecording<'a> {
    /// All of it, as if it were in one file.
    pub(crate) all: &'a Recording<'a>,
    /// The files in the order of the joints.
    pub(crate) volumes: &'a [Volume],
}

impl IndexRecording<'_> {
    fn layouts(&self) -> Vec<JointLayout<'_>> {
        let starts = TrialStarts::of(self.all.joints.iter().map(|joint| joint.joint));
        let layout = |joint: &_| JointLayout::of(*joint, &starts, (self.all.detail, None), 0);
        self.all.joints.iter().map(layout).collect()
    }

    /// The name of the file that the joint at `index` is in.
    fn file_of(&self, index: usize) -> &str {
        let mut behind = 0;
        let volume = self.volumes.iter().find(|volume| {
            behind += volume.joints;
            index < behind
        });
        volume.map_or("", |volume| &volume.file)
    }
}

impl Content for IndexRecording<'_> {
    fn name(&self) -> String {
        let (log, command) = (name_of(self.all.sources), self.all.command);
        format!("{log} · {command} · {} joints", self.all.joints.len())
    }

    fn id(&self) -> String {
        hashed(self.all.sources, self.all.joints.iter().map(|joint| joint.joint), |part| {
            part(&format!("index {} {:?}", self.all.command, self.all.settings));
            part(&format!("{:?}", self.volumes));
        })
    }

    fn about(&self) -> String {
        about::page(self.all, &self.layouts())
    }

    fn tabs(&self, _: Growth) -> Vec<Tab<'_>> {
        let add = |chunks: &mut Chunks| {
            let layouts = self.layouts();
            chunks.page(JOINTS, page(self, &layouts))?;
            add_doubtful(chunks, self, &layouts)
        };
        vec![Tab { joint: None, add: Box::new(add) }]
    }

    fn blueprint(&self, _: Growth) -> Blueprint {
        let path = |path: &str| at(&EntityPath::from(ROOT), path);
        let name = "The segment, the chosen lines, their residual, the squared errors";
        let list = "Most doubtful of all joints first: click a number";
        let left = [
            (3.2, Page::list(list, path("log"), "doubt")),
            (6.8, Page::drawing(name, &path(paths::DRAWING), segment_view::SIZE)),
        ];
        let right = [
            (4.0, Page::text("Joints", EntityPath::from(JOINTS))),
            (6.0, Page::text("Verdict", path(paths::VERDICT))),
        ];
        let columns =
            [(6.8, Page::stacked("Decisions", left)), (3.2, Page::stacked("Words", right))];
        let tabs = vec![Page::beside("Joints and doubtful decisions", columns)];
        let about = "About".to_owned();
        Blueprint { tabs, about, timeline: "doubt", play: PlayState::Paused }
    }
}

/// All joints with their files.
fn page(recording: &IndexRecording<'_>, layouts: &[JointLayout<'_>]) -> String {
    let joints = recording.all.joints;
    let row = |(number, (joint, layout)): (usize, (&EstimatedJoint<'_>, &JointLayout<'_>))| {
        let cells = summary_cells(&joint.joint.name, &JointSummary::of(*joint));
        let [name, steps, accepted, rejected, min, median, max] = cells.map(|cell| plain(&cell));
        let doubts = layout.segments().map(|(_, segment)| &segment.doubt);
        let doubt = doubts.max_by(|a, b| a.value().total_cmp(&b.value())).map(doubt_percent);
        let (file, doubt) =
            (link(recording.file_of(number)), doubt.unwrap_or_else(|| "-".to_owned()));
        [name, file, doubt, steps, accepted, rejected, min, median, max]
    };
    let [name, steps, accepted, rejected, min, median, max] = SUMMARY_HEADER;
    let header = [name, "file", "highest doubt", steps, accepted, rejected, min, median, max];
    let rows = joints.iter().zip(layouts).enumerate().map(row);
    let table = TextTable::of(header, &[], rows).markdown(str::to_owned);
    let (count, files) = (joints.len(), recording.volumes.len());
    format!("**{count} joints in {files} files.** {HOW}\n\n{table}")
}

const HOW: &str = "A click on one opens it, in a viewer that was started in their folder.";

/// Decisions that are shown: more of them nobody looks through at a sitting.
const MOST: usize = 200;

/// A decision with its joint.
struct Doubted<'l, 'a> {
    file: &'l str,
    trial: &'l TrialLayout<'a>,
    segment: &'l SegmentLayout<'a>,
}

/// Adds drawings, verdicts and a list, on the timeline of doubt.
fn add_doubtful(
    chunks: &mut Chunks,
    recording: &IndexRecording<'_>,
    layouts: &[JointLayout<'_>],
) -> Result<(), RecordError> {
    let mut all: Vec<Doubted<'_, '_>> = Vec::new();
    for (number, layout) in layouts.iter().enumerate() {
        let file = recording.file_of(number);
        let of_joint = |(trial, segment)| Doubted { file, trial, segment };
        all.extend(layout.segments().map(of_joint));
    }
    all.sort_by(|a, b| b.segment.doubt.value().total_cmp(&a.segment.doubt.value()));
    all.truncate(MOST);
    if all.is_empty() {
        return Ok(());
    }
    let ranks = || Index::on("doubt", (1..).take(all.len()));
    chunks.pages("doubtful/verdict", ranks(), all.iter().map(Doubted::page))?;
    let lines = all.iter().map(|found| (Some("INFO"), found.line()));
    chunks.lines("doubtful/log", ranks(), lines)?;
    let mut layers = Layers::rows(chunks, "doubtful/drawing", ranks());
    segment_view::add_drawings(&mut layers, all.iter().map(|found| (found.trial, found.segment)))
}

impl Doubted<'_, '_> {
    /// The verdict as it is beside the drawing in the joint's file.
    fn page(&self) -> String {
        let place = format!("**{}** · segment {}", link(self.file), self.segment.number);
        let page = verdict::page(self.trial, self.segment);
        format!("{place}\n\n{page}")
    }

    fn line(&self) -> String {
        let step = verdict::in_short(self.trial, self.segment);
        let (doubt, reason) = (doubt_percent(&self.segment.doubt), self.trial.reason(self.segment));
        format!("{doubt:>5}  {} ({}), {step}: {reason}", self.trial.estimated.joint.name, self.file)
    }
}
