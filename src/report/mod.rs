//! Results as text, CSV, JSON, and a page with figures: pure functions to bytes.
//!
//! Recordings show some of it that is not shown elsewhere, which is unused in a program without them.

#![cfg_attr(
    not(feature = "rrd"),
    expect(dead_code, unused_imports, reason = "what only recordings show")
)]

mod add;
mod against;
mod answer;
mod columns;
mod compare;
mod conclusion;
mod consequence;
mod dead_time;
mod decisions;
mod delay_table;
mod delays;
mod design;
mod design_words;
mod difference;
mod doubt;
mod effects;
mod equation;
mod estimated;
mod explain;
mod extent;
mod facts;
mod finding;
mod folder;
mod improve;
mod json;
mod ladder;
mod lookup;
mod model_delay;
mod page;
mod parameters;
mod ranking;
mod review;
mod review_page;
mod separation;
mod settings;
mod steps;
mod summary;
mod sweep;
mod table;
mod text;
mod text_table;
mod warning;

pub(crate) use add::{AddedJoint, add_text, gone};
pub use against::against_table;
pub(crate) use against::variable_text;
pub(crate) use answer::delay_answer;
pub(crate) use columns::columns_table;
pub use compare::ComparedJoint;
pub(crate) use compare::{compare_text, errors_note, model_differences, model_table};
pub(crate) use conclusion::Topic;
pub(crate) use consequence::MANY_TIMES_NOISE;
pub(crate) use dead_time::{dead_time_sentences, input_note};
pub use decisions::decision_rows;
pub(crate) use decisions::{
    DECISION, decision_columns, decision_table, decision_text, steps_table,
};
pub(crate) use delay_table::{delay_levels_text, level_table, level_text as levels_text};
pub(crate) use delays::delay_table;
pub use delays::write_delays;
pub(crate) use design::{Basis, DesignedJoint, Discrimination, input_table, preview_table};
pub(crate) use design_words::{
    design_text, hold_note, left_out_note, no_range_note, shortened_note, trials_note,
};
pub(crate) use difference::{Against, against_text};
pub(crate) use doubt::{Doubted, by_doubt, doubtful_lines};
pub(crate) use effects::{listing, sheet};
pub use estimated::EstimatedJoint;
pub(crate) use explain::explain_text;
pub(crate) use extent::extent_table;
pub(crate) use facts::Place;
pub use finding::Finding;
pub(crate) use folder::{FolderReport, LogResult};
pub use improve::ImprovedJoint;
pub(crate) use improve::{improve_text, revision_line};
pub(crate) use json::{
    EstimateJson, add_json, columns_json, compare_json, design_json, document, effects_json,
    explain_json, folder_json, improve_json, report_json, sweep_json,
};
pub use ladder::{Before, History};
pub(crate) use ladder::{change_in_words, errors_of};
pub(crate) use lookup::{Language, Lookup};
pub(crate) use page::{
    Document, Heading, Marked, RecordingFile, Report, Timeline, dead_time_panel, delay_panel,
    design_document, record_panels, report_text, simulated_panels, worst_panel,
};
pub(crate) use parameters::{delay_of_steps, parameter_table};
pub(crate) use review::{ReviewCount, review_sheet};
pub(crate) use review_page::review_page;
pub(crate) use settings::{settings_in_short, settings_table};
pub(crate) use steps::step_line;
pub(crate) use summary::{DelayRange, Headline, JointSummary};
pub use sweep::ReportedSweep;
pub(crate) use sweep::{
    StepsShown, depends_on, level_cell, level_text, run_text, settings_in_words, sweep_sentences,
    sweep_text,
};
pub(crate) use table::{DataTable, Kind};
pub(crate) use text::{
    SUMMARY_HEADER, chosen_line, estimate_table, onset_sentence, summary_cells, summary_table,
};
pub(crate) use text_table::TextTable;
pub use warning::Warning;
