//! A report to attach to an experiment: one page, or Markdown with drawings beside it.
//!
//! What is said is put together once, as a [`Document`], and then written down. It holds
//! nothing of the moment at which it was made: the same input gives the same bytes.

mod compose;
mod dead_time;
mod delays;
mod design;
mod document;
mod html;
mod joint;
mod markdown;
mod model;
mod model_figures;
mod origin;
mod palette;
mod plot;
mod record;
mod report;
mod segment;
mod simulated;
mod timeline;

pub(crate) use compose::report_text;
pub(crate) use dead_time::panel as dead_time_panel;
pub(crate) use delays::panel as delay_panel;
pub(crate) use design::design_document;
pub(crate) use document::Document;
pub(crate) use record::panels as record_panels;
pub(crate) use report::{Heading, RecordingFile, Report};
pub(crate) use simulated::{Marked, panels as simulated_panels, worst_panel};
pub(crate) use timeline::Timeline;
