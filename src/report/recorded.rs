//! What a recording is made of: results of which other outputs tell, too.

use super::{ComparedJoint, EstimatedJoint, ImprovedJoint, ReportedSweep};
use crate::delay::Settings;
use crate::delay::sweep::Grid;
use crate::experiment::{Joint, ReadOptions, Source};
use crate::study::OtherResult;

/// How many candidates of each segment are recorded.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Detail {
    /// All.
    #[default]
    Full,
    /// All of rejected and of doubtful segments; of others the best, its neighbours, and every
    /// so-manieth, 25 at most.
    Lean,
}

/// The names of the files that were read, without folders and endings.
pub(crate) fn names_of(sources: &[Source]) -> String {
    let stems = sources.iter().filter_map(|source| source.path.file_stem());
    stems.map(|stem| stem.to_string_lossy()).collect::<Vec<_>>().join(", ")
}

/// Everything that a recording of decisions and models holds.
#[derive(Clone, Copy, Debug)]
pub struct Recording<'a> {
    /// What was done, in a word: the name of the command.
    pub command: &'a str,
    /// The joints, in the order of their tabs.
    pub joints: &'a [EstimatedJoint<'a>],
    /// The settings of the algorithm.
    pub settings: &'a Settings,
    /// The files that were read.
    pub sources: &'a [Source],
    /// How they were read.
    pub reading: &'a ReadOptions,
    /// How many candidates are recorded.
    pub detail: Detail,
    /// Models beside the measurement; those of a joint that is not recorded are left out.
    pub models: &'a [ComparedJoint<'a>],
    /// What other methods, settings or logs gave, drawn beside these decisions.
    pub also: &'a [OtherResult],
    /// Models as they grew, on a timeline of their own; at most one per joint.
    pub revisions: &'a [ImprovedJoint<'a>],
}

impl<'a> Recording<'a> {
    /// The revisions of the model of `joint`.
    pub(crate) fn revisions_of(&self, joint: &Joint) -> Option<&'a ImprovedJoint<'a>> {
        let of_joint = |improved: &&ImprovedJoint<'_>| {
            improved.finding.compared.joint.name == joint.name && !improved.revisions.is_empty()
        };
        self.revisions.iter().find(of_joint)
    }
}

/// Everything that a recording of a sweep holds.
#[derive(Clone, Copy, Debug)]
pub struct SweepRecording<'a> {
    /// The joints, in the order of their tabs.
    pub joints: &'a [ReportedSweep<'a>],
    /// The settings that were tried.
    pub grid: &'a Grid,
    /// Delays that differ by so many samples more than each allows still agree.
    pub tolerance: f64,
    /// The files that were read.
    pub sources: &'a [Source],
    /// How they were read.
    pub reading: &'a ReadOptions,
}
