//! What a report is made from.

use crate::delay::Settings;
use crate::experiment::{Experiment, Joint};
use crate::report::difference::Against;
use crate::report::{EstimatedJoint, ImprovedJoint};

/// What a report is about.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Report<'a> {
    /// What stands above it.
    pub(crate) heading: Heading<'a>,
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
    /// The recording that belongs to it.
    pub(crate) recording: Option<RecordingFile<'a>>,
    /// What a person should know who looks at the numbers.
    pub(crate) notes: &'a [String],
    /// Messages on joints and files that failed.
    pub(crate) failures: &'a [String],
}

/// What stands above a report: each only where it is given, since the same log gives the same
/// report on any day.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Heading<'a> {
    /// Instead of the name of the log.
    pub(crate) title: Option<&'a str>,
    /// Whose report it is.
    pub(crate) author: Option<&'a str>,
    /// Its date, in any form.
    pub(crate) date: Option<&'a str>,
}

/// A recording that belongs to a report.
#[derive(Clone, Copy, Debug)]
pub(crate) struct RecordingFile<'a> {
    /// Its name, without a folder: it is beside the report.
    pub(crate) name: &'a str,
    /// Its bytes, where the report holds it.
    pub(crate) bytes: Option<&'a [u8]>,
}

impl Report<'_> {
    /// The model of a joint.
    pub(super) fn model_of(&self, joint: &Joint) -> Option<&ImprovedJoint<'_>> {
        self.models.iter().find(|model| model.finding.compared.joint.name == joint.name)
    }
}
