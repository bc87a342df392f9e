//! The JSON of each command: types of their own, so that what the library calls a quantity and
//! what its file calls it change apart. One file holds a command's schema; what several share
//! is in [`header`], [`joint`], [`misfit`], [`candidate`] and [`settings`].

mod add;
mod candidate;
mod columns;
mod compare;
mod conclusion;
mod dead_time;
mod design;
mod difference;
mod effects;
mod estimate;
mod explain;
mod folder;
mod header;
mod improve;
mod joint;
mod misfit;
mod report;
mod settings;
mod sweep;

pub(crate) use add::AddJson;
pub(crate) use columns::ColumnsJson;
pub(crate) use compare::CompareJson;
pub(crate) use design::DesignJson;
pub(crate) use effects::EffectsJson;
pub(crate) use estimate::EstimateJson;
pub(crate) use explain::ExplainJson;
pub(crate) use folder::FolderJson;
pub(crate) use header::Header;
pub(crate) use improve::ImproveJson;
pub(crate) use report::ReportJson;
pub(crate) use sweep::SweepJson;
