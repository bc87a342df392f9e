//! Results as text, CSV, JSON, and a page with figures: pure functions to bytes.
//!
//! A file tells one result in all its forms. Recordings show some of it that is not shown elsewhere,
//! which is unused in a program without them.

#![cfg_attr(not(feature = "rrd"), expect(dead_code, reason = "what only recordings show"))]

pub(crate) mod answer;
pub(crate) mod columns;
pub(crate) mod compare;
pub(crate) mod conclusion;
pub(crate) mod decisions;
pub(crate) mod delays;
pub(crate) mod design;
pub(crate) mod design_words;
pub(crate) mod difference;
pub(crate) mod effects;
pub(crate) mod estimate;
mod estimated;
pub(crate) mod facts;
pub(crate) mod finding;
pub(crate) mod folder;
pub(crate) mod improve;
pub(crate) mod json;
pub(crate) mod ladder;
pub(crate) mod lookup;
pub(crate) mod page;
pub(crate) mod parameters;
pub(crate) mod recorded;
pub(crate) mod review;
pub(crate) mod review_page;
pub(crate) mod settings;
pub(crate) mod summary;
pub(crate) mod sweep;
mod table;

pub use compare::ComparedJoint;
pub(crate) use decisions::Doubted;
pub use decisions::decision_rows;
pub use delays::{against_table, write_delays};
pub use estimated::{EstimatedJoint, Warning};
pub use finding::Finding;
pub use improve::ImprovedJoint;
pub use ladder::{Before, History};
pub use recorded::{Detail, Recording, SweepRecording};
pub(crate) use summary::{DelayRange, JointSummary};
pub use sweep::ReportedSweep;
pub(crate) use table::{DataTable, Kind, TextTable};
