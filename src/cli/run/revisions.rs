//! The revisions of models: as they come, in recordings, and in the model file.

use std::sync::atomic::{AtomicBool, AtomicU32, Ordering};

use crate::cli::console::{Interrupt, Verbosity, message};
use crate::experiment::Joint;
use crate::explain::{Change, Improvement, Revision as Step, Verdict};
use crate::model::{ModelFile, Revision};
use crate::report::{ComparedJoint, Finding, ImprovedJoint, gone, revision_line};
use crate::study::JointEstimate;

/// Which revisions there are so far, reported as they come.
pub(crate) struct Progress<'a> {
    joints: &'a [Joint],
    /// Per joint, the number of its first revision.
    first: Vec<u32>,
    /// Per joint, the number of its next revision, and whether it was stopped.
    next: Vec<(AtomicU32, AtomicBool)>,
    verbosity: Verbosity,
    /// Who may stop it.
    interrupt: Option<Interrupt>,
}

impl<'a> Progress<'a> {
    pub(crate) fn new(
        file: &ModelFile,
        joints: &'a [Joint],
        verbosity: Verbosity,
        interrupt: Option<Interrupt>,
    ) -> Self {
        let first = |joint: &Joint| file.revision(&joint.name).unwrap_or(0);
        let first: Vec<u32> = joints.iter().map(first).collect();
        let next = first.iter().map(|first| ((*first).into(), false.into())).collect();
        Self { joints, first, next, verbosity, interrupt }
    }

    /// Reports a revision; whether to go on.
    pub(crate) fn done(&self, index: usize, revision: &Step) -> bool {
        let Some((joint, (next, stopped))) = self.joints.get(index).zip(self.next.get(index))
        else {
            return true;
        };
        // Another start of the search begins with the first revision again.
        if revision.change == Change::Start {
            next.store(self.first.get(index).copied().unwrap_or(0), Ordering::Relaxed);
        }
        let number = next.fetch_add(1, Ordering::Relaxed);
        if self.verbosity == Verbosity::Normal {
            message("improving", &revision_line(joint, number, revision));
        }
        let stops = self.interrupt.is_some_and(Interrupt::was_pressed);
        stopped.store(stops, Ordering::Relaxed);
        !stops
    }

    /// Which joints were stopped.
    pub(crate) fn stopped(&self) -> Vec<bool> {
        self.next.iter().map(|(_, stopped)| stopped.load(Ordering::Relaxed)).collect()
    }
}

/// What is to be said of a joint that was improved.
pub(crate) fn improved<'a>(
    file: &ModelFile,
    model: &'a str,
    joint: &'a Joint,
    (improvement, delays): (&'a Improvement, Option<&'a JointEstimate>),
    add_arguments: &'a str,
) -> Option<ImprovedJoint<'a>> {
    let Improvement { revisions, verdict, attribution } = improvement;
    let last = revisions.last()?;
    let first_revision = file.revision(&joint.name).unwrap_or(0);
    let revision = (first_revision..).zip(revisions).last()?.0;
    let compared = ComparedJoint { joint, model, revision, comparison: &last.comparison };
    let before = revisions.first().filter(|_| revisions.len() > 1).map(|first| &first.comparison);
    let (verdict, ranking) = (*verdict, last.ranking.as_slice());
    let attribution = Some(attribution);
    let finding =
        Finding { compared, verdict, ranking, add_arguments, before, attribution, delays };
    // Where more is missing at the end, nothing but the limit has ended it, or whoever stopped it.
    let reached_limit = verdict == Verdict::MissingEffect;
    let improved = ImprovedJoint::of(finding, revisions);
    Some(ImprovedJoint { first_revision, reached_limit, ..improved })
}

/// `file` with all revisions of all joints. A joint that has no new one stays as it is.
pub(crate) fn revised(
    file: &ModelFile,
    improved: &[ImprovedJoint<'_>],
) -> anyhow::Result<ModelFile> {
    let is_known = |joint: &&ImprovedJoint<'_>| file.joint(joint.name()).is_some();
    let known = improved.iter().filter(is_known);
    let file = known.clone().try_fold(file.clone(), |file, joint| revised_for(file, joint))?;
    let new = improved.iter().filter(|joint| !is_known(joint));
    let new: Vec<ModelFile> =
        new.map(|joint| revised_for(file.emptied(), joint)).collect::<anyhow::Result<_>>()?;
    Ok(file.joined(&new)?)
}

/// `file` with all revisions of a joint.
fn revised_for(mut file: ModelFile, joint: &ImprovedJoint<'_>) -> anyhow::Result<ModelFile> {
    let pairs = (joint.first_revision + 1..).zip(joint.revisions.windows(2));
    for (number, pair) in pairs {
        let [before, after] = pair else { continue };
        let model = &after.comparison.fit.model;
        file = file.revised(joint.name(), model, &entry(number, before, after))?;
    }
    if file.joint(joint.name()).is_none() {
        file = file.refitted(joint.name(), &joint.finding.compared.comparison.fit.model)?;
    }
    Ok(file)
}

/// What the history says of `after`.
fn entry(revision: u32, before: &Step, after: &Step) -> Revision {
    let model = &after.comparison.fit.model;
    let removed = gone(&before.comparison.fit.model, model);
    let added = match after.change {
        Change::Added(id) | Change::Replaced { new: id, .. } => Some(id.to_owned()),
        Change::Start | Change::Removed(_) => None,
    };
    Revision {
        revision,
        added,
        removed: removed.first().map(|id| (*id).to_owned()),
        validation_rmse: after.comparison.validation.map(|error| error.rmse),
    }
}

/// `revision 0` and so on, to the last number there is.
pub(crate) fn revision_names(improved: &[ImprovedJoint<'_>]) -> Vec<String> {
    let last = improved.iter().map(|joint| joint.finding.compared.revision).max().unwrap_or(0);
    (0..=last).map(|number| format!("revision {number}")).collect()
}

/// The revisions of a joint, each as a model.
pub(crate) fn models<'a>(
    improved: &ImprovedJoint<'a>,
    names: &'a [String],
) -> Vec<ComparedJoint<'a>> {
    let joint = improved.finding.compared.joint;
    let numbered = (improved.first_revision..).zip(improved.revisions);
    let named = (0..).zip(names).map(|(number, name)| (number, name.as_str()));
    let compared = |(number, revision): (u32, &'a Step)| {
        let model = named.clone().find(|(own, _)| *own == number)?.1;
        let comparison = &revision.comparison;
        Some(ComparedJoint { joint, model, revision: number, comparison })
    };
    numbered.filter_map(compared).collect()
}
