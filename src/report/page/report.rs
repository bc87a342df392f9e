//! What a report is made from.

use crate::delay::Settings;
use crate::experiment::{Experiment, Joint};
use crate::fit::Split;
use crate::model::ModelFile;
use crate::report::{EstimatedJoint, ImprovedJoint};

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
    /// How training and validation were split; as [`Split::of`] says without it.
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
    /// Its name, without a folder: it is beside the report.
    pub name: &'a str,
    /// Its bytes, where the report holds it.
    pub bytes: Option<&'a [u8]>,
}

impl Report<'_> {
    /// The model of a joint.
    pub(super) fn model_of(&self, joint: &Joint) -> Option<&ImprovedJoint<'_>> {
        self.models.iter().find(|model| model.finding.compared.joint.name == joint.name)
    }
}
