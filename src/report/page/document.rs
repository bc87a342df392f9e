//! What a report is made from, and what it says, before it is written down as a page.

use crate::delay::Settings;
use crate::experiment::{Experiment, Joint};
use crate::figure::Panel;
use crate::report::difference::Against;
use crate::report::{EstimatedJoint, ImprovedJoint, TextTable};

/// Width of a drawing by itself, in pixels.
pub(super) const WIDTH: u32 = 760;

/// Width of one of two beside one another.
pub(super) const HALF: u32 = 400;

/// Width of one of three.
pub(super) const NARROW: u32 = 350;

/// A report: what it says in its order, and what is drawn.
#[derive(Clone, Debug, Default)]
pub(crate) struct Document {
    pub(super) title: String,
    pub(super) blocks: Vec<Block>,
}

/// A part of a report.
#[derive(Clone, Debug)]
pub(super) enum Block {
    /// A heading, its depth (2 for a section), and where links to it lead.
    Heading { depth: u8, text: String, anchor: Option<String> },
    /// A paragraph.
    Text(String),
    /// A paragraph that answers a question, after the question.
    Passage { question: &'static str, text: String },
    /// The paragraph that sums up its section.
    Lead(String),
    /// A line for each entry.
    List(Vec<String>),
    /// A line for each entry, which starts with a link to a section.
    Contents(Vec<Entry>),
    /// Something to be typed, or printed as it is.
    Code(String),
    /// Drawings side by side where there is room.
    Figures(Vec<Figure>),
    /// A table.
    Table(TextTable),
    /// What is shown when it is asked for.
    Details { summary: String, blocks: Vec<Self> },
}

/// An entry of a list of sections.
#[derive(Clone, Debug)]
pub(super) struct Entry {
    pub(super) name: String,
    pub(super) anchor: String,
    pub(super) text: String,
}

/// A drawing: panels above one another.
#[derive(Clone, Debug)]
pub(super) struct Figure {
    /// What it is, for those who do not see it.
    pub(super) name: String,
    /// In pixels.
    pub(super) width: u32,
    pub(super) panels: Vec<Panel>,
    pub(super) caption: String,
}

impl Block {
    pub(super) fn section(text: impl Into<String>, anchor: &str) -> Self {
        Self::Heading { depth: 2, text: text.into(), anchor: Some(anchor.to_owned()) }
    }

    pub(super) fn part(text: impl Into<String>) -> Self {
        Self::Heading { depth: 3, text: text.into(), anchor: None }
    }

    pub(super) fn details(summary: impl Into<String>, blocks: Vec<Self>) -> Self {
        Self::Details { summary: summary.into(), blocks }
    }

    pub(super) fn text(text: impl Into<String>) -> Self {
        Self::Text(text.into())
    }
}

/// `name` as a part of a link: small letters, digits and `-`.
pub(super) fn slug(name: &str) -> String {
    let plain = |c: char| if c.is_ascii_alphanumeric() { c.to_ascii_lowercase() } else { '-' };
    name.chars().map(plain).collect()
}

/// What a report is about.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Report<'a> {
    /// What stands above it, instead of the name of the log.
    pub(crate) title: Option<&'a str>,
    /// What was read.
    pub(crate) experiment: &'a Experiment,
    /// The joints with their delays.
    pub(crate) joints: &'a [EstimatedJoint<'a>],
    /// How the delays were found.
    pub(crate) settings: &'a Settings,
    /// The models of joints that have one, each with its revisions.
    pub(crate) models: &'a [ImprovedJoint<'a>],
    /// Other results that the decisions are compared with.
    pub(crate) against: &'a [Against<'a>],
    /// The model file with what was found, as text.
    pub(crate) revised: Option<&'a str>,
    /// The command that makes this report.
    pub(crate) command: &'a str,
    /// The command that also reports models, where none were asked for.
    pub(crate) with_models: Option<&'a str>,
    /// The name of the recording beside it.
    pub(crate) recording: Option<&'a str>,
    /// What a person should know who looks at the numbers.
    pub(crate) notes: &'a [String],
    /// Messages on joints and files that failed.
    pub(crate) failures: &'a [String],
}

impl Report<'_> {
    /// The model of a joint.
    pub(super) fn model_of(&self, joint: &Joint) -> Option<&ImprovedJoint<'_>> {
        self.models.iter().find(|model| model.finding.compared.joint.name == joint.name)
    }
}
