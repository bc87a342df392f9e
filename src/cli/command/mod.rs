//! The commands, each in a file or folder of its own: its arguments and what it does.

pub(crate) mod add;
pub(crate) mod columns;
pub(crate) mod compare;
pub(crate) mod completions;
pub(crate) mod design;
pub(crate) mod doctor;
pub(crate) mod effects;
pub(crate) mod estimate;
pub(crate) mod explain;
pub(crate) mod export;
pub(crate) mod importer;
pub(crate) mod improve;
pub(crate) mod report;
pub(crate) mod simulate;
pub(crate) mod sweep;
