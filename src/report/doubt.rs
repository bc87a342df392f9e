//! Decisions in the order of their doubt.

use super::EstimatedJoint;
use super::steps::step_place;
use crate::delay::{Decision, Doubt, doubts};
use crate::experiment::Trial;
use crate::wording::{counted, doubt_percent};

/// A decision with its doubt.
#[derive(Clone, Debug)]
pub(crate) struct Doubted<'a> {
    pub(crate) joint: EstimatedJoint<'a>,
    pub(crate) trial: &'a Trial,
    /// The output that the lines were fitted to; none where it is the measured one.
    pub(crate) smoothed: Option<&'a [f64]>,
    pub(crate) decision: &'a Decision,
    pub(crate) doubt: Doubt,
}

/// All decisions on `joint` in their order, each with its doubt.
pub(super) fn doubted(joint: EstimatedJoint<'_>) -> impl Iterator<Item = Doubted<'_>> {
    joint.trials().flat_map(move |(trial, found)| {
        let smoothed = found.smoothed.as_deref();
        let all = doubts(&found.decisions, smoothed.unwrap_or(trial.output()));
        all.map(move |(decision, doubt)| Doubted { joint, trial, smoothed, decision, doubt })
    })
}

/// All decisions on `joints`, the most doubtful first; equally doubtful ones in their order.
pub(crate) fn by_doubt<'a>(joints: &[EstimatedJoint<'a>]) -> Vec<Doubted<'a>> {
    let mut all: Vec<_> = joints.iter().flat_map(|joint| doubted(*joint)).collect();
    all.sort_by(|a, b| b.doubt.value().total_cmp(&a.doubt.value()));
    all
}

/// The doubtful decisions of all joints in lines, the most doubtful first.
pub(crate) fn doubtful_lines(joints: &[EstimatedJoint<'_>]) -> Vec<String> {
    lines(&by_doubt(joints))
}

/// A line for each decision that is doubtful and on which no reviewer has judged, of all by doubt.
fn lines(all: &[Doubted<'_>]) -> Vec<String> {
    let doubtful = all.iter().take_while(|found| found.doubt.is_doubtful());
    let open = doubtful.filter(|found| found.decision.reviewer_verdict.is_none());
    open.map(line).collect()
}

/// How many decisions are doubtful, and the most doubtful ones, a line each; nothing where none is.
pub(super) fn doubtful_text(joints: &[EstimatedJoint<'_>]) -> String {
    /// Decisions that are named.
    const MOST: usize = 3;
    let all = by_doubt(joints);
    let (steps, doubtful) = (all.len(), lines(&all));
    let are = match doubtful.len() {
        0 => return String::new(),
        1 => "is",
        _ => "are",
    };
    let said: String = doubtful.iter().take(MOST).flat_map(|line| ["  ", line, "\n"]).collect();
    let first = if doubtful.len() > MOST { "look first at" } else { "look at" };
    let is_reviewed = all.iter().any(|found| found.decision.reviewer_verdict.is_some());
    let open = if is_reviewed { " and not reviewed" } else { "" };
    let (count, all) = (doubtful.len(), counted(steps, "decision"));
    format!("{count} of {all} {are} doubtful{open}; {first}\n{said}")
}

/// Where a decision is, and what speaks against it.
fn line(found: &Doubted<'_>) -> String {
    let place = step_place(found.joint.joint, found.trial, found.decision);
    let (verdict, percent) = (found.decision.program_verdict(), doubt_percent(&found.doubt));
    format!("{place}: {verdict}, doubt {percent}: {}", found.why())
}
