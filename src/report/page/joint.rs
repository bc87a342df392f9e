//! What is said of one joint.

use super::document::{Block, Table};
use super::plot::PlotError;
use super::{Report, delays, model, record, segment};
use crate::delay::{AgainstState, Condition};
use crate::report::against::{AGAINST_HEADER, against_rows};
use crate::report::decisions::detailed_rows;
use crate::report::{DelayRange, EstimatedJoint, JointSummary, number};

/// Rows of a table that a reader may still want to scroll through.
const MOST_ROWS: usize = 2000;

/// All that is said of a joint.
pub(super) fn blocks(
    report: &Report<'_>,
    estimated: EstimatedJoint<'_>,
    file: &str,
) -> Result<Vec<Block>, PlotError> {
    let mut blocks = vec![
        Block::Lead(sentences(report, estimated)),
        Block::Figures(vec![record::figure(estimated, format!("{file}-record"))?]),
    ];
    let segments = segment::figures(estimated, &format!("{file}-segment"))?;
    if !segments.is_empty() {
        blocks.push(Block::part("Single decisions"));
        blocks.push(Block::Figures(segments));
    }
    blocks.extend(delay_blocks(estimated, file)?);
    blocks.extend(rejections(estimated));
    blocks.push(decisions(report, estimated));
    if let Some(improved) = report.model_of(estimated.joint) {
        blocks.extend(model::blocks(report, improved, file)?);
    }
    Ok(blocks)
}

/// Delays, steps and model of a joint, in a sentence each.
pub(super) fn sentences(report: &Report<'_>, estimated: EstimatedJoint<'_>) -> String {
    let delay = delay_sentence(&JointSummary::of(estimated));
    let model = report.model_of(estimated.joint).map(model::sentence);
    [delay].into_iter().chain(model).collect::<Vec<_>>().join(" ")
}

fn delay_sentence(summary: &JointSummary) -> String {
    let JointSummary { steps, accepted, rejected, delay_s, .. } = summary;
    if *steps == 0 {
        return "The input never changes.".to_owned();
    }
    let counted = |(why, count): &(Condition, usize)| format!("{}: {count}", why.meaning());
    let why = match rejected.as_slice() {
        [] => String::new(),
        [(why, _)] => format!(" ({})", why.meaning()),
        several => format!(" ({})", several.iter().map(counted).collect::<Vec<_>>().join(", ")),
    };
    let rest = steps - accepted;
    match delay_s {
        Some(DelayRange { min, median, max }) => format!(
            "Delay {median:.3} s (median; {min:.3} to {max:.3} s); {accepted} of {steps} steps \
             accepted, {rest} rejected{why}."
        ),
        None => format!("No delay: all {steps} steps were rejected{why}."),
    }
}

/// Figures and table of the delays.
fn delay_blocks(estimated: EstimatedJoint<'_>, file: &str) -> Result<Vec<Block>, PlotError> {
    let mut blocks = Vec::new();
    let Some(figure) = delays::over_time(estimated, format!("{file}-delay"))? else {
        return Ok(blocks);
    };
    let found = estimated.against_state();
    blocks.push(Block::part("Delay"));
    blocks.push(Block::Figures(vec![figure]));
    blocks.push(Block::Figures(delays::against(&estimated.joint.name, &found, file)?));
    let table = Block::Table(against(&estimated.joint.name, &found));
    let note = "Spearman's rank correlation; `yes`: p at most 0.05 after Holm's correction.";
    let summary = "What the delay depends on".to_owned();
    blocks.push(Block::Details { summary, blocks: vec![table, Block::text(note)] });
    Ok(blocks)
}

/// A row per variable.
fn against(joint: &str, found: &AgainstState) -> Table {
    let [_, header @ ..] = AGAINST_HEADER;
    let mut table = Table::new(header, &[2, 3]);
    for [_, cells @ ..] in against_rows(joint, found) {
        table.row(cells);
    }
    table
}

/// How many steps were rejected for which reason.
fn rejections(estimated: EstimatedJoint<'_>) -> Vec<Block> {
    let summary = JointSummary::of(estimated);
    if summary.rejected.is_empty() {
        return Vec::new();
    }
    let mut table = Table::new(["rejected as", "steps", "meaning"], &[1]);
    for (condition, count) in &summary.rejected {
        table.row([condition.to_string(), count.to_string(), condition.meaning().to_owned()]);
    }
    vec![Block::part("Rejected steps"), Block::Table(table)]
}

/// The table of decisions: numbers as in `--decisions`, to five digits.
fn decisions(report: &Report<'_>, estimated: EstimatedJoint<'_>) -> Block {
    let header = [
        "trial",
        "i",
        "p",
        "r",
        "end",
        "q",
        "δ [samples]",
        "δ [s]",
        "interval",
        "SSE",
        "verdict",
        "accepted with",
    ];
    let mut table = Table::new(header, &[1, 2, 3, 4, 5, 6, 7, 8, 9]);
    let optional = |value: Option<f64>| value.map_or_else(|| "-".to_owned(), number);
    let rows = detailed_rows(estimated, report.settings);
    let all = rows.count();
    for (row, detail) in detailed_rows(estimated, report.settings).take(MOST_ROWS) {
        let interval = detail.delta_low.zip(detail.delta_high);
        let interval = interval.map_or_else(
            || "-".to_owned(),
            |(low, high)| format!("{} … {}", number(low), number(high)),
        );
        table.row([
            row.trial.to_owned(),
            row.i.to_string(),
            row.p.to_string(),
            row.r.to_string(),
            row.end.to_string(),
            optional(row.q),
            optional(row.delta),
            optional(row.delta_s),
            interval,
            optional(row.sse),
            row.verdict,
            detail.accepted_with,
        ]);
    }
    let mut blocks = vec![Block::text(
        "Sample numbers count from 1 within the trial: p is the step of the input, r and end \
         are the first and the last sample of the segment, q is the breakpoint, δ = q − p the \
         delay, SSE the squared error of both lines.",
    )];
    if all > MOST_ROWS {
        blocks.push(Block::text(format!(
            "These are the first {MOST_ROWS} of {all}; `tauscope estimate --decisions FILE.csv` \
             writes them all."
        )));
    }
    blocks.push(Block::Table(table));
    Block::Details { summary: format!("All {all} decisions"), blocks }
}
