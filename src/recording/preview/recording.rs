//! A preview: what it is made of, its page on all of it, its joints and its views.

use std::borrow::Cow;
use std::fmt::Write as _;
use std::path::Path;

use rerun::external::re_sdk_types::blueprint::components::PlayState;

use super::expected::Preview;
use super::{data, sheet, words};
use crate::design::Prediction;
use crate::experiment::{ReadOptions, Source};
use crate::recording::blueprint::{Blueprint, Page};
use crate::recording::chunk::Chunks;
use crate::recording::content::{Content, Growth, Tab, hashed, name_of};
use crate::recording::error::RecordError;
use crate::recording::markdown::plain;
use crate::recording::origin::made_from;
use crate::recording::paths::{self, at, child, joint_root};
use crate::report::{DesignedJoint, design_sentences};

/// Everything that a preview holds.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PreviewRecording<'a> {
    /// The inputs, in the order of their tabs.
    pub(crate) joints: &'a [DesignedJoint],
    /// The logs from which the joints are known.
    pub(crate) sources: &'a [Source],
    /// How they were read.
    pub(crate) reading: &'a ReadOptions,
    /// The model file, where one was given.
    pub(crate) model: Option<&'a Path>,
}

impl Content for PreviewRecording<'_> {
    fn name(&self) -> String {
        let from = name_of(self.sources);
        let model = self.model.and_then(Path::file_stem).map(|stem| stem.to_string_lossy());
        let parts = Some(from).filter(|from| !from.is_empty()).into_iter();
        let parts = parts.chain(model.map(Cow::into_owned));
        parts.chain(["design · next experiment".to_owned()]).collect::<Vec<_>>().join(" · ")
    }

    fn id(&self) -> String {
        hashed(self.sources, std::iter::empty(), |part| {
            for DesignedJoint { rig, schedule, prediction, .. } in self.joints {
                part(&format!("preview {rig:?} {:?}", schedule.holds()));
                part(&format!("{:?}", prediction.as_ref().map(Prediction::extent)));
            }
        })
    }

    fn about(&self) -> String {
        page(self).unwrap_or_default()
    }

    fn tabs(&self, _: Growth) -> Vec<Tab<'_>> {
        let tab = |joint| {
            let add = move |chunks: &mut Chunks| add(chunks, &Preview::of(joint));
            Tab { joint: Some(&joint.rig.name), add: Box::new(add) }
        };
        self.joints.iter().map(tab).collect()
    }

    fn blueprint(&self, _: Growth) -> Blueprint {
        let tabs = self.joints.iter().map(tab).collect();
        let about = "About".to_owned();
        Blueprint { tabs, about, timeline: "time", play: PlayState::Paused }
    }
}

fn add(chunks: &mut Chunks, preview: &Preview<'_>) -> Result<(), RecordError> {
    data::add(chunks, preview)?;
    sheet::add(chunks, preview)?;
    words::add(chunks, preview)
}

/// The page of a joint and its signals; beside them what they distinguish, and the holds.
fn tab(joint: &DesignedJoint) -> Page {
    let root = joint_root(&joint.rig.name);
    let path = |path: &str| at(&root, path);
    let mut plots = vec![Page::plot("Input", &[path(paths::INPUT)])];
    let expected = joint.expected();
    if !expected.is_empty() {
        let expected = expected.iter().flat_map(|(name, _)| {
            let output = child(path(paths::EXPECTED), name);
            [paths::OUTPUT, paths::LOW, paths::HIGH].map(|part| at(&output, part))
        });
        let range = [paths::LOW, paths::HIGH].map(|part| at(&path(paths::RANGE), part));
        let outputs: Vec<_> = expected.chain(range).collect();
        plots.push(Page::plot("Expected output", &outputs));
    }
    if joint.discrimination.is_some() {
        plots.push(Page::plot("Difference over noise", &[path(paths::APART)]));
    }
    let drawings = [
        Page::drawing("What is expected", &path(paths::SHEET), sheet::SIZE),
        Page::stacked("Signals", plots.into_iter().map(|plot| (1.0, plot))),
    ];
    let words = [
        (5.2, Page::text("What it distinguishes, and how surely", path(paths::SAYS))),
        (2.3, Page::text("Under the cursor", path(paths::HERE))),
        (2.5, Page::list("Holds: click a time", path(paths::HOLDS), "time")),
    ];
    let columns = [(7.0, Page::tabs("Drawings", drawings)), (3.0, Page::stacked("Words", words))];
    Page::beside(&joint.rig.name, columns)
}

/// What is to be played on which joint, and from what it was made.
fn page(preview: &PreviewRecording<'_>) -> Result<String, std::fmt::Error> {
    let mut page = String::new();
    writeln!(page, "# The next experiment, before it is played\n")?;
    for joint in preview.joints {
        let first = design_sentences(joint).into_iter().next().unwrap_or_default();
        writeln!(page, "- {}", plain(&first))?;
    }
    if let Some(model) = preview.model {
        writeln!(page, "\nWith the model file `{}`.", model.display())?;
    }
    made_from(&mut page, preview.sources, preview.reading)?;
    writeln!(page, "{HOW_TO_READ}")?;
    Ok(page)
}

const HOW_TO_READ: &str = "\
## How to read it

- The shaded band is the margin of what is expected: two standard deviations of what the numbers \
of the model may be off. Red lines are the range that the joint may have.
- The lowest plot is the difference of both expected outputs in standard deviations of the \
noise. As in a fit, it starts anew at each step of the input. The percentages are the parts of \
all squared differences that lie in a hold.
- A click on the time in a line of the list of holds goes there; on the timeline `segment` the \
arrow keys go from hold to hold.";
