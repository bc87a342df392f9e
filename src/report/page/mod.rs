//! A report to attach to an experiment: one page, or Markdown with drawings beside it.
//!
//! What is said is put together once, as a [`Document`], and then written down. It holds
//! nothing of the moment at which it was made: the same input gives the same bytes.

mod delays;
mod document;
mod html;
mod joint;
mod ladder;
mod markdown;
mod model;
mod origin;
mod palette;
mod plot;
mod printed;
mod record;
mod segment;
mod share;
mod simulated;
mod timeline;

pub use document::Document;
pub use markdown::Markdown;
pub use plot::PlotError;
pub use printed::{ReportJson, report_text};

use super::{EstimatedJoint, ImprovedJoint};
use crate::delay::Settings;
use crate::experiment::{Experiment, Joint, Trial};
use crate::fit::Split;
use crate::model::ModelFile;
use crate::wording::counted;
use document::{Block, Entry, slug};

/// Width of a drawing that stands alone, in pixels.
const WIDTH: u32 = 760;

/// Width of one of two beside one another.
const HALF: u32 = 400;

/// Width of one of three.
const NARROW: u32 = 350;

/// What a report is about.
#[derive(Clone, Copy, Debug)]
pub struct Report<'a> {
    /// What was read.
    pub experiment: &'a Experiment,
    /// The joints with their delays.
    pub joints: &'a [EstimatedJoint<'a>],
    /// How the delays were found.
    pub settings: &'a Settings,
    /// The models of joints that have one, each with its revisions.
    pub models: &'a [ImprovedJoint<'a>],
    /// The model file that they come from.
    pub model: Option<&'a ModelFile>,
    /// The model file with what was found, as text.
    pub revised: Option<&'a str>,
    /// How simulations were restarted, in words.
    pub horizon: &'a str,
    /// How training and validation were told apart; as [`Split::of`] says without it.
    pub split: Option<Split>,
    /// The command that makes this report.
    pub command: &'a str,
    /// The recording that belongs to it.
    pub recording: Option<RecordingFile<'a>>,
    /// What a person should know who looks at the numbers.
    pub notes: &'a [String],
    /// Messages on joints and files that failed.
    pub failures: &'a [String],
}

/// A recording that belongs to a report.
#[derive(Clone, Copy, Debug)]
pub struct RecordingFile<'a> {
    /// Its name, without a folder: it stands beside the report.
    pub name: &'a str,
    /// Its bytes, where the report holds it.
    pub bytes: Option<&'a [u8]>,
}

impl Report<'_> {
    /// Puts the report together.
    ///
    /// # Errors
    /// When a figure cannot be drawn.
    pub fn document(&self) -> Result<Document, PlotError> {
        let mut blocks = vec![Block::text(self.extent()), Block::Contents(self.contents())];
        blocks.extend(delays::overview(self.joints)?.map(|figure| Block::Figures(vec![figure])));
        if !self.failures.is_empty() {
            blocks.push(Block::Lead("Left out".to_owned()));
            blocks.push(Block::List(self.failures.to_vec()));
        }
        for (index, joint) in self.joints.iter().enumerate() {
            blocks.push(Block::section(&joint.joint.name, &anchor(index, joint.joint)));
            blocks.extend(joint::blocks(self, *joint, &anchor(index, joint.joint))?);
        }
        blocks.extend(origin::blocks(self));
        Ok(Document { title: self.title(), blocks })
    }

    /// What is said of each joint in a sentence or two; also what `report` prints.
    pub fn sentences(&self) -> Vec<(&str, String)> {
        let joints = self.joints.iter();
        joints.map(|joint| (joint.joint.name.as_str(), joint::sentences(self, *joint))).collect()
    }

    fn title(&self) -> String {
        let files = self.experiment.sources.as_slice();
        let name = |path: &std::path::Path| {
            path.file_name().unwrap_or_default().to_string_lossy().into_owned()
        };
        match files {
            [one] => format!("Delays in {}", name(&one.path)),
            _ => format!("Delays in {} files", files.len()),
        }
    }

    /// How much was measured.
    fn extent(&self) -> String {
        let (joints, files) = (self.joints.len(), self.experiment.sources.len());
        let trials = || self.joints.iter().flat_map(|joint| &joint.joint.trials);
        let samples: usize = trials().map(Trial::len).sum();
        let mut periods: Vec<String> = trials().map(|trial| trial.period().to_string()).collect();
        periods.dedup();
        periods.truncate(3);
        let (joints, files) = (counted(joints, "joint"), counted(files, "file"));
        format!("{joints} in {files}, {samples} samples, one every {}.", periods.join(" or "))
    }

    fn contents(&self) -> Vec<Entry> {
        let entry = |(index, joint): (usize, &EstimatedJoint<'_>)| Entry {
            name: joint.joint.name.clone(),
            anchor: anchor(index, joint.joint),
            text: joint::sentences(self, *joint),
        };
        self.joints.iter().enumerate().map(entry).collect()
    }

    /// The model of a joint.
    fn model_of(&self, joint: &Joint) -> Option<&ImprovedJoint<'_>> {
        self.models.iter().find(|model| model.finding.compared.joint.name == joint.name)
    }
}

/// Where links to a joint lead, and what its drawings' names begin with.
fn anchor(index: usize, joint: &Joint) -> String {
    format!("joint-{}-{}", index + 1, slug(&joint.name))
}

/// A signal's values in all trials.
fn values_of(joint: &Joint, values: fn(&Trial) -> &[f64]) -> impl Iterator<Item = f64> + '_ {
    joint.trials.iter().flat_map(move |trial| values(trial).iter().copied())
}
