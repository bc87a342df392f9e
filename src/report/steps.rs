//! Every step in a row, for the terminal.

use comfy_table::{CellAlignment, ContentArrangement, Table, presets};

use super::decisions::detailed_rows;
use super::{EstimatedJoint, number};

/// A row per step: its delay with the interval, the verdict, and what would have accepted
/// it, or by how much the second-best breakpoint is worse.
pub fn steps_table(joints: &[EstimatedJoint<'_>]) -> String {
    let mut table = Table::new();
    table
        .load_style(presets::UTF8_BORDERS_ONLY)
        .set_content_arrangement(ContentArrangement::Disabled)
        .set_header(["joint", "trial", "step", "delay", "interval", "verdict", "how near"]);
    for joint in joints {
        for (row, detail) in detailed_rows(*joint) {
            let delay = row.delta.map_or_else(|| "-".to_owned(), number);
            let ends = detail.delta_low.zip(detail.delta_high);
            let interval = ends.map_or_else(
                || "-".to_owned(),
                |(low, high)| format!("{} … {}", number(low), number(high)),
            );
            let near = match (row.verdict.as_str(), detail.runner_up_margin, detail.runner_up_q) {
                ("accepted", Some(margin), Some(q)) => {
                    format!("SSE {} % above at q = {q}", number(100.0 * margin))
                }
                ("accepted", ..) => "-".to_owned(),
                _ => detail.accepted_with,
            };
            let (joint, trial) = (row.joint.to_owned(), row.trial.to_owned());
            table.add_row([joint, trial, row.i.to_string(), delay, interval, row.verdict, near]);
        }
    }
    for right in [2, 3] {
        if let Some(column) = table.column_mut(right) {
            column.set_cell_alignment(CellAlignment::Right);
        }
    }
    format!("{table}\ndelays in samples\n")
}
