//! The JSON of each command: types of their own, so that what the library calls a quantity and
//! what its file calls it change apart. One file holds a command's schema; what several share
//! is in [`header`], [`joint`], [`misfit`], [`candidate`] and [`settings`].

mod add;
mod candidate;
mod compare;
mod design;
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

pub use add::AddJson;
pub use compare::CompareJson;
pub use design::DesignJson;
pub use effects::EffectsJson;
pub use estimate::EstimateJson;
pub use explain::ExplainJson;
pub use folder::FolderJson;
pub(crate) use header::Header;
pub use improve::ImproveJson;
pub use report::ReportJson;
pub use sweep::SweepJson;
