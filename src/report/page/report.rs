//! What a report is made from.

use crate::delay::Settings;
use crate::experiment::{Experiment, Joint};
use crate::report::difference::Against;
use crate::report::{EstimatedJoint, ImprovedJoint};

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
