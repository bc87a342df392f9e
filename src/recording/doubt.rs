//! The decisions by doubt: lines to click, and a page with a table.

use super::chunk::Chunks;
use super::error::RecordError;
use super::layout::{JointLayout, Placed, SegmentLayout, TrialLayout};
use super::markdown::plain;
use super::paths;
use crate::report::decisions::decision_text;
use crate::report::facts::Place;
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
    chunks.page(paths::DOUBT, page(layout, &ranked))
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

fn page(layout: &JointLayout<'_>, ranked: &[Placed<'_, '_>]) -> String {
    /// Decisions that a person reads.
    const MOST: usize = 25;
    let rows = ranked.iter().take(MOST).map(|(trial, segment)| trial.doubted(segment));
    let table = decision_text(Place::Doubtful, Some(layout.joint), rows).markdown(plain);
    let (name, shown) = (plain(&layout.joint.name), ranked.len().min(MOST));
    let count = doubtful_sentence(ranked.iter().map(|(_, segment)| &segment.doubt));
    format!("## {name}: {count}\n\n{DOUBT_MEANS} The first {shown}:\n\n{table}\n{HOW}")
}

const HOW: &str = "\
On the timeline `doubt` (bottom left) the right arrow goes through the decisions in this order; \
a click on a number in the list does, too. The doubt of an accepted step is 1 − what the break \
removes of the squared error of one line × how surely the breakpoint is placed × how well the \
lines meet × the distance of the nearest condition from its limit; that of a rejected one is how \
near the conditions that failed are to their limits.";
