//! Decisions in the order of their doubt.

use super::EstimatedJoint;
use super::steps::step_place;
use crate::delay::{Decision, Doubt, doubts};
use crate::experiment::Trial;
use crate::wording::{counted, doubt_percent, doubt_sentence};

/// A decision with its doubt.
#[derive(Clone, Debug)]
pub(crate) struct Doubted<'a> {
    pub(crate) trial: &'a Trial,
    /// The output that the lines were fitted to; none where it is the measured one.
    pub(crate) smoothed: Option<&'a [f64]>,
    pub(crate) decision: &'a Decision,
    pub(crate) doubt: Doubt,
}

/// All decisions on `joint` in their order, each with its doubt.
pub(super) fn doubted(joint: EstimatedJoint<'_>) -> impl Iterator<Item = Doubted<'_>> {
    joint.trials().flat_map(|(trial, found)| {
        let smoothed = found.smoothed.as_deref();
        let all = doubts(&found.decisions, smoothed.unwrap_or(trial.output()));
        all.map(move |(decision, doubt)| Doubted { trial, smoothed, decision, doubt })
    })
}

/// All decisions on `joint`, the most doubtful first; equally doubtful ones in their order.
pub(crate) fn by_doubt(joint: EstimatedJoint<'_>) -> Vec<Doubted<'_>> {
    let mut all: Vec<_> = doubted(joint).collect();
    all.sort_by(|a, b| b.doubt.value().total_cmp(&a.doubt.value()));
    all
}

/// The decisions of all joints by doubt, the most doubtful first, each with its joint.
pub(crate) fn all_by_doubt<'a>(
    joints: &'a [EstimatedJoint<'a>],
) -> Vec<(EstimatedJoint<'a>, Doubted<'a>)> {
    let of_each = |joint: &EstimatedJoint<'a>| {
        let joint = *joint;
        by_doubt(joint).into_iter().map(move |doubted| (joint, doubted))
    };
    let mut all: Vec<_> = joints.iter().flat_map(of_each).collect();
    all.sort_by(|a, b| b.1.doubt.value().total_cmp(&a.1.doubt.value()));
    all
}

/// The doubtful decisions of all joints in lines, the most doubtful first.
pub(crate) fn doubtful_lines(joints: &[EstimatedJoint<'_>]) -> Vec<String> {
    lines(&all_by_doubt(joints))
}

/// A line for each decision that is doubtful and on which no reviewer has judged, of all by doubt.
fn lines(all: &[(EstimatedJoint<'_>, Doubted<'_>)]) -> Vec<String> {
    let doubtful = all.iter().take_while(|(_, found)| found.doubt.is_doubtful());
    let open = doubtful.filter(|(_, found)| found.decision.reviewer_verdict.is_none());
    open.map(|(joint, found)| line(*joint, found)).collect()
}

/// How many decisions are doubtful, and the most doubtful ones, a line each; nothing where none is.
pub(super) fn doubtful_text(joints: &[EstimatedJoint<'_>]) -> String {
    /// Decisions that are named.
    const MOST: usize = 3;
    let all = all_by_doubt(joints);
    let (steps, doubtful) = (all.len(), lines(&all));
    let are = match doubtful.len() {
        0 => return String::new(),
        1 => "is",
        _ => "are",
    };
    let said: String = doubtful.iter().take(MOST).flat_map(|line| ["  ", line, "\n"]).collect();
    let first = if doubtful.len() > MOST { "look first at" } else { "look at" };
    let is_reviewed = all.iter().any(|(_, found)| found.decision.reviewer_verdict.is_some());
    let open = if is_reviewed { " and not reviewed" } else { "" };
    let (count, all) = (doubtful.len(), counted(steps, "decision"));
    format!("{count} of {all} {are} doubtful{open}; {first}\n{said}")
}

/// Where a decision is, and what speaks against it.
fn line(joint: EstimatedJoint<'_>, found: &Doubted<'_>) -> String {
    let Doubted { trial, decision, doubt, .. } = found;
    let verdict = decision.program_verdict();
    let why = doubt_sentence(doubt, verdict, trial.period().seconds());
    let (place, percent) = (step_place(joint.joint, trial, decision), doubt_percent(doubt));
    format!("{place}: {verdict}, doubt {percent}: {why}")
}
