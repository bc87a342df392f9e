//! Results as text, CSV, JSON, and a page with figures: pure functions to bytes.

mod add;
mod against;
mod compare;
mod decisions;
mod delays;
mod design;
mod design_words;
mod effects;
mod equation;
mod explain;
mod finding;
mod folder;
mod improve;
mod json;
mod page;
mod separation;
mod settings;
mod span;
mod steps;
mod summary;
mod sweep;
mod table;
mod text;
mod words;

pub use add::{AddJson, AddedJoint, add_text, gone};
pub use against::against_table;
#[cfg(feature = "rrd")]
pub(crate) use against::variable_text;
pub use compare::{CompareJson, ComparedJoint, compare_table};
pub use decisions::{
    DecisionDetail, DecisionRow, Methods, decision_columns, decision_rows, decision_table,
    write_decisions,
};
pub use delays::{delay_table, write_delays};
pub use design::{DesignJson, DesignedJoint, Told, write_input, write_preview};
pub use design_words::{SIDE_HEADER, design_sentences, design_text, side_rows};
pub use effects::{EffectsJson, listing, sheet};
pub use explain::{ExplainJson, explain_text};
pub use finding::Finding;
pub use folder::{FolderJson, FolderReport, LogResult};
pub use improve::{ImproveJson, ImprovedJoint, change_in_words, improve_text, revision_line};
pub use json::EstimateJson;
pub use page::{Document, Markdown, PlotError, RecordingFile, Report, ReportJson, report_text};
#[cfg(feature = "rrd")]
pub(crate) use settings::settings_rows;
#[cfg(feature = "rrd")]
pub(crate) use span::{Span, thinned_to};
pub use steps::{step_line, steps_table};
pub use summary::{DelayRange, JointSummary};
pub use sweep::{ReportedSweep, StepsShown, SweepJson, sweep_text};
#[cfg(feature = "rrd")]
pub(crate) use sweep::{
    hangs_on, level_cell, level_text, run_text, settings_in_words, sweep_sentences,
};
pub use table::{DataTable, Kind};
pub(crate) use text::chosen_line;
pub use text::estimate_table;
#[cfg(feature = "rrd")]
pub(crate) use text::{SUMMARY_HEADER, summary_cells};
pub use words::Words;

use crate::batch::JointEstimate;
use crate::delay::Lag;
use crate::experiment::Joint;

/// A joint as it was measured, and its delays.
#[derive(Clone, Copy, Debug)]
pub struct EstimatedJoint<'a> {
    /// What was measured.
    pub joint: &'a Joint,
    /// What was estimated from it.
    pub estimate: &'a JointEstimate,
}

impl EstimatedJoint<'_> {
    /// The lag that its trials share, where the method looks for one.
    pub fn lag(&self) -> Option<&Lag> {
        self.estimate.estimated().find_map(|trial| trial.lag.as_ref())
    }
}
