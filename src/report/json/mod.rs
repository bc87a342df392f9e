//! The JSON of each command.
//!
//! A document is put together as a [`serde_json::Value`] whose keys stand in the order in which they
//! are written. What the library has under the same names is written as it is; all else is named here,
//! key by key. Only decisions, of which there may be hundreds of thousands, are made as they are
//! written. One file holds a command's schema; what several share is in [`document`], [`model`],
//! [`conclusion`], [`difference`] and [`settings`].

mod columns;
mod conclusion;
mod design;
mod difference;
mod document;
mod effects;
mod estimate;
mod folder;
mod model;
mod models;
mod settings;
mod sweep;

pub(crate) use columns::columns_json;
pub(crate) use design::design_json;
pub(crate) use document::document;
pub(super) use document::joined;
pub(crate) use effects::effects_json;
pub(crate) use estimate::EstimateJson;
pub(crate) use folder::folder_json;
pub(crate) use models::{add_json, compare_json, explain_json, improve_json, report_json};
pub(crate) use sweep::sweep_json;
