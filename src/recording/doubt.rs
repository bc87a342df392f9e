//! The decisions by doubt: lines to click.

use super::chunk::Chunks;
use super::error::RecordError;
use super::layout::{JointLayout, SegmentLayout, TrialLayout};
use super::paths;
use crate::wording::doubt_percent;

/// Adds `/doubt/log`.
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
    chunks.lines(paths::DOUBT_LOG, index, lines)
}

/// Doubt from which on a line is red; what is doubtful below it is yellow. Chosen: on synthetic
/// records about every second accepted step above it is off by more than one and a half rows of β.
const LIKELY: f64 = 0.6;

fn line(trial: &TrialLayout<'_>, segment: &SegmentLayout<'_>) -> String {
    let doubt = doubt_percent(&segment.doubt);
    let not = if segment.doubt.is_doubtful() { "" } else { " (not doubtful)" };
    // A line is cut where its list ends: the delay is in the verdict, the whole reason on the page.
    let mark = if segment.is_accepted() { '✓' } else { '✗' };
    let (step, why) = (trial.step(segment), trial.reason(segment));
    format!("{doubt:>5} {mark} {step}: {why}{not}")
}
