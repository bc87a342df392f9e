//! The methods: one file each, and one entry each in the registry.
//!
//! A new method is a file here, with its [`MethodSpec`](super::MethodSpec), its handle and
//! its [`DelayMethod`], and a line in `registry.rs`: help, defaults, sweeps, reports and
//! recordings follow from what it says of itself.

mod by_onset;
mod interface;
mod next_reaction;
mod noise_test;
mod registry;
mod step_context;
mod two_line;

pub(super) use interface::{DelayMethod, Shared};
pub(crate) use next_reaction::end_at_the_next_step;
pub(super) use registry::implementation;
