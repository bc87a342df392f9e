//! The decisions by doubt: lines to click, and a page with a table.

use rerun::{EntityPath, TextDocument, TextLog};

use super::chunk::{Chunks, Index};
use super::error::RecordError;
use super::layout::{JointLayout, SegmentLayout, TrialLayout};
use super::markdown::plain;
use super::paths::{self, at};
use super::verdict::{in_short, step_of};
use crate::delay::Verdict;
use crate::experiment::Joint;
use crate::wording::{DOUBT_MEANS, doubt_percent, doubtful_sentence};

/// Adds `/doubt` and `/doubt/log`.
pub(super) fn add(
    chunks: &mut Chunks,
    root: &EntityPath,
    joint: &Joint,
    layout: &JointLayout<'_>,
) -> Result<(), RecordError> {
    let ranked = layout.by_doubt();
    if ranked.is_empty() {
        return Ok(());
    }
    // All at the first difference, and at the last moment of every other timeline: there the list keeps this order, a viewer
    // does not scroll it to the cursor, and a click on a rank leads to the timeline of doubt.
    let last = layout
        .segments()
        .last()
        .map(|(trial, segment)| trial.moment(segment, segment.verdict(), trial.trial.len()));
    let index: Index = last.into_iter().cycle().take(ranked.len()).collect();
    let index = index.at_revision(layout.last_revision);
    let index = index.with_doubt(ranked.iter().map(|(_, segment)| segment.rank));
    let firsts = std::iter::repeat_n(1, if layout.first.is_compared { ranked.len() } else { 0 });
    let index = index.with_difference(firsts);
    let lines: Vec<_> = ranked.iter().map(|(trial, segment)| line(joint, trial, segment)).collect();
    let level = |segment: &SegmentLayout<'_>| match segment.doubt.value() {
        doubt if doubt >= LIKELY => "ERROR",
        _ if segment.doubt.is_doubtful() => "WARN",
        _ => "INFO",
    };
    let levels: Vec<_> = ranked.iter().map(|(_, segment)| level(segment)).collect();
    let log = TextLog::update_fields().with_many_text(lines).with_many_level(levels);
    chunks.push(at(root, paths::DOUBT_LOG), index, log.columns_of_unit_batches()?)?;
    let page = TextDocument::from_markdown(page(joint, &ranked));
    chunks.push_static(at(root, paths::DOUBT), &page)
}

/// Doubt from which on a line is red; what is doubtful below it is yellow. Chosen: on synthetic
/// records about every second accepted step above it is off by more than one and a half rows of β.
const LIKELY: f64 = 0.6;

fn line(joint: &Joint, trial: &TrialLayout<'_>, segment: &SegmentLayout<'_>) -> String {
    let doubt = doubt_percent(&segment.doubt);
    let not = if segment.doubt.is_doubtful() { "" } else { " (not doubtful)" };
    // A line is cut where its list ends: the delay is in the verdict, the whole reason on the page.
    let mark = if segment.decision.verdict() == Verdict::Accepted { '✓' } else { '✗' };
    let (step, why) = (step_of(joint, trial, segment), trial.reason_in_short(segment));
    format!("{doubt:>5} {mark} {step}: {why}{not}")
}

fn page(joint: &Joint, ranked: &[(&TrialLayout<'_>, &SegmentLayout<'_>)]) -> String {
    /// Decisions that a person reads.
    const MOST: usize = 25;
    let row = |(trial, segment): &(&TrialLayout<'_>, &SegmentLayout<'_>)| {
        let (doubt, reason) = (doubt_percent(&segment.doubt), trial.reason(segment));
        let is = if segment.doubt.is_doubtful() { "**doubtful**" } else { "" };
        let step = plain(&in_short(joint, trial, segment));
        format!("| {} | {doubt} | {is} | {step} | {reason} |", segment.rank)
    };
    let rows: Vec<_> = ranked.iter().take(MOST).map(row).collect();
    let (name, shown) = (plain(&joint.name), rows.len());
    let count = doubtful_sentence(ranked.iter().map(|(_, segment)| &segment.doubt));
    format!(
        "## {name}: {count}\n\n{DOUBT_MEANS} The first {shown}:\n\n\
         | `doubt` | doubt | | step | what speaks against it |\n|---|---|---|---|---|\n{}\n\n{HOW}",
        rows.join("\n")
    )
}

const HOW: &str = "\
On the timeline `doubt` (bottom left) the right arrow goes through the decisions in this order; \
a click on a number in the list does, too. The doubt of an accepted step is 1 − what the break \
removes of the squared error of one line × how surely the breakpoint is placed × how well the \
lines meet × the distance of the nearest condition from its limit; that of a rejected one is how \
near the conditions that failed are to their limits.";
