//! Results as text, CSV, JSON, and a page with figures: pure functions to bytes.

mod add;
mod against;
mod compare;
mod conclusion;
mod decisions;
mod delays;
mod design;
mod design_words;
mod effects;
mod equation;
mod estimated;
mod explain;
mod finding;
mod folder;
mod improve;
mod json;
mod page;
mod separation;
mod settings;
mod steps;
mod summary;
mod sweep;
mod table;
mod text;
mod text_table;

pub use add::{AddedJoint, add_text, gone};
pub use against::against_table;
#[cfg(feature = "rrd")]
pub(crate) use against::variable_text;
pub use compare::{ComparedJoint, compare_table};
pub use conclusion::Conclusion;
pub use decisions::{
    DecisionDetail, DecisionRow, Methods, decision_columns, decision_rows, decision_table,
    write_decisions,
};
pub use delays::{delay_table, write_delays};
pub use design::{DesignedJoint, Discrimination, write_input, write_preview};
pub use design_words::{SIDE_HEADER, design_sentences, design_text, side_rows};
pub use effects::{listing, sheet};
pub use estimated::EstimatedJoint;
pub use explain::explain_text;
pub use finding::Finding;
pub use folder::{FolderReport, LogResult};
pub use improve::{ImprovedJoint, change_in_words, improve_text, revision_line};
pub(crate) use json::Header;
pub use json::{
    AddJson, CompareJson, DesignJson, EffectsJson, EstimateJson, ExplainJson, FolderJson,
    ImproveJson, ReportJson, SweepJson,
};
pub use page::{Document, Markdown, PlotError, RecordingFile, Report, report_text};
#[cfg(feature = "rrd")]
pub(crate) use settings::settings_rows;
pub use steps::{step_line, steps_table};
pub use summary::{DelayRange, JointSummary};
pub use sweep::{ReportedSweep, StepsShown, sweep_text};
#[cfg(feature = "rrd")]
pub(crate) use sweep::{
    depends_on, level_cell, level_text, run_text, settings_in_words, sweep_sentences,
};
pub use table::{DataTable, Kind};
pub(crate) use text::chosen_line;
pub use text::estimate_table;
#[cfg(feature = "rrd")]
pub(crate) use text::{SUMMARY_HEADER, summary_cells};
