//! The decisions by doubt: lines to click, and a page with a table.

use super::chunk::Chunks;
use super::error::RecordError;
use super::layout::{JointLayout, Placed, SegmentLayout, TrialLayout};
use super::markdown::plain;
use super::paths;
use super::verdict::in_short;
use crate::wording::{DOUBT_MEANS, doubt_percent, doubtful_sentence};

/// Adds `/doubt` and `/doubt/log`.
pub(super) fn add(chunks: &mut Chunks, layout: &JointLayout<'_>) -> Result<(), RecordError> {
    let ranked = layout.ranked(|segment| segment.rank);
    if ranked.is_empty() {
        return Ok(());
    }
    let index = layout
        .at_the_end(ranked.len())
        .all_at("revision", layout.last_revision)
        .with("doubt", ranked.iter().map(|(_, segment)| segment.rank))
        .all_at("difference", layout.first.is_compared.then_some(1));
    let level = |segment: &SegmentLayout<'_>| match segment.doubt.value() {
        doubt if doubt >= LIKELY => "ERROR",
        _ if segment.doubt.is_doubtful() => "WARN",
        _ => "INFO",
    };
    let lines = ranked.iter().map(|(trial, segment)| (Some(level(segment)), line(trial, segment)));
    chunks.lines(paths::DOUBT_LOG, index, lines)?;
    chunks.page(paths::DOUBT, page(&layout.joint.name, &ranked))
}

/// Doubt from which on a line is red; what is doubtful below it is yellow. Chosen: on synthetic
/// records about every second accepted step above it is off by more than one and a half rows of β.
const LIKELY: f64 = 0.6;

fn line(trial: &TrialLayout<'_>, segment: &SegmentLayout<'_>) -> String {
    let doubt = doubt_percent(&segment.doubt);
    let not = if segment.doubt.is_doubtful() { "" } else { " (not doubtful)" };
    // A line is cut where its list ends: the delay is in the verdict, the whole reason on the page.
    let mark = if segment.is_accepted() { '✓' } else { '✗' };
    let (step, why) = (trial.step(segment), trial.reason_in_short(segment));
    format!("{doubt:>5} {mark} {step}: {why}{not}")
}

fn page(joint: &str, ranked: &[Placed<'_, '_>]) -> String {
    /// Decisions that a person reads.
    const MOST: usize = 25;
    let row = |(trial, segment): &Placed<'_, '_>| {
        let (doubt, reason) = (doubt_percent(&segment.doubt), trial.reason(segment));
        let is = if segment.doubt.is_doubtful() { "**doubtful**" } else { "" };
        let step = plain(&in_short(trial, segment));
        format!("| {} | {doubt} | {is} | {step} | {reason} |", segment.rank)
    };
    let rows: Vec<_> = ranked.iter().take(MOST).map(row).collect();
    let (name, shown) = (plain(joint), rows.len());
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
