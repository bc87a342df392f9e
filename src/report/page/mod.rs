//! A report to attach to an experiment: one page.
//!
//! What is said is put together once, as a [`Document`], and then written down. It holds
//! nothing of the moment at which it was made: the same input gives the same bytes.

pub(crate) mod compose;
pub(crate) mod delays;
pub(crate) mod design;
pub(crate) mod document;
mod joint;
mod model;
mod plot;
mod render;
pub(crate) mod simulated;
pub(crate) mod timeline;
